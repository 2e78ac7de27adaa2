//! The classes of a dataset: what the label of each is called.

use sweep::labels::NONE;

/// The label of a machine without any fault.
pub const HEALTHY: &str = NONE;

/// The label in words; a machine without fault is healthy.
pub fn name(label: &str) -> String {
    match label {
        HEALTHY => "healthy".to_owned(),
        label => text::words(label),
    }
}

/// Whether the label `many` names all joints of the label `few`, and more.
pub fn has_more_joints(many: &str, few: &str) -> bool {
    let [many, few] = [many, few].map(|label| label.split('+').collect::<Vec<_>>());
    few.len() < many.len() && few.iter().all(|joint| many.contains(joint))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_named_in_words() {
        assert_eq!(
            [name("none"), name("big_end+main")],
            ["healthy", "big end + main"]
        );
        assert!(has_more_joints("main+big_end", "big_end"));
        assert!(!has_more_joints("main+big_end", "guide"));
    }
}
