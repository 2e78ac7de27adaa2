//! What the name of a column says: the quantity, and its unit.

/// How names end for a unit; longer endings stand before those that they end in.
const ENDINGS: [(&str, &str); 19] = [
    ("_m_s2", "m/s^2"),
    ("_mm_s", "mm/s"),
    ("_m_s", "m/s"),
    ("_n_m", "N m"),
    ("_kpa", "kPa"),
    ("_mpa", "MPa"),
    ("_pa", "Pa"),
    ("_bar", "bar"),
    ("_psi", "psi"),
    ("_rad", "rad"),
    ("_deg", "deg"),
    ("_rpm", "rpm"),
    ("_hz", "Hz"),
    ("_mm", "mm"),
    ("_ms", "ms"),
    ("_us", "us"),
    ("_m", "m"),
    ("_g", "g"),
    ("_s", "s"),
];

/// The name and the unit of a column headed `acc [m/s^2]`, `acc (m/s^2)` or `acc_m_s2`. Only a
/// unit in brackets is taken off the name.
pub(crate) fn name_and_unit(heading: &str) -> (String, Option<String>) {
    let heading = heading.trim();
    for (open, close) in [('[', ']'), ('(', ')')] {
        let Some((name, unit)) = heading
            .strip_suffix(close)
            .and_then(|rest| rest.rsplit_once(open))
        else {
            continue;
        };
        if !name.trim().is_empty() {
            let unit = unit.trim();
            return (
                name.trim().to_owned(),
                Some(unit.to_owned()).filter(|u| !u.is_empty()),
            );
        }
    }
    let unit = ending(heading).map(|(_, unit)| unit.to_owned());
    (heading.to_owned(), unit)
}

/// The name without the unit that it ends in: `acc` of `acc_m_s2`.
pub fn stem(name: &str) -> &str {
    ending(name).map_or(name, |(ending, _)| &name[..name.len() - ending.len()])
}

fn ending(name: &str) -> Option<(&'static str, &'static str)> {
    let ends = |ending: &str| {
        name.len() > ending.len()
            && name.is_char_boundary(name.len() - ending.len())
            && name[name.len() - ending.len()..].eq_ignore_ascii_case(ending)
    };
    ENDINGS.into_iter().find(|(ending, _)| ends(ending))
}

/// What a column of time is called, in small letters.
const TIMES: [&str; 9] = [
    "t",
    "time",
    "elapsed time",
    "elapsed_time",
    "zeit",
    "temps",
    "tempo",
    "tiempo",
    "tid",
];

/// Seconds per unit of a column of time (`t`, `t_s`, `time`, `Time [ms]`, `Zeit [s]`); none for other columns.
pub(crate) fn seconds_per_unit(name: &str, unit: Option<&str>) -> Option<f64> {
    match TIMES.contains(&stem(name).to_lowercase().as_str()) {
        true => seconds_of_unit(unit.unwrap_or("s")),
        false => None,
    }
}

/// Seconds in a unit of time; none for other units.
pub(crate) fn seconds_of_unit(unit: &str) -> Option<f64> {
    match unit {
        "s" | "sec" | "seconds" => Some(1.0),
        "ms" | "milliseconds" => Some(1e-3),
        "us" | "µs" | "microseconds" => Some(1e-6),
        "ns" => Some(1e-9),
        "min" => Some(60.0),
        _ => None,
    }
}

/// Whether a cell has nothing but a unit that channels usually have, with or without brackets.
pub(crate) fn is_unit(cell: &str) -> bool {
    let cell = cell.trim_matches(['[', ']', '(', ')', ' ']);
    let others = [
        "V", "mV", "mm/s", "m/s²", "m/s2", "psig", "psia", "barg", "bara", "°", "°C", "%",
    ];
    let known = ENDINGS.iter().map(|(_, unit)| *unit).chain(others);
    seconds_of_unit(cell).is_some() || known.into_iter().any(|unit| unit == cell)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_found_in_headings() {
        for (heading, name, unit) in [
            ("acc [m/s^2]", "acc", Some("m/s^2")),
            (" Druck (bar)", "Druck", Some("bar")),
            (
                "throw1.crosshead_acceleration_m_s2",
                "throw1.crosshead_acceleration_m_s2",
                Some("m/s^2"),
            ),
            ("ACC_G", "ACC_G", Some("g")),
            ("acc", "acc", None),
            ("acc []", "acc", None),
            ("[V]", "[V]", None),
            ("_s", "_s", None),
            ("größe_µ", "größe_µ", None),
        ] {
            let expected = (name.to_owned(), unit.map(str::to_owned));
            assert_eq!(name_and_unit(heading), expected, "{heading}");
        }
        assert_eq!(stem("acc_m_s2"), "acc");
        assert_eq!(stem("acc"), "acc");
    }

    #[test]
    fn time_is_recognised() {
        for (heading, seconds) in [
            ("t", Some(1.0)),
            ("t_s", Some(1.0)),
            ("Time [ms]", Some(1e-3)),
            ("time_us", Some(1e-6)),
            ("Zeit [s]", Some(1.0)),
            ("torque", None),
            ("time [V]", None),
        ] {
            let (name, unit) = name_and_unit(heading);
            assert_eq!(
                seconds_per_unit(&name, unit.as_deref()),
                seconds,
                "{heading}"
            );
        }
    }
}
