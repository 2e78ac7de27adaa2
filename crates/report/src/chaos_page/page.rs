//! The page itself: sections in the order of reading.

use super::table::Table;
use super::{ChaosPage, bifurcations, exponents, maps, motions, spectra};
use crate::Error;
use crate::plate::{FigureFile, Plate, Rendered, file_name};
use askama::Template;
use study::chaos::cases::CaseChaos;
use study::chaos::regime::Regime;
use study::chaos::{agreement, claims};

/// Longest table of cases, in rows.
const MOST_CASES: usize = 200;

const ADD_EXPONENT: &str =
    "Add  run: {…, lyapunov: {revolutions: 200}}  to the sweep file to have it computed.";
const ADD_SIGNAL: &str = "The features of this dataset have no exponent and no regime from the signal: windows of many \
     revolutions (windows: {count: 1, revolutions: 60}) of a crosshead_acceleration sensor have.";
const ADD_CLEARANCE: &str = "Add cases with clearance to the sweep file:  joints: [[big_end]]  and  clearance: [0.1 mm, 0.2 mm].";
const ADD_BIFURCATION: &str = "This dataset has no bifurcation diagram. The key bifurcations of the sweep file adds diagrams; pipelines/chaos-map.yaml \
     has examples.";
const ADD_SIGNALS: &str = "There are no recordings in tables to make spectra of: a sensor has to measure \
     crosshead_acceleration, and the format has to be parquet.";

/// A part of the page.
struct Section {
    id: &'static str,
    heading: &'static str,
    introduction: String,
    /// What to add to the sweep file; empty where nothing is missing.
    missing: String,
    /// The figures with their numbers.
    plates: Vec<(usize, Plate)>,
    /// The table that follows.
    follows: Follows,
}

#[derive(PartialEq)]
enum Follows {
    None,
    Cases,
    Regimes,
}

#[derive(Template)]
#[template(path = "chaos_page.html")]
struct View<'a> {
    page: &'a ChaosPage,
    claims: Vec<String>,
    sections: Vec<Section>,
    regimes: Option<[[usize; 5]; 5]>,
    table: Table,
}

impl ChaosPage {
    /// The page as one HTML file that loads nothing from anywhere, and its figures.
    ///
    /// # Errors
    /// [`Error::Template`] if the template cannot be filled in.
    pub fn render(&self) -> Result<Rendered, Error> {
        let view = View {
            page: self,
            claims: claims::claims(&self.cases, self.claims),
            sections: sections(self),
            regimes: agreement::regimes(&self.cases),
            table: Table::new(listed(self)),
        };
        let html = view.render()?;
        let plates = view.sections.into_iter().flat_map(|section| section.plates);
        let figures = plates.map(|(number, plate)| FigureFile {
            name: file_name("chaos", number, &plate.heading),
            svg: plate.figure.svg(),
        });
        Ok(Rendered {
            html,
            figures: figures.collect(),
        })
    }

    fn has_truth(&self) -> bool {
        self.cases.iter().any(|case| case.exponent.is_some())
    }

    fn has_signal(&self) -> bool {
        let mut windows = self.cases.iter().flat_map(|case| &case.windows);
        windows.any(|window| window.exponent.is_some() || !window.reason.is_empty())
    }

    fn has_regimes(&self) -> bool {
        let windows = self.cases.iter().flat_map(|case| &case.windows);
        let mut regimes = self
            .cases
            .iter()
            .map(|case| case.regime)
            .chain(windows.map(|window| window.regime));
        regimes.any(|regime| regime.is_some())
    }
}

fn sections(page: &ChaosPage) -> Vec<Section> {
    let mut number = 0;
    let mut section =
        |id, heading, introduction: String, missing: String, plates: Vec<Plate>, follows| {
            let plates = plates.into_iter().map(|plate| {
                number += 1;
                (number, plate)
            });
            Section {
                id,
                heading,
                introduction,
                missing,
                plates: plates.collect(),
                follows,
            }
        };
    let unless = |there: bool, add: &str| if there { String::new() } else { add.to_owned() };
    let motions_there = !page.motions.is_empty();
    let exponents_missing = [
        unless(
            page.has_truth(),
            &format!("No case has an exponent from the equations. {ADD_EXPONENT}"),
        ),
        unless(page.has_signal(), ADD_SIGNAL),
    ];
    vec![
        section(
            "portraits",
            "Phase portraits",
            page.shown.clone(),
            unless(motions_there, ADD_CLEARANCE),
            motions::portraits(page),
            Follows::None,
        ),
        section(
            "sections",
            "Poincaré sections",
            "The same cases over all recorded revolutions: the motion once per revolution, and each impact."
                .to_owned(),
            unless(motions_there, ADD_CLEARANCE),
            motions::sections(page),
            Follows::None,
        ),
        section(
            "bifurcations",
            "Bifurcation diagrams",
            "The motion while one number of the machine rises and falls.".to_owned(),
            unless(!page.bifurcations.is_empty(), ADD_BIFURCATION),
            bifurcations::plates(page),
            Follows::None,
        ),
        section(
            "exponents",
            "Lyapunov exponents",
            "The largest exponent says how fast neighbouring motions part: by a factor e in 1/λ seconds. Positive is \
             chaotic."
                .to_owned(),
            exponents_missing.join(" ").trim().to_owned(),
            [exponents::against_clearance(page), exponents::scatter(page)].into_iter().flatten().collect(),
            Follows::Cases,
        ),
        section(
            "regimes",
            "Regimes",
            "The kind of motion by clearance, joint and speed.".to_owned(),
            unless(page.has_regimes(), &format!("No case has a regime. {ADD_EXPONENT}")),
            maps::plates(page),
            Follows::Regimes,
        ),
        section(
            "spectra",
            "Spectra",
            "The motion as an accelerometer on the crosshead measures it.".to_owned(),
            unless(!page.spectra.is_empty(), ADD_SIGNALS),
            spectra::plates(page),
            Follows::None,
        ),
        section(
            "orbits",
            "Journal orbits",
            "The journals of the same cases inside their bearings.".to_owned(),
            unless(motions_there, ADD_CLEARANCE),
            motions::orbits(page),
            Follows::None,
        ),
    ]
}

/// The cases that the table holds; none where it would have no exponent.
fn listed(page: &ChaosPage) -> &[CaseChaos] {
    if page.has_truth() || page.has_signal() {
        &page.cases[..page.cases.len().min(MOST_CASES)]
    } else {
        &[]
    }
}

/// What the template asks for, formatted.
impl View<'_> {
    fn file(number: &usize, plate: &Plate) -> String {
        file_name("chaos", *number, &plate.heading)
    }

    fn left_out(&self) -> String {
        let (shown, all) = (self.table.rows.len(), self.page.cases.len());
        if shown == 0 || shown == all {
            return String::new();
        }
        format!(
            "Shown are the first {} of {}; all are in the table features.",
            text::count(shown),
            text::count(all)
        )
    }

    fn kinds() -> [&'static str; 5] {
        Regime::KINDS.map(Regime::label)
    }

    fn count(n: &usize) -> String {
        text::count(*n)
    }
}
