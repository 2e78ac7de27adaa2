//! What the figures show, said from the numbers.

use crate::revolutions::Revolutions;
use std::cmp::Ordering;
use study::Level;
use study::recording::Response;

/// Parts of a recording over which the spread of its levels is taken: enough for a spread that is
/// known to a quarter, and each long enough for a motion that repeats itself after a few revolutions.
const PARTS: usize = 10;

/// Peak and root mean square of a response over its finite values; none where there is no finite value.
pub(super) fn levels(response: &Response) -> Option<[Level; 2]> {
    let turns = Revolutions::new(&response.crank_angle_rad, &response.acceleration_m_s2);
    let complete: Vec<&Vec<[f64; 2]>> = turns.complete().collect();
    let parts = complete.chunks(complete.len().div_ceil(PARTS).max(1));
    let part = |values: &mut dyn Iterator<Item = f64>| {
        let (mut count, mut peak, mut sum) = (0, 0.0_f64, 0.0);
        for value in values.filter(|value| value.is_finite()) {
            count += 1;
            peak = peak.max(value.abs());
            sum += value * value;
        }
        (count > 0).then(|| [peak, sum / f64::from(count)])
    };
    let of_parts: Vec<[f64; 2]> = parts
        .filter_map(|turns| part(&mut turns.iter().copied().flatten().map(|point| point[1])))
        .collect();
    let [peak, square] = part(&mut response.acceleration_m_s2.iter().copied())?;
    let column = |at: usize| of_parts.iter().map(|part| part[at]).collect::<Vec<_>>();
    Some([
        Level {
            value: peak,
            ..Level::largest(&column(0))
        },
        Level {
            value: square.sqrt(),
            ..Level::root_mean(&column(1))
        },
    ])
}

/// How a level goes along an ordered sequence: «rises at every step from a to b».
pub(super) fn trend(values: &[Level], unit: &str) -> String {
    let (Some(first), Some(last)) = (values.first(), values.last()) else {
        return "is not there".to_owned();
    };
    let (from, to) = (
        text::quantity(first.value, unit),
        text::quantity(last.value, unit),
    );
    if values.len() == 1 {
        return format!("is {from}");
    }
    let steps: Vec<Ordering> = values
        .windows(2)
        .map(|two| two[1].against(two[0]))
        .collect();
    let all = |way: Ordering| steps.iter().all(|step| *step == way);
    let none = |way: Ordering| steps.iter().all(|step| *step != way);
    let pairs =
        || (0..values.len()).flat_map(|i| values[i + 1..].iter().map(move |b| (values[i], *b)));
    if pairs().all(|(a, b)| a.against(b).is_eq()) {
        return format!("stays the same within its spread, {from}");
    }
    let way = if all(Ordering::Greater) {
        "rises at every step from"
    } else if all(Ordering::Less) {
        "falls at every step from"
    } else if none(Ordering::Less) && last.exceeds(*first) {
        "never falls, and goes from"
    } else if none(Ordering::Greater) && first.exceeds(*last) {
        "never rises, and goes from"
    } else {
        "does not go one way: it goes from"
    };
    format!("{way} {from} to {to}")
}

/// The names with the highest and the lowest level: «largest for a (12 m/s²), smallest for b (3 m/s²)».
pub(super) fn ends(named: &[(String, Level)], unit: &str) -> String {
    let pick = |better: fn(f64, f64) -> bool| {
        named
            .iter()
            .fold(None, |best: Option<&(String, Level)>, one| match best {
                Some(best) if !better(one.1.value, best.1.value) => Some(best),
                _ => Some(one),
            })
    };
    let (Some(largest), Some(smallest)) = (pick(|a, b| a > b), pick(|a, b| a < b)) else {
        return "not there".to_owned();
    };
    let value = |level: Level| text::quantity(level.value, unit);
    let said = |(name, level): &(String, Level)| format!("{name} ({})", value(*level));
    if named.len() == 1 {
        return format!("{} for {}", value(largest.1), largest.0);
    }
    if largest.1.against(smallest.1).is_eq() {
        return format!("the same for all within its spread, {}", value(largest.1));
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

    fn levels_of(values: &[f64]) -> Vec<Level> {
        let level = |&value: &f64| Level { value, spread: 0.0 };
        values.iter().map(level).collect()
    }

    #[test]
    fn trends_say_what_the_numbers_do() {
        let trend = |values: &[f64], unit: &str| trend(&levels_of(values), unit);
        assert_eq!(
            trend(&[1.0, 2.0, 5.0], "m"),
            "rises at every step from 1\u{a0}m to 5\u{a0}m"
        );
        assert_eq!(trend(&[3.0, 2.0], ""), "falls at every step from 3 to 2");
        assert_eq!(
            trend(&[1.0, 3.0, 2.0], ""),
            "does not go one way: it goes from 1 to 2"
        );
        assert_eq!(
            trend(&[1.0, 1.001, 2.0], ""),
            "never falls, and goes from 1 to 2"
        );
        assert_eq!(
            trend(&[82.31, 82.33, 82.34], ""),
            "stays the same within its spread, 82.3"
        );
        assert_eq!(trend(&[4.0], ""), "is 4");
        assert_eq!(trend(&[], ""), "is not there");
    }

    #[test]
    fn the_ends_are_named() {
        let named = |values: &[(&str, f64)]| {
            let level = |value| Level { value, spread: 0.0 };
            let named = values.iter().map(|(n, v)| ((*n).to_owned(), level(*v)));
            named.collect::<Vec<_>>()
        };
        assert_eq!(
            ends(&named(&[("a", 2.0), ("b", 7.0)]), ""),
            "largest for b (7), smallest for a (2)"
        );
        assert_eq!(
            ends(&named(&[("a", 206.1), ("b", 206.4)]), ""),
            "the same for all within its spread, 206"
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
        let [peak, rms] = levels(&response).unwrap();
        assert_eq!((peak.value, rms.value), (4.0, 12.5_f64.sqrt()));
        assert!(levels(&Response::default()).is_none());
    }

    /// Peaks that alternate from revolution to revolution do so in every recording.
    #[test]
    fn the_spread_is_over_parts_of_several_revolutions() {
        let at = |i: i32| f64::from(i) * std::f64::consts::TAU / 100.0;
        let response = Response {
            crank_angle_rad: (0..4000).map(at).collect(),
            acceleration_m_s2: (0..4000)
                .map(|i| if i / 100 % 2 == 0 { 1.0 } else { 2.0 })
                .collect(),
            ..Response::default()
        };
        let [peak, rms] = levels(&response).unwrap();
        assert_eq!((peak.value, peak.spread), (2.0, 0.0));
        assert!(rms.spread < 1e-12);
    }
}
