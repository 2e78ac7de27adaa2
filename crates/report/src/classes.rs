//! The classes of a dataset: what each label is called and which colour it has, on every page alike.

use crate::figure::Colour;
use crate::text;

/// The label of a machine without any fault.
pub(crate) const HEALTHY: &str = "none";

/// The label in words; a machine without fault is healthy.
pub fn name(label: &str) -> String {
    match label {
        HEALTHY => "healthy".to_owned(),
        label => text::words(label),
    }
}

/// The colour of a label: grey for the healthy machine, and for a joint the colour of its place
/// among the machine's `joints`. Other `labels` (several joints, effects) get the next free
/// colours.
pub(crate) fn colour<'a>(
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

/// Whether the label `many` names all joints of the label `few`, and more.
pub(crate) fn has_more_joints(many: &str, few: &str) -> bool {
    let [many, few] = [many, few].map(|label| label.split('+').collect::<Vec<_>>());
    few.len() < many.len() && few.iter().all(|joint| many.contains(joint))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_label_has_one_name_and_one_colour() {
        let joints = ["main", "big_end", "small_end", "guide"].map(String::from);
        let all = ["small_end", "ring_leakage", "none", "big_end+small_end"];
        let few = ["big_end", "none"];
        let colour = |label| colour(label, &joints, all.into_iter());
        assert_eq!(colour("none"), Colour::Ink);
        assert_eq!(colour("small_end"), Colour::Class(2));
        // Whichever others a page shows.
        assert_eq!(
            super::colour("big_end", &joints, few.into_iter()),
            colour("big_end")
        );
        assert_eq!(colour("big_end+small_end"), Colour::Class(4));
        assert_eq!(colour("ring_leakage"), Colour::Class(5));
        assert_eq!(
            [name("none"), name("big_end+main")],
            ["healthy", "big end + main"]
        );
    }
}
