//! What the name of a column says: the quantity, and its unit.

/// How names end for a unit; longer endings stand before those that they end in.
const ENDINGS: [(&str, &str); 31] = [
    ("_bar_g", "barg"),
    ("_bar_a", "bara"),
    ("_psi_g", "psig"),
    ("_psi_a", "psia"),
    ("_kpa_g", "kPag"),
    ("_barg", "barg"),
    ("_bara", "bara"),
    ("_psig", "psig"),
    ("_psia", "psia"),
    ("_in_s", "in/s"),
    ("_mbar", "mbar"),
    ("_mg", "mg"),
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
    if let Some((name, unit)) = in_brackets(heading) {
        let reference = ["g", "a", "gauge", "abs"].contains(&unit.to_lowercase().as_str());
        let pressure = name.rsplit([' ', '_']).next().unwrap_or_default();
        // `p bar(g)`: the brackets hold the reference of a pressure.
        if reference && is_pressure(pressure) {
            let before = name[..name.len() - pressure.len()].trim_end_matches([' ', '_']);
            let name = if before.is_empty() { pressure } else { before };
            return (name.to_owned(), Some(format!("{pressure}({unit})")));
        }
        let unit = (!unit.is_empty()).then(|| unit.to_owned());
        return (name.to_owned(), unit);
    }
    let unit = ending(heading).map(|(_, unit)| unit.to_owned());
    (heading.to_owned(), unit)
}

/// What stands before brackets at the end, and in them.
fn in_brackets(heading: &str) -> Option<(&str, &str)> {
    let mut pairs = [('[', ']'), ('(', ')')].into_iter();
    let (open, close) = pairs.find(|(_, close)| heading.ends_with(*close))?;
    let mut depth = 0;
    let at = heading.char_indices().rev().find(|(_, c)| {
        depth += i32::from(*c == close) - i32::from(*c == open);
        depth == 0
    });
    let (name, inside) = heading.split_at(at?.0);
    let name = name.trim();
    let inside = inside.strip_prefix(open)?.strip_suffix(close)?;
    (!name.is_empty()).then(|| (name, inside.trim()))
}

/// Whether this is a unit of pressure without a reference, in letters of any case.
fn is_pressure(unit: &str) -> bool {
    [
        "bar", "mbar", "psi", "pa", "kpa", "mpa", "kg/cm2", "kgf/cm2",
    ]
    .contains(&unit.to_lowercase().as_str())
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

/// What the heading of a column of time says of its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum TimeUnit {
    /// That it is so many seconds.
    Seconds(f64),
    /// Nothing.
    Unstated,
}

/// The unit of a column of time (`t`, `t_s`, `time`, `Time [ms]`, `Zeit [s]`, `Time ms`, `t/ms`); none for other columns.
pub(crate) fn time_unit(name: &str, unit: Option<&str>) -> Option<TimeUnit> {
    let seconds = |unit| seconds_of_unit(unit).map(TimeUnit::Seconds);
    let is_time = |name: &str| TIMES.contains(&name.to_lowercase().as_str());
    if is_time(stem(name)) {
        return unit.map_or(Some(TimeUnit::Unstated), seconds);
    }
    let (before, after) = name.rsplit_once(['/', ' ', '_'])?;
    let is_alone = unit.is_none() && is_time(before.trim_end_matches([' ', ',', '/']));
    is_alone.then(|| seconds(after)).flatten()
}

/// Seconds in a unit of time; none for other units. Capitals do not count in words.
pub(crate) fn seconds_of_unit(unit: &str) -> Option<f64> {
    let lower = unit.to_lowercase();
    let word = if lower.len() >= SHORTEST_ANY_CASE {
        &lower
    } else {
        unit
    };
    match word {
        "s" | "sec" | "secs" | "second" | "seconds" => Some(1.0),
        "ms" | "msec" | "msecs" | "millisec" | "millisecond" | "milliseconds" => Some(1e-3),
        "us" | "µs" | "μs" | "usec" | "µsec" | "μsec" | "microsecond" | "microseconds" => {
            Some(1e-6)
        }
        "ns" | "nsec" | "nanosecond" | "nanoseconds" => Some(1e-9),
        "min" | "minute" | "minutes" => Some(60.0),
        "h" | "hr" | "hrs" | "hour" | "hours" => Some(3600.0),
        _ => None,
    }
}

