//! The page itself: figures and tables in the order of reading.

use super::examples;
use super::{DatasetPage, Design, comparison, diagnosis, distributions, operation};
use crate::plate::{FigureFile, Plate, Rendered, file_name, in_script};
use crate::{Column, Error};
use askama::Template;
use classify::{Baseline, ClassScore, RankedFeature};
use recordings::{CaseWarning, FailedCase};
use study::claims::{self, Claim};
use study::classes;
use study::counts::{FaultCount, ParameterRange};
use study::examples::MOST_EXAMPLES;
use study::features::FeatureRow;
use study::grid::{CaseLevel, ClearanceGrid, ClearanceGrids};
use study::levels;

/// Longest tables on the page, in rows.
const MOST_FAULTS: usize = 200;
const MOST_FAILED: usize = 100;
const MOST_WARNINGS: usize = 20;
const MOST_COLUMNS: usize = 500;
const MOST_RANKED: usize = 20;
/// Figures of further grids are left out where all would take more bytes than this: with the cases the page is then below
/// six million bytes, which open at once and go by mail.
const MOST_FIGURE_BYTES: usize = 2_500_000;

/// A part of the page that holds figures.
struct Gallery<'a> {
    id: String,
    heading: String,
    introduction: &'static str,
    /// What is shown of how much; empty where all is shown.
    left_out: String,
    /// Why there is no figure.
    nothing: &'a str,
    /// Number of its first figure.
    first: usize,
    plates: Vec<Plate>,
}

#[derive(Template)]
#[template(path = "dataset_page.html")]
struct View<'a> {
    page: &'a DatasetPage,
    facts: Vec<(&'static str, String)>,
    galleries: Vec<Gallery<'a>>,
}

impl DatasetPage {
    /// The page as one HTML file that loads nothing from anywhere, and its figures.
    ///
    /// # Errors
    /// [`Error::Template`] if the template cannot be filled in.
    pub fn render(&self) -> Result<Rendered, Error> {
        let view = View {
            page: self,
            facts: facts(self),
            galleries: galleries(self),
        };
        let html = view.render()?;
        let plates = view
            .galleries
            .into_iter()
            .flat_map(|gallery| (gallery.first..).zip(gallery.plates));
        let figures = plates.map(|(number, plate)| FigureFile {
            name: file_name("dataset", number, &plate.heading),
            svg: plate.figure.svg(),
        });
        Ok(Rendered {
            html,
            figures: figures.collect(),
        })
    }
}

fn galleries(page: &DatasetPage) -> Vec<Gallery<'_>> {
    let left_out = if page.examples.len() > MOST_EXAMPLES {
        format!(
            "Shown are the first {MOST_EXAMPLES} of {} classes.",
            text::count(page.examples.len())
        )
    } else {
        String::new()
    };
    let mut galleries = vec![Gallery {
        id: "examples".to_owned(),
        heading: "An example of each class".to_owned(),
        introduction: "One recording from each class of fault, as the sensors give it.",
        left_out,
        nothing: &page.no_examples,
        first: 1,
        plates: examples::plates(page),
    }];
    match &page.design {
        Design::Grid(grids) => galleries.extend(responses(page, grids)),
        Design::Random(sweep) => galleries.push(Gallery {
            id: "distributions".to_owned(),
            heading: "Distributions".to_owned(),
            introduction: "The cases of this dataset are drawn at random: the distributions of their parameters, and the \
                           features over them.",
            left_out: String::new(),
            nothing: &page.no_examples,
            first: 1,
            plates: distributions::plates(page, sweep),
        }),
    }
    let over_operation = operation::plates(page, &page.operation);
    if !over_operation.is_empty() {
        galleries.push(Gallery {
            id: "operation".to_owned(),
            heading: "Over speed and load".to_owned(),
            introduction: "What an analyst plots first: levels over the operating point, and spectra over the speed.",
            left_out: String::new(),
            nothing: "",
            first: 1,
            plates: over_operation,
        });
    }
    let diagnosis = diagnosis::plates(page);
    if !diagnosis.is_empty() {
        galleries.push(Gallery {
            id: "diagnosis".to_owned(),
            heading: "Telling the classes apart".to_owned(),
            introduction: "What single features say about the class, and what a classifier takes for what.",
            left_out: String::new(),
            nothing: "",
            first: 1,
            plates: diagnosis,
        });
    }
    let mut number = 1;
    for gallery in &mut galleries {
        gallery.first = number;
        number += gallery.plates.len();
    }
    galleries
}

