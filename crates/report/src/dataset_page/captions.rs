//! What the figures show, said from the numbers.

use super::Response;
use crate::text;

/// Size and extent of a response.
pub(super) struct Level {
    /// Largest absolute acceleration.
    pub(super) peak: f64,
    /// Root mean square of the acceleration.
    pub(super) rms: f64,
}

impl Level {
    /// None for a response without a finite value.
    pub(super) fn of(response: &Response) -> Option<Self> {
        let finite = || response.acceleration_m_s2.iter().filter(|a| a.is_finite());
        let count = finite().count();
        let peak = finite().fold(0.0_f64, |peak, a| peak.max(a.abs()));
        let mean_square = finite().map(|a| a * a).sum::<f64>() / count as f64;
        (count > 0).then(|| Self {
            peak,
            rms: mean_square.sqrt(),
        })
    }
}

/// How a quantity goes along an ordered sequence: «rises at every step from a to b».
pub(super) fn trend(values: &[f64], unit: &str) -> String {
    let (Some(&first), Some(&last)) = (values.first(), values.last()) else {
        return "is not there".to_owned();
    };
    let (from, to) = (text::quantity(first, unit), text::quantity(last, unit));
    if values.len() == 1 {
        return format!("is {from}");
    }
    let way = if values.windows(2).all(|pair| pair[1] > pair[0]) {
        "rises at every step from"
    } else if values.windows(2).all(|pair| pair[1] < pair[0]) {
        "falls at every step from"
    } else {
        "does not go one way: it goes from"
    };
    format!("{way} {from} to {to}")
}

/// The names with the highest and the lowest value: «largest for a (12 m/s²), smallest for b (3 m/s²)».
pub(super) fn ends(named: &[(String, f64)], unit: &str) -> String {
    let pick = |better: fn(f64, f64) -> bool| {
        named
            .iter()
            .fold(None, |best: Option<&(String, f64)>, one| match best {
                Some(best) if !better(one.1, best.1) => Some(best),
                _ => Some(one),
            })
    };
    let (Some(largest), Some(smallest)) = (pick(|a, b| a > b), pick(|a, b| a < b)) else {
        return "not there".to_owned();
    };
    let said = |(name, value): &(String, f64)| format!("{name} ({})", text::quantity(*value, unit));
    if largest.0 == smallest.0 {
        return format!("{} for {}", text::quantity(largest.1, unit), largest.0);
    }
    format!(
        "largest for {}, smallest for {}",
        said(largest),
        said(smallest)
    )
}

/// Where the data of the responses are: «case-3 in signals/…; case-4 in …».
pub(super) fn places<'a>(responses: impl IntoIterator<Item = &'a Response>) -> String {
    let mut files: Vec<(&str, Vec<&str>)> = Vec::new();
    for response in responses {
        match files.iter_mut().find(|(file, _)| *file == response.file) {
            Some((_, cases)) => cases.push(&response.case_id),
            None => files.push((&response.file, vec![&response.case_id])),
        }
    }
    let each = files
        .iter()
        .map(|(file, cases)| format!("{} in {file}", cases.join(", ")));
    each.collect::<Vec<_>>().join("; ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trends_say_what_the_numbers_do() {
        assert_eq!(
            trend(&[1.0, 2.0, 5.0], "m"),
            "rises at every step from 1\u{a0}m to 5\u{a0}m"
        );
        assert_eq!(trend(&[3.0, 2.0], ""), "falls at every step from 3 to 2");
        assert_eq!(
            trend(&[1.0, 3.0, 2.0], ""),
            "does not go one way: it goes from 1 to 2"
        );
        assert_eq!(trend(&[4.0], ""), "is 4");
        assert_eq!(trend(&[], ""), "is not there");
    }

    #[test]
    fn the_ends_are_named() {
        let named = |values: &[(&str, f64)]| {
            values
                .iter()
                .map(|(n, v)| ((*n).to_owned(), *v))
                .collect::<Vec<_>>()
        };
        assert_eq!(
            ends(&named(&[("a", 2.0), ("b", 7.0)]), ""),
            "largest for b (7), smallest for a (2)"
        );
        assert_eq!(ends(&named(&[("a", 2.0)]), ""), "2 for a");
        assert_eq!(ends(&[], ""), "not there");
    }

    #[test]
    fn places_name_each_file_once() {
        let at = |case_id: &str, file: &str| Response {
            case_id: case_id.to_owned(),
            file: file.to_owned(),
            ..Response::default()
        };
        let responses = [at("case-1", "a"), at("case-2", "b"), at("case-3", "a")];
        assert_eq!(places(&responses), "case-1, case-3 in a; case-2 in b");
    }

    #[test]
    fn the_level_of_a_response_leaves_out_what_is_not_a_number() {
        let response = Response {
            acceleration_m_s2: vec![3.0, f64::NAN, -4.0],
            ..Response::default()
        };
        let level = Level::of(&response).unwrap();
        assert_eq!((level.peak, level.rms), (4.0, 12.5_f64.sqrt()));
        assert!(Level::of(&Response::default()).is_none());
    }
}