/// Whether a cell has nothing but a unit that channels usually have, with or without brackets.
pub(crate) fn is_unit(cell: &str) -> bool {
    let cell = cell.trim_matches(['[', ']', '(', ')', ' ']);
    let others = [
        "V", "mV", "m/s²", "m/s2", "m/sec^2", "mm/sec", "in/sec", "ips", "mil", "mils", "µm", "um",
        "hPa", "kPag", "kPaa", "kg/cm2", "kg/cm²", "kgf/cm2", "°", "°C", "%",
    ];
    let mut known = ENDINGS.iter().map(|(_, unit)| *unit).chain(others);
    // `bar g` and `psi (g)` as `barg` and `psig`. Short names of columns are like units in other letters.
    let small = cell.to_lowercase().replace([' ', '(', ')'], "");
    let is_alike = |unit: &str| small.len() >= SHORTEST_ANY_CASE && unit.to_lowercase() == small;
    let is_time = cell != "h" && seconds_of_unit(cell).is_some();
    is_time || known.any(|unit| unit == cell || is_alike(unit))
}

/// Bytes of a unit from which its capitals do not count.
const SHORTEST_ANY_CASE: usize = 3;

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
            ("p [bar(g)]", "p", Some("bar(g)")),
            ("p (bar(g))", "p", Some("bar(g)")),
            ("p bar(g)", "p", Some("bar(g)")),
            ("Discharge PSI (g)", "Discharge", Some("PSI(g)")),
            ("bar(g)", "bar", Some("bar(g)")),
            ("p_bar_g", "p_bar_g", Some("barg")),
            ("crossbar (g)", "crossbar", Some("g")),
            ("acc (z) [mg]", "acc (z)", Some("mg")),
            ("a]", "a]", None),
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
    fn cells_with_units_are_told_from_names() {
        for cell in [
            "[bar]",
            "PSI",
            "bar g",
            "(psi (g))",
            "m/s²",
            "s",
            "g",
            "KPA",
        ] {
            assert!(is_unit(cell), "{cell}");
        }
        for cell in ["A", "G", "MM", "M", "acc", "", "Kanal 1"] {
            assert!(!is_unit(cell), "{cell}");
        }
    }

    #[test]
    fn time_is_recognised() {
        for (heading, seconds) in [
            ("t_s", Some(1.0)),
            ("Time [ms]", Some(1e-3)),
            ("time_us", Some(1e-6)),
            ("Zeit [s]", Some(1.0)),
            ("torque", None),
            ("time [V]", None),
            ("Time [msec]", Some(1e-3)),
            ("Time [usec]", Some(1e-6)),
            ("Time [min]", Some(60.0)),
            ("Time [h]", Some(3600.0)),
            ("Time (sec)", Some(1.0)),
            ("Time [Milliseconds]", Some(1e-3)),
            ("Time ms", Some(1e-3)),
            ("t/ms", Some(1e-3)),
            ("Time, s", Some(1.0)),
            ("elapsed time [s]", Some(1.0)),
            ("Time [mS]", None),
            ("lag time V", None),
        ] {
            let (name, unit) = name_and_unit(heading);
            let expected = seconds.map(TimeUnit::Seconds);
            assert_eq!(time_unit(&name, unit.as_deref()), expected, "{heading}");
        }
        for heading in ["t", "Time", "elapsed time"] {
            assert_eq!(time_unit(heading, None), Some(TimeUnit::Unstated));
        }
    }
}
