//! Spectra of each class.

use super::ChaosPage;
use crate::plate::Plate;
use figure::{Axis, Figure, Mark, Panel, Series, Share};
use study::chaos::spectra::{ClassSpectra, MOST_CLASSES, Quartiles};
use study::classes;

/// Spectra, and spectra of the envelope.
pub(super) fn plates(page: &ChaosPage) -> Vec<Plate> {
    if page.spectra.is_empty() {
        return Vec::new();
    }
    let left_out = if MOST_CLASSES < page.spectra.len() {
        format!(
            " Shown are the first {MOST_CLASSES} of {} classes.",
            page.spectra.len()
        )
    } else {
        String::new()
    };
    let from = format!(
        "The line is the median, the band the middle half over the windows of a class, at most {} of each and spread evenly \
         over the sweep; all panels have the same axes.{left_out}",
        page.most_windows
    );
    vec![
        Plate {
            heading: "Spectra of each class".to_owned(),
            caption: format!(
                "Amplitude density of the measured acceleration (Welch 1967, Hann window, 1024 samples, half overlapping). Lines at the \
                 left are the orders of the crank; clearance raises the level above them, and adds broad humps where parts \
                 ring. {from}"
            ),
            figure: small_multiples(
                page,
                &Axis::linear("frequency (Hz)"),
                "density (m/s²/√Hz)",
                |class| &class.spectrum,
            ),
            ..Plate::default()
        },
        Plate {
            heading: "Envelope spectra of each class".to_owned(),
            caption: format!(
                "Amplitude spectrum of the acceleration's envelope in its most impulsive band (kurtogram, Antoni 2007), over orders of \
                 the crank's speed. Lines at whole orders are knocks that come every revolution alike; lines between them, at halves or \
                 quarters, are knocks that come alike every second or fourth revolution; a floor without lines is knocking that does not \
                 repeat. {from}"
            ),
            figure: small_multiples(page, &Axis::orders(), "amplitude (m/s²)", |class| {
                &class.envelope
            }),
            ..Plate::default()
        },
    ]
}

fn small_multiples(
    page: &ChaosPage,
    x: &Axis,
    y: &str,
    of: impl Fn(&ClassSpectra) -> &Quartiles,
) -> Figure {
    let shown = page.spectra.iter().take(MOST_CLASSES);
    let panels = shown.map(|class| {
        let colour = page.class_colour(&class.class);
        let Quartiles { at, values } = of(class);
        let line = |which: usize| {
            at.iter()
                .zip(values)
                .map(move |(&x, three)| [x, three[which]])
        };
        let band: Vec<[f64; 2]> = line(0)
            .collect::<Vec<_>>()
            .into_iter()
            .chain(line(2).collect::<Vec<_>>().into_iter().rev())
            .collect();
        let name = text::capitalised(&classes::name(&class.class));
        Panel {
            title: format!("{name} ({})", text::counted(class.windows, "window")),
            x: x.clone(),
            y: Axis::log(y),
            series: vec![
                Series::new("", colour, Mark::Band, band),
                Series::new("", colour, Mark::Line, line(1)),
            ],
            note: if at.is_empty() {
                "no band found".to_owned()
            } else {
                String::new()
            },
            ..Panel::default()
        }
    });
    Figure {
        rows: figure::in_rows(panels.collect(), 2),
        row_height: 180.0,
        share_x: Share::All,
        share_y: Share::All,
        ..Figure::default()
    }
}