/// A gallery for each grid, as far as their figures fit on the page.
fn responses<'a>(page: &'a DatasetPage, grids: &ClearanceGrids) -> Vec<Gallery<'a>> {
    let mut bytes = 0;
    let mut drawn = Vec::new();
    for (at, grid) in grids.grids.iter().enumerate() {
        let plates = comparison::plates(page, grid);
        bytes += plates
            .iter()
            .map(|plate| plate.live_svg().len())
            .sum::<usize>();
        if at > 0 && (plates.is_empty() || bytes > MOST_FIGURE_BYTES) {
            break;
        }
        drawn.push((grid, plates));
    }
    let (shown, all) = (drawn.len(), grids.grids.len() + grids.left_out);
    let gallery = |(at, (grid, plates)): (usize, (&ClearanceGrid, Vec<Plate>))| Gallery {
        id: match at {
            0 => "responses".to_owned(),
            at => format!("responses-{}", at + 1),
        },
        heading: match all {
            1 => "Responses by joint and clearance".to_owned(),
            _ => format!("Responses: {}", grid.title()),
        },
        introduction: "The same machine at the same operating point, with different clearances in different joints. Each line \
                       over crank angle is the last complete revolution of its recording; peak and rms are those of the whole \
                       recording.",
        left_out: match shown {
            _ if at > 0 || shown == all => String::new(),
            _ => format!(
                "Figures show the first {shown} of {all} operating points and sensors; the tables below have the levels of all."
            ),
        },
        nothing: &page.no_examples,
        first: 1,
        plates,
    };
    drawn.into_iter().enumerate().map(gallery).collect()
}

fn facts(page: &DatasetPage) -> Vec<(&'static str, String)> {
    let cases: usize = page.faults.iter().flat_map(|count| &count.cases).sum();
    let windows: usize = page.faults.iter().map(|count| count.windows).sum();
    let (fewest, most) = page.samples_per_window;
    let samples = if fewest == most {
        text::counted(most, "sample")
    } else {
        format!(
            "{} to {}",
            text::count(fewest),
            text::counted(most, "sample")
        )
    };
    let revolutions = text::counted(page.revolutions_per_window as usize, "revolution");
    let recorded = format!("{}\u{a0}Hz", text::number(page.sample_rate_hz, 6));
    let rate = match page.samples_per_revolution {
        Some(samples) => format!("{samples} in a revolution, recorded at {recorded}"),
        None => recorded,
    };
    vec![
        ("Cases", text::count(cases)),
        ("Classes", text::count(page.faults.len())),
        ("Windows", text::count(windows)),
        ("In a window", format!("{revolutions}, {samples}")),
        ("Sample rate", rate),
        ("Splits", page.splits.join(", ")),
        ("Failed cases", text::count(page.failed.len())),
        ("Seed", page.seed.to_string()),
        ("Version", page.version.clone()),
    ]
}

