//! The numbers that the tables say about a case: clearances, operating point, parameters.

use ::report::text;
use sweep::Plan;

/// A column of numbers that describe a case.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Label {
    pub(super) column: String,
    /// What it is, in words.
    pub(super) name: String,
    /// Its unit, as people write it; empty for none.
    pub(super) unit: String,
    /// The joint whose clearance it is.
    pub(super) joint: Option<String>,
}

/// The labels of the tables of `plan`, in their order. Parameters that are text are left out.
pub(super) fn of(plan: &Plan) -> Vec<Label> {
    let label = |column: String, name: String, unit: &str| Label {
        column,
        name,
        unit: text::unit(unit),
        joint: None,
    };
    let mut labels: Vec<Label> = plan
        .joints
        .iter()
        .map(|joint| Label {
            joint: Some(joint.name.clone()),
            ..label(
                format!("clearance_{}_m", joint.name),
                format!("clearance of {}", text::words(&joint.name)),
                "m",
            )
        })
        .collect();
    labels.push(label("speed_rpm".into(), "speed".into(), "rpm"));
    for throw in plan.throws() {
        for side in ["suction", "discharge"] {
            let prefix = match throw.as_str() {
                "" => String::new(),
                throw => format!("{throw}."),
            };
            labels.push(label(
                format!("{prefix}{side}_pressure_pa"),
                format!("{prefix}{side} pressure"),
                "Pa",
            ));
        }
    }
    let numbers = plan.parameters.iter().filter(|p| p.is_number);
    labels.extend(numbers.map(|parameter| {
        let unit = parameter.unit.as_deref().filter(|unit| *unit != "%");
        label(
            parameter.column.clone(),
            in_words(&parameter.path),
            unit.unwrap_or_default(),
        )
    }));
    labels
}

/// A path of the machine file in words: `joints.big_end.contact.stiffness` is «big end contact
/// stiffness».
pub(super) fn in_words(path: &str) -> String {
    let sections = ["joints.", "sensors.", "throws.", "effects."];
    let path = sections.iter().fold(path, |path, section| {
        path.strip_prefix(section).unwrap_or(path)
    });
    text::words(&path.replace('.', " "))
}

#[cfg(test)]
mod tests {
    use super::in_words;

    #[test]
    fn paths_are_read_as_words() {
        assert_eq!(
            in_words("joints.big_end.friction.coefficient"),
            "big end friction coefficient"
        );
        assert_eq!(
            in_words("throws.throw1.joints.guide.clearance"),
            "throw1 joints guide clearance"
        );
        assert_eq!(in_words("crosshead.mass"), "crosshead mass");
        assert_eq!(in_words("effects.ring_leakage.area"), "ring leakage area");
    }
}
