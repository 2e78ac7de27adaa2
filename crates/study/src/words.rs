//! What the columns and sensors of a dataset are called on its pages.

use sweep::reader::{Dataset, Label, Meaning};

/// What a label says, in words.
pub fn name(label: &Label) -> String {
    match &label.meaning {
        Meaning::Clearance(joint) => format!("clearance of {}", text::words(joint)),
        Meaning::Speed => "speed".to_owned(),
        Meaning::Pressure { throw, side } => match throw.as_str() {
            "" => format!("{} pressure", side.name()),
            throw => format!("{throw}.{} pressure", side.name()),
        },
        Meaning::Parameter(path) => of_path(path),
    }
}

/// The value of a label in a window, with its unit.
pub fn value(label: &Label, window: usize) -> String {
    let value = label.values[window];
    let unit = text::unit(&label.unit);
    let (factor, unit) = text::readable_unit(value, &unit);
    text::quantity(value * factor, unit)
}

/// The sensor of this number; empty where the dataset has one alone.
pub fn sensor(dataset: &Dataset, sensor: usize) -> String {
    match dataset.sensors.channels() {
        channels @ [_, _, ..] => text::words(&channels[sensor]),
        _ => String::new(),
    }
}

/// A path of the machine file in words: `joints.big_end.contact.stiffness` is «big end contact
/// stiffness».
pub fn of_path(path: &str) -> String {
    let sections = ["joints.", "sensors.", "throws.", "effects."];
    let path = sections.iter().fold(path, |path, section| {
        path.strip_prefix(section).unwrap_or(path)
    });
    text::words(&path.replace('.', " "))
}

#[cfg(test)]
mod tests {
    use super::of_path;

    #[test]
    fn paths_are_read_as_words() {
        assert_eq!(
            of_path("joints.big_end.friction.coefficient"),
            "big end friction coefficient"
        );
        assert_eq!(
            of_path("throws.throw1.joints.guide.clearance"),
            "throw1 joints guide clearance"
        );
        assert_eq!(of_path("crosshead.mass"), "crosshead mass");
        assert_eq!(of_path("effects.ring_leakage.area"), "ring leakage area");
    }
}
