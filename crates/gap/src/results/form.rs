//! What is known of the form of an effect's law, in words.

use crate::amendment::candidate::Candidate;
use input::effects::Parameter;

/// Significant digits of a value in words.
const DIGITS: usize = 3;

/// The form of an item's law, by what is `known` of the parameter of a key: its value and its interval. None where the law has
/// one form, or where what distinguishes its forms is not identifiable.
pub(crate) fn form(
    item: &Candidate,
    known: impl Fn(&str) -> Option<(f64, [f64; 2])>,
) -> Option<String> {
    let forms = item
        .entry
        .parameters
        .iter()
        .filter(|p| p.shape && !p.cyclic);
    let forms: Vec<&Parameter> = forms.collect();
    if forms.is_empty() {
        return None;
    }
    if !item.formed {
        return Some("the usual form suffices".to_owned());
    }
    let identified = forms.iter().filter_map(|parameter| {
        let (value, [low, high]) = known(parameter.key)?;
        Some((*parameter, value, low, high))
    });
    let identified: Vec<_> = identified.collect();
    let unusual = identified
        .iter()
        .filter(|(parameter, _, low, high)| !(*low..=*high).contains(&parameter.start));
    let unusual: Vec<String> = unusual
        .map(|(parameter, value, low, high)| {
            let [value, low, high] = [value, low, high].map(|si| written(parameter, *si));
            let key = parameter.key.replace('_', " ");
            format!("{key} {value} ({low} to {high}), {}", meaning(parameter))
        })
        .collect();
    match (identified.is_empty(), unusual.is_empty()) {
        (true, _) => None,
        (false, true) => Some("the usual form is within the intervals".to_owned()),
        (false, false) => Some(unusual.join("; ")),
    }
}

/// What a parameter means, in short: its words up to what is said of a file.
fn meaning(parameter: &Parameter) -> String {
    let ends = ["; ", ": ", ". "].map(|end| parameter.words.find(end));
    let end = ends.into_iter().flatten().min();
    let first = &parameter.words[..end.unwrap_or(parameter.words.len())];
    let mut letters = first.trim_end_matches('.').chars();
    let head = letters
        .next()
        .map(|letter| letter.to_lowercase().to_string());
    head.into_iter().chain(letters.map(String::from)).collect()
}

/// A value as a machine file has it, in few digits.
fn written(parameter: &Parameter, si: f64) -> String {
    let rounded: f64 = format!("{si:.*e}", DIGITS - 1).parse().unwrap_or(si);
    match parameter.value(rounded) {
        serde_json::Value::String(text) => text,
        number => number.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::problem;

    fn friction() -> Candidate {
        let mut all = Candidate::all(&problem()).into_iter();
        all.find(|one| one.entry.name == "ring_friction").unwrap()
    }

    fn viscous(interval: Option<[f64; 2]>) -> impl Fn(&str) -> Option<(f64, [f64; 2])> {
        move |key| {
            interval
                .filter(|_| key == "viscous")
                .map(|interval| (24.681, interval))
        }
    }

    #[test]
    fn a_meaning_is_the_first_clause_of_the_words_with_its_numbers() {
        let mut catalogue = input::effects::CATALOGUE.iter();
        let frame = catalogue
            .find(|entry| entry.name == "frame_compliance")
            .unwrap();
        let mut parameters = frame.parameters.iter();
        let hardening = parameters.find(|p| p.key == "hardening").unwrap();
        let words = "by what share its springs are stiffer where it has moved by 0.1 mm";
        assert_eq!(meaning(hardening), words);
    }

    #[test]
    fn what_is_identifiable_is_stated_and_nothing_else() {
        let item = friction();
        let stated = form(&item, viscous(Some([20.0, 29.0]))).unwrap();
        assert!(
            stated.starts_with("viscous 24.7 N s/m (20 N s/m to 29 N s/m), "),
            "{stated}"
        );
        assert_eq!(form(&item, viscous(None)), None);
        let usual = form(&item, viscous(Some([-1.0, 29.0]))).unwrap();
        assert_eq!(usual, "the usual form is within the intervals");
        let usual = item.of_usual_form().unwrap();
        assert_eq!(
            form(&usual, viscous(None)).unwrap(),
            "the usual form suffices"
        );
        let mut all = Candidate::all(&problem()).into_iter();
        let one_form = all.find(|one| one.entry.name == "sensor_gain").unwrap();
        assert_eq!(form(&one_form, viscous(None)), None);
    }
}
