//! The page of simulated windows beside measured ones.

use crate::plate::{Numbers, Plate, Rendered, numbered_files};
use crate::{Error, histogram};
use askama::Template;
use classify::TellingFeature;
use figure::{Axis, Colour, Figure, Mark, Panel, Series};
use sweep::domain_gap::Compared;

/// Features whose distributions are drawn.
const DRAWN: usize = 9;

/// Features of the table.
const LISTED: usize = 40;

#[derive(Template)]
#[template(path = "domain_gap_page.html")]
struct View<'a> {
    dataset: &'a str,
    compared: &'a Compared,
    version: &'static str,
    plates: Vec<(usize, Plate)>,
    features: &'a [TellingFeature],
}

/// The page as one HTML file that loads nothing from anywhere, and its figure: the distributions of the features by which a
/// classifier tells the windows of `dataset` from measured ones.
///
/// # Errors
/// [`Error::Template`] if the template cannot be filled in.
pub fn render(dataset: &str, compared: &Compared) -> Result<Rendered, Error> {
    let features = &compared.gap.features;
    let view = View {
        dataset,
        compared,
        version: env!("CARGO_PKG_VERSION"),
        plates: Numbers::default().give(vec![plate(compared)]),
        features: &features[..features.len().min(LISTED)],
    };
    let html = view.render()?;
    Ok(Rendered {
        html,
        figures: numbered_files("domain-gap", view.plates.into_iter()),
    })
}

fn plate(compared: &Compared) -> Plate {
    let telling = compared.gap.features.iter().take(DRAWN);
    let panels = telling.filter_map(|telling| panel(compared, &telling.feature));
    Plate {
        heading: "The most telling features".to_owned(),
        caption: "Share of the simulated and of the measured windows in bins of equal width. Windows without a value are \
                  left out."
            .to_owned(),
        figure: Figure {
            rows: figure::in_rows(panels.collect(), 3),
            row_height: 150.0,
            ..Figure::default()
        },
        ..Plate::default()
    }
}

fn panel(compared: &Compared, name: &str) -> Option<Panel> {
    let column = compared.names.iter().position(|own| own == name)?;
    let sides = [
        ("simulated", &compared.simulated),
        ("measured", &compared.measured),
    ];
    let values = |i: usize| sides[i].1.values.columns()[column].iter().copied();
    let edges = histogram::edges(values(0).chain(values(1)));
    let series = (0..sides.len()).map(|i| {
        let counts = histogram::counts(&edges, values(i));
        let all = counts.iter().sum::<usize>().max(1) as f64;
        let steps = edges.windows(2).zip(counts);
        let steps =
            steps.flat_map(|(edge, n)| [[edge[0], n as f64 / all], [edge[1], n as f64 / all]]);
        let mark = if i == 0 { Mark::Area } else { Mark::Line };
        Series::new(sides[i].0, Colour::Class(i), mark, steps)
    });
    Some(Panel {
        title: name.to_owned(),
        y: Axis::linear("share of windows"),
        series: series.collect(),
        ..Panel::default()
    })
}

impl View<'_> {
    fn value(value: &Option<f64>) -> String {
        value.map_or("–".to_owned(), |value| text::number(value, 4))
    }

    fn share(value: &f64) -> String {
        text::decimal(*value, 3)
    }

    fn folds(&self) -> String {
        let folds = self.compared.gap.folds.iter().map(Self::share);
        folds.collect::<Vec<_>>().join(", ")
    }
}
