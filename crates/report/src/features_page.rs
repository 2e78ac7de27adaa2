//! The HTML page that documents the features of a dataset.

use crate::plate::Rendered;
use crate::{Column, Error};
use askama::Template;

/// All columns of the table of features, and what each is.
#[derive(Clone, Debug, Default)]
pub struct FeaturesPage {
    /// Name of the dataset.
    pub name: String,
    /// Version of the program that wrote it.
    pub version: String,
    /// The features, in groups.
    pub groups: Vec<FeatureGroup>,
    /// The other columns: names, labels, operating point, parameters, what is known of the case.
    pub columns: Vec<Column>,
}

/// Features that belong together.
#[derive(Clone, Debug)]
pub struct FeatureGroup {
    /// What they have in common.
    pub heading: String,
    /// The features.
    pub features: Vec<FeatureEntry>,
}

/// One feature, or a numbered row of them.
#[derive(Clone, Debug)]
pub struct FeatureEntry {
    /// Its name, or the first and the last of a row of them: `order_01 … order_20`.
    pub name: String,
    /// The columns that hold it: one per channel, of a row of features the first.
    pub columns: Vec<String>,
    /// The units of these columns, each once; empty for a pure number.
    pub units: Vec<String>,
    /// What it is.
    pub definition: String,
    /// How it is computed, x being the samples.
    pub formula: String,
    /// Where it is defined.
    pub source: String,
}

#[derive(Template)]
#[template(path = "features_page.html")]
struct View<'a> {
    page: &'a FeaturesPage,
}

impl FeaturesPage {
    /// The page as one HTML file that loads nothing from anywhere; it has no figures.
    ///
    /// # Errors
    /// [`Error::Template`] if the template cannot be filled in.
    pub fn render(&self) -> Result<Rendered, Error> {
        Ok(Rendered {
            html: View { page: self }.render()?,
            figures: Vec::new(),
        })
    }
}

impl View<'_> {
    fn units(feature: &FeatureEntry) -> String {
        let units: Vec<&str> = feature
            .units
            .iter()
            .map(|unit| if unit.is_empty() { "1" } else { unit.as_str() })
            .collect();
        units.join(", ")
    }

    fn count(&self) -> String {
        text::count(
            self.page
                .groups
                .iter()
                .map(|group| group.features.len())
                .sum(),
        )
    }
}