/// What the template asks for, formatted.
impl View<'_> {
    fn file(gallery: &Gallery<'_>, at: &usize) -> String {
        file_name("dataset", gallery.first + at, &gallery.plates[*at].heading)
    }

    fn faults(&self) -> &[FaultCount] {
        &self.page.faults[..self.page.faults.len().min(MOST_FAULTS)]
    }

    /// The grids, if the design has any.
    fn grids(&self) -> Option<&ClearanceGrids> {
        match &self.page.design {
            Design::Grid(grids) => Some(grids),
            Design::Random(_) => None,
        }
    }

    /// The grids whose levels are known.
    fn with_levels(&self) -> Vec<&ClearanceGrid> {
        let grids = self.grids().into_iter().flat_map(|grids| &grids.grids);
        grids.filter(|grid| !grid.levels.is_empty()).collect()
    }

    /// The grids, if there are claims to hold against them.
    fn claimed(&self) -> Option<&ClearanceGrids> {
        self.grids().filter(|grids| !grids.tested().is_empty())
    }

    fn level_cells(level: &CaseLevel) -> [String; 6] {
        levels::level_cells(level)
    }

    /// Whether the rows of features come from several sensors.
    fn has_sensors(&self) -> bool {
        let rows = &self.page.feature_rows;
        rows.iter().any(|row| row.sensor != rows[0].sensor)
    }

    fn claims(grid: &ClearanceGrid) -> Vec<Claim> {
        claims::claims(grid)
    }

    fn failed(&self) -> &[FailedCase] {
        &self.page.failed[..self.page.failed.len().min(MOST_FAILED)]
    }

    fn warnings(&self) -> &[CaseWarning] {
        &self.page.warnings[..self.page.warnings.len().min(MOST_WARNINGS)]
    }

    fn columns(&self) -> &[Column] {
        &self.page.columns[..self.page.columns.len().min(MOST_COLUMNS)]
    }

    fn feature_rows(&self) -> &[FeatureRow] {
        &self.page.feature_rows[..self.page.feature_rows.len().min(MOST_FAULTS)]
    }

    fn ranking(&self) -> &[RankedFeature] {
        &self.page.ranking[..self.page.ranking.len().min(MOST_RANKED)]
    }

    fn rank_cells(feature: &RankedFeature) -> [String; 3] {
        [
            text::decimal(feature.mutual_information, 2),
            text::number(feature.anova_f, 3),
            text::number(feature.kruskal_wallis_h, 3),
        ]
    }

    /// The first faults of a baseline, which is as many as a table has.
    fn classes(baseline: &Baseline) -> &[ClassScore] {
        &baseline.classes[..baseline.classes.len().min(MOST_FAULTS)]
    }

    fn class_count(baseline: &Baseline) -> String {
        text::count(baseline.classes.len())
    }

    fn percent(share: &f64) -> String {
        format!("{}\u{a0}%", text::decimal(100.0 * share, 1))
    }

    /// A remark under a table that does not show all rows; empty if it does.
    fn more(shown: usize, all: usize, where_all: &str) -> String {
        if shown == all {
            return String::new();
        }
        format!(
            "Shown are the first {} of {}; all are in {where_all}.",
            text::count(shown),
            text::count(all)
        )
    }

    /// The cases for the script, in a form that cannot end its element.
    fn case_data(&self) -> Result<String, askama::Error> {
        let json = serde_json::to_string(&self.page.cases);
        let json = json.map_err(|error| askama::Error::Custom(error.into()))?;
        Ok(in_script(json))
    }

    /// Cases in the split over all faults.
    fn split_total(&self, split: &usize) -> String {
        text::count(
            self.page
                .faults
                .iter()
                .filter_map(|count| count.cases.get(*split))
                .sum(),
        )
    }

    fn case_total(count: &FaultCount) -> String {
        text::count(count.cases.iter().sum())
    }

    fn value((mean, spread): &(f64, f64)) -> String {
        text::mean_and_spread(*mean, *spread)
    }

    /// Lowest and highest value of a parameter and their unit, in a unit that reads well.
    fn range(range: &ParameterRange) -> [String; 3] {
        let (factor, unit) =
            text::readable_unit(range.low.abs().max(range.high.abs()), &range.unit);
        [
            text::number(range.low * factor, 4),
            text::number(range.high * factor, 4),
            unit.to_owned(),
        ]
    }

    fn sensor(row: &FeatureRow) -> String {
        text::words(&row.sensor)
    }

    fn count(n: &usize) -> String {
        text::count(*n)
    }

    fn words(fault: &str) -> String {
        classes::name(fault)
    }
}
