//! Colours that stay apart for colour-blind readers and on paper.

use super::colour::Colour;

/// M. Okabe and K. Ito, "Color universal design" (2008), in the order of their contrast on white;
/// their yellow, too light for a line on white, is left out.
const CLASSES: [&str; 7] = [
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#4d4d4d",
];

/// Stops of an ordered scale, each darker than the one before, so that it also reads in grey.
const ORDERED: [[f64; 3]; 4] = [
    [94.0, 190.0, 150.0],
    [38.0, 130.0, 172.0],
    [68.0, 60.0, 140.0],
    [60.0, 8.0, 70.0],
];

/// Stops of a scale of fills, from light grey to as dark as [`ORDERED`] ends.
const TINTS: [[f64; 3]; 4] = [
    [232.0, 232.0, 232.0],
    [186.0, 218.0, 226.0],
    [74.0, 134.0, 176.0],
    [54.0, 20.0, 92.0],
];

/// The colour as `#rrggbb`.
pub(super) fn hex(colour: Colour) -> String {
    let [r, g, b] = match colour {
        Colour::Class(i) => return CLASSES[i % CLASSES.len()].to_owned(),
        Colour::Ink => return "#555555".to_owned(),
        Colour::Ordered(place) => between(&ORDERED, place),
        Colour::Tint(place) => between(&TINTS, place),
    };
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// The colour at a place from 0 (first stop) to 1 (last stop).
fn between(stops: &[[f64; 3]; 4], place: f64) -> [u8; 3] {
    let place = if place.is_finite() {
        place.clamp(0.0, 1.0)
    } else {
        0.0
    };
    let at = place * (stops.len() - 1) as f64;
    let stop = (at as usize).min(stops.len() - 2);
    [0, 1, 2].map(|channel| {
        let (from, to) = (stops[stop][channel], stops[stop + 1][channel]);
        (from + (to - from) * (at - stop as f64)).round() as u8
    })
}

impl Colour {
    /// The colour as `#rrggbb`.
    pub fn hex(self) -> String {
        hex(self)
    }
}

/// Black or white: what can be read on the colour.
pub(super) fn writing_on(colour: Colour) -> &'static str {
    match colour {
        Colour::Tint(place) if place < 0.6 => "#1a1a1a",
        _ => "#fff",
    }
}

/// How often the palette has been gone through: the shape of points and the dashes of lines change
/// with it.
pub(super) fn cycle(colour: Colour) -> usize {
    match colour {
        Colour::Class(i) => i / CLASSES.len(),
        _ => 0,
    }
}
