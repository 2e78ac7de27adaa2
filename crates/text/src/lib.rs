//! Words and numbers as a reader wants to see them.

/// The text with everything that XML or HTML would take for markup written as entities.
///
/// Characters that XML 1.0 does not allow at all (most control characters) become U+FFFD.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\t' | '\n' | '\r' => out.push(' '),
            '\u{0}'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => out.push('\u{fffd}'),
            other => out.push(other),
        }
    }
    out
}

/// The number to `digits` significant digits, without trailing zeros.
///
/// Uses a true minus sign, groups thousands from 10 000 on, and writes very large and very small
/// numbers as a power of ten. A number that is not finite is «–».
pub fn number(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let digits = digits.max(1);
    // Rounding first: 9.996 to three digits is 10.0, one decimal less than 9.99 has.
    let scientific = format!("{value:.*e}", digits - 1);
    let Some((mantissa, exponent)) = scientific.split_once('e') else {
        return scientific;
    };
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if !(-4..7).contains(&exponent) {
        let mantissa = trim_zeros(mantissa).replace('-', "−");
        return format!("{mantissa} × 10{}", superscript(exponent));
    }
    let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
    let fixed = scientific
        .parse::<f64>()
        .map_or(scientific.clone(), |rounded| {
            format!("{rounded:.decimals$}")
        });
    group(trim_zeros(&fixed))
}

/// The number with a fixed count of decimals, a true minus sign and grouped thousands.
pub fn decimal(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    let fixed = format!("{value:.decimals$}");
    let is_zero = fixed.bytes().all(|b| matches!(b, b'-' | b'0' | b'.'));
    group(if is_zero {
        fixed.trim_start_matches('-')
    } else {
        &fixed
    })
}

/// A number to three significant digits with its unit; an empty unit is left out.
pub fn quantity(value: f64, unit: &str) -> String {
    let number = number(value, 3);
    if unit.is_empty() {
        number
    } else {
        format!("{number}\u{a0}{unit}")
    }
}

/// The unit that suits values up to `largest` in `unit`, and what to multiply them by: lengths below
/// a decimetre are read in millimetres, pressures in kilopascals or megapascals.
pub fn readable_unit(largest: f64, unit: &str) -> (f64, &str) {
    match unit {
        "m" if largest.abs() < 0.1 => (1e3, "mm"),
        "Pa" if largest.abs() >= 1e7 => (1e-6, "MPa"),
        "Pa" if largest.abs() >= 1e3 => (1e-3, "kPa"),
        _ => (1.0, unit),
    }
}

/// A number to three significant digits with the SI prefix that leaves it between 1 and 1000: `1.25 kW`,
/// `340 µm`. The unit is one that takes prefixes.
pub fn prefixed(value: f64, unit: &str) -> String {
    const PREFIXES: [(f64, &str); 6] = [
        (1e6, "M"),
        (1e3, "k"),
        (1.0, ""),
        (1e-3, "m"),
        (1e-6, "µ"),
        (1e-9, "n"),
    ];
    // To three digits 999.6 is 1000, which has the next prefix.
    let size = value.abs() * 1.0005;
    let fits = PREFIXES.iter().find(|(factor, _)| size >= *factor);
    let (factor, prefix) = match value {
        0.0 => (1.0, ""),
        _ => *fits.unwrap_or(&PREFIXES[PREFIXES.len() - 1]),
    };
    format!("{} {prefix}{unit}", number(value / factor, 3))
}

/// A name with its unit in parentheses; an empty unit is left out.
pub fn with_unit(name: &str, unit: &str) -> String {
    if unit.is_empty() {
        name.to_owned()
    } else {
        format!("{name} ({unit})")
    }
}

/// A unit of the data with its powers raised: `m/s^2` is «m/s²». Fractional powers stay.
pub fn unit(unit: &str) -> String {
    let mut parts = unit.split('^');
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let end = part.find(|c: char| !c.is_ascii_digit() && c != '.');
        let (power, rest) = part.split_at(end.unwrap_or(part.len()));
        match power.parse() {
            Ok(power) => out += &superscript(power),
            Err(_) => out = format!("{out}^{power}"),
        }
        out += rest;
    }
    out
}

/// A radial clearance given in metres, in millimetres as the field writes it: «0.1 mm».
pub fn clearance(metres: f64) -> String {
    quantity(metres * 1e3, "mm")
}

/// A mean and its spread with the same decimals; the spread has two significant digits.
pub fn mean_and_spread(mean: f64, spread: f64) -> String {
    if !mean.is_finite() || !spread.is_finite() || spread <= 0.0 {
        return number(mean, 3);
    }
    let decimals = 1.0 - spread.log10().floor();
    if !(0.0..=6.0).contains(&decimals) {
        return format!("{} ± {}", number(mean, 3), number(spread, 2));
    }
    let decimals = decimals as usize;
    format!(
        "{} ± {}",
        decimal(mean, decimals),
        decimal(spread, decimals)
    )
}

