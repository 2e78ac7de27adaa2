//! The name that a misspelt one was probably meant to be.

/// The candidate that `name` was probably meant to be: the one with the fewest slips, or else the only one that begins
/// with it or that it begins with.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let candidates: Vec<&str> = candidates.into_iter().collect();
    slipped(name, &candidates).or_else(|| extended(&name.to_lowercase(), &candidates))
}

/// The candidate with the fewest slips of the
/// keyboard (Damerau 1964), if they are few for its length. Case counts less than letters.
pub(crate) fn slipped<'a>(name: &str, candidates: &[&'a str]) -> Option<&'a str> {
    let lower = name.to_lowercase();
    let slips = |c: &str| {
        (
            strsim::damerau_levenshtein(&lower, &c.to_lowercase()),
            strsim::damerau_levenshtein(name, c),
        )
    };
    // One letter can be anything.
    let letters = name.chars().count();
    let allowed = (letters / 3).max(usize::from(letters > 1));
    // As many slips as the lengths differ by are needed at least: a name may be as long as a file.
    let near = |c: &&str| c.chars().count().abs_diff(letters) <= allowed;
    let slipped = candidates.iter().copied().filter(near);
    slipped
        .map(|c| (slips(c), c))
        .filter(|((distance, _), _)| *distance <= allowed)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

/// Letters that a beginning needs to say which name was meant.
const BEGINNING: usize = 4;

/// The one candidate that `name` is the beginning of, or that begins `name`: `hertzian` for `hertz`.
fn extended<'a>(name: &str, candidates: &[&'a str]) -> Option<&'a str> {
    let is_one = |c: &&&str| {
        let c = c.to_lowercase();
        let shorter = name.len().min(c.len());
        // A name that goes on for long is another one, and may be as long as a file.
        let is_short = name.len() <= 2 * c.len();
        shorter >= BEGINNING && is_short && (name.starts_with(&c) || c.starts_with(name))
    };
    let mut fitting = candidates.iter().filter(is_one);
    let only = fitting.next()?;
    fitting.next().is_none().then_some(*only)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_name_is_the_one_with_the_fewest_slips() {
        let joints = ["main", "big_end", "small_end", "guide"];
        assert_eq!(nearest("big_ned", joints), Some("big_end"));
        assert_eq!(nearest("Main", joints), Some("main"));
        assert_eq!(nearest("valve", joints), None);
        assert_eq!(nearest("hertzian", ["hertz", "impact"]), Some("hertz"));
        assert_eq!(nearest("speed", ["speed_rpm", "load"]), Some("speed_rpm"));
        assert_eq!(nearest("speed", ["speed_rpm", "speed_reference_rpm"]), None);
        // "MPa" and "mPa" differ from "mpa" only in case: fewer capitals win.
        assert_eq!(nearest("mpa", ["MPa", "mPa"]), Some("mPa"));
    }
}
