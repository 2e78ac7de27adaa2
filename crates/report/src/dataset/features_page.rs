//! The page that documents the features, from their one table and the columns of the files.

use super::columns::of_table;
use crate::features_page::{FeatureEntry, FeatureGroup, FeaturesPage};
use crate::{Column, Error};
use features::{Definition, Group};
use sweep::reader::{Dataset, Subset};

/// The groups with their headings.
const GROUPS: [(Group, &str); 9] = [
    (Group::Statistics, "Statistics of the samples"),
    (Group::Spectrum, "Frequency bands and spectral shape"),
    (Group::Orders, "Orders of the shaft"),
    (Group::Portrait, "Velocity-acceleration portrait"),
    (
        Group::Envelope,
        "Impacts: envelope in the most impulsive band",
    ),
    (Group::Revolutions, "Revolution by revolution"),
    (Group::Indicator, "Indicator card"),
    (Group::Motion, "Kind of motion, chaos"),
    (Group::Reasons, "Why values are missing"),
];

impl FeaturesPage {
    /// The page about the features of a dataset.
    ///
    /// # Errors
    /// A table that cannot be read.
    pub fn from_dataset(dataset: &Dataset) -> Result<Self, Error> {
        let channels = dataset.plan.channels();
        let named = channels.iter().map(|(name, unit)| (name.as_str(), *unit));
        let columns = features::columns(named, dataset.plan.chaos).into_iter();
        let definitions: Vec<Definition> = columns.map(|(definition, _)| definition).collect();
        let groups = GROUPS.iter().map(|(group, heading)| {
            let own = definitions.iter().filter(|d| d.group == *group);
            FeatureGroup {
                heading: (*heading).to_owned(),
                features: entries(own),
            }
        });
        let groups = groups.filter(|group| !group.features.is_empty()).collect();
        Ok(Self {
            name: dataset.plan.name.clone(),
            version: dataset.manifest().version.clone(),
            groups,
            columns: labels(dataset, &definitions)?,
        })
    }
}

/// An entry for each feature, over all channels, and for each run of names that differ in
/// digits alone.
fn entries<'a>(definitions: impl Iterator<Item = &'a Definition>) -> Vec<FeatureEntry> {
    let mut features: Vec<(&str, FeatureEntry)> = Vec::new();
    for definition in definitions {
        let unit = if definition.unit == "1" {
            String::new()
        } else {
            text::unit(&definition.unit)
        };
        match features
            .iter_mut()
            .find(|(feature, _)| *feature == definition.feature)
        {
            Some((_, entry)) => {
                entry.columns.push(definition.name.clone());
                if !entry.units.contains(&unit) {
                    entry.units.push(unit);
                }
            }
            None => features.push((
                &definition.feature,
                FeatureEntry {
                    name: definition.feature.clone(),
                    columns: vec![definition.name.clone()],
                    units: vec![unit],
                    definition: definition.description.clone(),
                    formula: definition.formula.to_owned(),
                    source: definition.source.to_owned(),
                },
            )),
        }
    }
    let pattern = |feature: &str| feature.replace(|c: char| c.is_ascii_digit(), "#");
    let runs = features.chunk_by(|(a, _), (b, _)| pattern(a) == pattern(b));
    let merged = runs.map(|run| {
        let mut entry = run[0].1.clone();
        if let [_, .., (last, _)] = run {
            entry.name = format!("{} … {last}", entry.name);
            entry.definition += "; and so on";
        }
        entry
    });
    merged.collect()
}

/// The columns of the table of features that are no features.
fn labels(dataset: &Dataset, definitions: &[Definition]) -> Result<Vec<Column>, Error> {
    let mut columns = of_table(dataset, Subset::Features)?;
    columns.retain(|column| definitions.iter().all(|d| d.name != column.name));
    Ok(columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_group_has_its_heading_and_rows_of_features_are_one_entry() {
        let columns = features::columns([("a_m_s2", "m/s^2"), ("p_pa", "Pa")], true);
        let definitions: Vec<Definition> = columns.into_iter().map(|(d, _)| d).collect();
        for definition in &definitions {
            let headed = GROUPS.iter().any(|(group, _)| *group == definition.group);
            assert!(headed, "{} has no heading", definition.name);
        }
        let of = |group| {
            let own = definitions.iter().filter(move |d| d.group == group);
            entries(own)
        };
        let orders = of(Group::Orders);
        let names: Vec<&str> = orders.iter().map(|entry| entry.name.as_str()).collect();
        assert_eq!(
            names,
            [
                "order_01 … order_20",
                "order_01_rms … order_20_rms",
                "cepstrum_revolution"
            ]
        );
        assert_eq!(orders[0].units, ["m/s²", "Pa"]);
        assert_eq!(orders[0].columns, ["a.order_01_m_s2", "p.order_01_pa"]);
        let motion = of(Group::Motion);
        for name in ["lyapunov_per_s", "lyapunov_reason", "regime", "determinism"] {
            assert!(motion.iter().any(|entry| entry.name == name), "{name}");
        }
    }
}
