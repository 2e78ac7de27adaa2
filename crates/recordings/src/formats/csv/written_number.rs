//! Numbers as people write them in a heading: with a decimal point or comma, and perhaps with thousands set apart.

/// What a written number is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Written {
    /// This number.
    Number(f64),
    /// Three digits follow its only sign: decimals, or thousands.
    Ambiguous {
        /// The number where the sign is the decimal one.
        decimal: f64,
        /// The number where the sign sets thousands apart.
        thousands: f64,
    },
}

/// The number at the start of a text, and what follows it; none where there is none, or one that is not understood. A
/// comma belongs to the number only if `commas` do not separate cells.
pub(super) fn written_number(text: &str, commas: bool) -> Option<(Written, &str)> {
    let (sign, unsigned) = match text.strip_prefix('-') {
        Some(rest) => (-1.0, rest),
        None => (1.0, text.strip_prefix('+').unwrap_or(text)),
    };
    let (digits, rest) = unsigned.split_at(digits_end(unsigned, commas));
    let (exponent, rest) = rest.split_at(exponent_end(rest));
    let signed = match value(digits, exponent)? {
        Written::Number(number) => Written::Number(sign * number),
        Written::Ambiguous { decimal, thousands } => Written::Ambiguous {
            decimal: sign * decimal,
            thousands: sign * thousands,
        },
    };
    Some((signed, rest))
}

/// Whether thousands may be set apart by this, beside a point or a comma.
fn sets_apart(c: char) -> bool {
    matches!(c, ' ' | '\u{a0}' | '\u{202f}' | '\'' | '’')
}

/// Where the digits at the start of a text end, with their signs.
fn digits_end(text: &str, commas: bool) -> usize {
    let digits_after = |at: usize| text[at..].bytes().take_while(u8::is_ascii_digit).count();
    let mut end = 0;
    for (at, c) in text.char_indices() {
        let next = at + c.len_utf8();
        let belongs = match c {
            '0'..='9' => true,
            '.' => digits_after(next) > 0,
            ',' => commas && at > 0 && digits_after(next) > 0,
            c if sets_apart(c) => at > 0 && digits_after(next) == 3,
            _ => false,
        };
        if !belongs {
            break;
        }
        end = next;
    }
    end
}

/// Where an exponent at the start of a text ends; 0 where there is none.
fn exponent_end(text: &str) -> usize {
    let Some(power) = text.strip_prefix(['e', 'E']) else {
        return 0;
    };
    let digits = power.strip_prefix(['+', '-']).unwrap_or(power);
    match digits.bytes().take_while(u8::is_ascii_digit).count() {
        0 => 0,
        count => text.len() - digits.len() + count,
    }
}

/// The number of these digits with their signs, and an exponent.
fn value(digits: &str, exponent: &str) -> Option<Written> {
    let number = |whole: &str, fraction: &str| {
        let whole: String = whole.chars().filter(char::is_ascii_digit).collect();
        format!("{whole}.{fraction}{exponent}").parse::<f64>().ok()
    };
    let (whole, sign, fraction) = match digits.rfind(['.', ',']) {
        Some(at) => (
            &digits[..at],
            digits[at..].chars().next(),
            &digits[at + 1..],
        ),
        None => (digits, None, ""),
    };
    if !fraction.bytes().all(|b| b.is_ascii_digit()) || (whole.is_empty() && fraction.is_empty()) {
        return None;
    }
    let Some(apart) = whole.chars().find(|c| !c.is_ascii_digit()) else {
        let decimal = number(whole, fraction)?;
        let (before, after) = (whole.len(), fraction.len());
        return match sign {
            Some(',') if before > 3 && after > 3 => None,
            Some(_)
                if after == 3
                    && (1..=3).contains(&before)
                    && !whole.starts_with('0')
                    && exponent.is_empty() =>
            {
                let thousands = number(&format!("{whole}{fraction}"), "")?;
                Some(Written::Ambiguous { decimal, thousands })
            }
            _ => Some(Written::Number(decimal)),
        };
    };
    let mut groups = whole.split(apart);
    let first = groups.next().unwrap_or_default();
    let is_group = |group: &str| group.len() == 3 && group.bytes().all(|b| b.is_ascii_digit());
    if !(1..=3).contains(&first.len()) || first.starts_with('0') || !groups.all(is_group) {
        return None;
    }
    match sign {
        Some(sign) if sign == apart => match is_group(fraction) {
            true => number(&format!("{whole}{fraction}"), "").map(Written::Number),
            false => None,
        },
        _ => number(whole, fraction).map(Written::Number),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_with_their_signs() {
        for (text, number, rest) in [
            ("25600 Hz", 25_600.0, " Hz"),
            ("25.6", 25.6, ""),
            ("25,6 kHz", 25.6, " kHz"),
            ("0.512", 0.512, ""),
            ("0,512", 0.512, ""),
            ("25600.000", 25_600.0, ""),
            ("25 600 Hz", 25_600.0, " Hz"),
            ("25'600", 25_600.0, ""),
            ("1 024 000,5", 1_024_000.5, ""),
            ("1,024,000", 1_024_000.0, ""),
            ("1.024.000", 1_024_000.0, ""),
            ("25,600.0", 25_600.0, ""),
            ("25.600,0", 25_600.0, ""),
            ("2.56E+04", 25_600.0, ""),
            ("3,90625E-05 s", 3.90625e-5, " s"),
            ("1.024e3", 1024.0, ""),
            ("-5 Hz", -5.0, " Hz"),
            ("1/25600 s", 1.0, "/25600 s"),
            ("25 60", 25.0, " 60"),
            ("4 e", 4.0, " e"),
        ] {
            let expected = Some((Written::Number(number), rest));
            assert_eq!(written_number(text, true), expected, "{text}");
        }
    }

    #[test]
    fn three_digits_after_the_only_sign_have_two_readings() {
        for text in ["25.600", "25,600"] {
            let expected = Written::Ambiguous {
                decimal: 25.6,
                thousands: 25_600.0,
            };
            assert_eq!(written_number(text, true), Some((expected, "")), "{text}");
        }
        assert_eq!(
            written_number("25,600", false),
            Some((Written::Number(25.0), ",600"))
        );
    }

    #[test]
    fn odd_numbers_are_refused() {
        for text in [
            "",
            "Hz",
            "-",
            "1.2.3",
            "1,23,4",
            "25600,12800",
            "1.024,000.0",
            "0,512,000",
            ",5",
        ] {
            assert_eq!(written_number(text, true), None, "{text}");
        }
    }
}