/// A count with grouped thousands.
pub fn count(n: usize) -> String {
    group(&n.to_string())
}

/// A count with its noun: «1 case», «12 cases».
pub fn counted(n: usize, noun: &str) -> String {
    format!("{}\u{a0}{noun}{}", count(n), if n == 1 { "" } else { "s" })
}

/// A label of the data in words: `big_end+small_end` is «big end + small end».
pub fn words(label: &str) -> String {
    label.replace('_', " ").replace('+', " + ")
}

/// The words with a capital first letter.
pub fn capitalised(words: &str) -> String {
    let mut rest = words.chars();
    rest.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(rest).collect()
    })
}

/// The integer in superscript digits: −3 is «⁻³».
pub fn superscript(n: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    n.to_string()
        .bytes()
        .map(|b| {
            if b == b'-' {
                '⁻'
            } else {
                DIGITS[usize::from(b - b'0')]
            }
        })
        .collect()
}

/// At most `length` characters of the text, the last one an ellipsis where some were left out.
pub fn shortened(text: &str, length: usize) -> String {
    if text.chars().count() <= length {
        return text.to_owned();
    }
    let kept: String = text.chars().take(length.saturating_sub(1)).collect();
    format!("{}…", kept.trim_end())
}

fn trim_zeros(fixed: &str) -> &str {
    if fixed.contains('.') {
        fixed.trim_end_matches('0').trim_end_matches('.')
    } else {
        fixed
    }
}

/// Thin spaces between thousands where there are five digits or more before the point.
fn group(fixed: &str) -> String {
    let (sign, digits) = fixed
        .strip_prefix('-')
        .map_or(("", fixed), |rest| ("−", rest));
    let (whole, fraction) = digits
        .find('.')
        .map_or((digits, ""), |at| digits.split_at(at));
    let mut grouped = String::from(sign);
    for (i, digit) in whole.chars().enumerate() {
        if i > 0 && whole.len() > 4 && (whole.len() - i) % 3 == 0 {
            grouped.push('\u{202f}');
        }
        grouped.push(digit);
    }
    grouped + fraction
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prefixes_leave_numbers_between_one_and_a_thousand() {
        for (value, unit, expected) in [
            (1254.0, "W", "1.25 kW"),
            (-0.00034, "m", "−340 µm"),
            (999.6, "N", "1 kN"),
            (0.0, "m/s", "0 m/s"),
            (4.2e-3, "m/s", "4.2 mm/s"),
            (3.93e5, "Pa", "393 kPa"),
            (2e-12, "m", "0.002 nm"),
        ] {
            assert_eq!(prefixed(value, unit), expected);
        }
    }

    #[test]
    fn numbers_have_the_digits_asked_for() {
        assert_eq!(number(0.1, 3), "0.1");
        assert_eq!(number(9.996, 3), "10");
        assert_eq!(number(-1234.5, 3), "−1230");
        assert_eq!(number(123_456.0, 6), "123\u{202f}456");
        assert_eq!(number(0.000_012_34, 3), "1.23 × 10⁻⁵");
        assert_eq!(number(2.4e10, 2), "2.4 × 10¹⁰");
        assert_eq!(number(f64::NAN, 3), "–");
        assert_eq!(decimal(-0.001, 2), "0.00");
        assert_eq!(clearance(1e-4), "0.1\u{a0}mm");
        assert_eq!(readable_unit(4e-4, "m"), (1e3, "mm"));
        assert_eq!(readable_unit(4e5, "Pa"), (1e-3, "kPa"));
        assert_eq!(readable_unit(400.0, "rpm"), (1.0, "rpm"));
    }

    #[test]
    fn a_mean_is_written_as_precisely_as_its_spread() {
        assert_eq!(mean_and_spread(123.456, 1.234), "123.5 ± 1.2");
        assert_eq!(mean_and_spread(123.456, 12.34), "123 ± 12");
        assert_eq!(mean_and_spread(3.0, 0.0), "3");
        assert_eq!(mean_and_spread(f64::NAN, f64::NAN), "–");
        assert_eq!(
            mean_and_spread(2_345_678.0, 345_678.0),
            "2\u{202f}350\u{202f}000 ± 350\u{202f}000"
        );
    }

    #[test]
    fn markup_and_control_characters_are_made_harmless() {
        assert_eq!(
            escape("<a b=\"c\">&'\u{0}"),
            "&lt;a b=&quot;c&quot;&gt;&amp;&#39;\u{fffd}"
        );
    }

    #[test]
    fn labels_become_words() {
        assert_eq!(unit("m^2/s^4"), "m²/s⁴");
        assert_eq!(unit("N/m^1.5"), "N/m^1.5");
        assert_eq!(unit("rpm"), "rpm");
        assert_eq!(words("throw1.big_end+main"), "throw1.big end + main");
        assert_eq!(capitalised("big end"), "Big end");
        assert_eq!(shortened("Crosshead", 6), "Cross…");
    }
}
