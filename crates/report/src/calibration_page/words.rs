//! Paths and columns as people say them.

/// A path of the machine file in words: `joints.big_end.contact.stiffness` is «big end contact
/// stiffness».
pub(super) fn path(path: &str) -> String {
    if let Some((joints, value)) = path.split_once(".contact.relation.") {
        let of = match joints.ends_with('*') {
            true => String::new(),
            false => format!(" at the {}", self::path(joints)),
        };
        return format!("exponent of the clearance in the {value}{of}");
    }
    let parts: Vec<&str> = path
        .split('.')
        .filter(|part| !matches!(*part, "joints" | "throws"))
        .collect();
    text::words(&parts.join(" "))
}

/// A column as its quantity and unit: `throw1.cylinder_pressure_pa` is «throw1 cylinder pressure» in
/// Pa.
pub(crate) fn column(column: &str) -> (String, &'static str) {
    let units = [
        ("_m_s2", "m/s²"),
        ("_pa", "Pa"),
        ("_rad", "rad"),
        ("_m", "m"),
    ];
    let found = units
        .iter()
        .find_map(|(ending, unit)| Some((column.strip_suffix(ending)?, *unit)));
    let (name, unit) = found.unwrap_or((column, ""));
    (text::words(&name.replace('.', " ")), unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_and_columns_are_said_in_words() {
        for (given, said) in [
            (
                "joints.big_end.contact.stiffness",
                "big end contact stiffness",
            ),
            (
                "throws.throw2.joints.small_end.friction.coefficient",
                "throw2 small end friction coefficient",
            ),
            (
                "throws.throw1.cylinder.head_clearance",
                "throw1 cylinder head clearance",
            ),
            ("joints.big_end.clearance", "big end clearance"),
            (
                "joints.*.contact.relation.damping",
                "exponent of the clearance in the damping",
            ),
            ("speed", "speed"),
            ("", ""),
        ] {
            assert_eq!(path(given), said);
        }
        assert_eq!(
            column("throw1.cylinder_pressure_pa"),
            ("throw1 cylinder pressure".to_owned(), "Pa")
        );
        assert_eq!(column("p").1, "");
    }
}
