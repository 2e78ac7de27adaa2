//! Colours that stay apart for colour-blind readers and on paper.

use super::Colour;

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

/// The colour as `#rrggbb`.
pub(super) fn hex(colour: Colour) -> String {
    match colour {
        Colour::Class(i) => CLASSES[i % CLASSES.len()].to_owned(),
        Colour::Ordered(place) => {
            let at = if place.is_finite() {
                place.clamp(0.0, 1.0)
            } else {
                0.0
            } * (ORDERED.len() - 1) as f64;
            let stop = (at as usize).min(ORDERED.len() - 2);
            let [r, g, b] = [0, 1, 2].map(|channel| {
                let (from, to) = (ORDERED[stop][channel], ORDERED[stop + 1][channel]);
                (from + (to - from) * (at - stop as f64)).round() as u8
            });
            format!("#{r:02x}{g:02x}{b:02x}")
        }
        Colour::Ink => "#555555".to_owned(),
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
