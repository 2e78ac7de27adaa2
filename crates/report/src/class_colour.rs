//! The colour of each class of a dataset, on every page alike.

use figure::Colour;
use study::classes::HEALTHY;

/// The colour of a label: grey for the healthy machine, and for a joint the colour of its place
/// among the machine's `joints`. Other `labels` (several joints, effects) get the next free
/// colours.
pub(crate) fn class_colour<'a>(
    label: &str,
    joints: &[String],
    labels: impl Iterator<Item = &'a str>,
) -> Colour {
    if label == HEALTHY {
        return Colour::Ink;
    }
    if let Some(place) = joints.iter().position(|joint| joint == label) {
        return Colour::Class(place);
    }
    let is_other = |label: &&str| *label != HEALTHY && !joints.iter().any(|joint| joint == label);
    let mut others: Vec<&str> = labels.filter(is_other).collect();
    others.sort_unstable();
    others.dedup();
    let place = others.iter().position(|other| *other == label);
    place.map_or(Colour::Ink, |place| Colour::Class(joints.len() + place))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_label_has_one_colour() {
        let joints = ["main", "big_end", "small_end", "guide"].map(String::from);
        let all = ["small_end", "ring_leakage", "none", "big_end+small_end"];
        let few = ["big_end", "none"];
        let colour = |label| class_colour(label, &joints, all.into_iter());
        assert_eq!(colour("none"), Colour::Ink);
        assert_eq!(colour("small_end"), Colour::Class(2));
        // Whichever others a page shows.
        assert_eq!(
            class_colour("big_end", &joints, few.into_iter()),
            colour("big_end")
        );
        assert_eq!(colour("big_end+small_end"), Colour::Class(4));
        assert_eq!(colour("ring_leakage"), Colour::Class(5));
    }
}
