//! What was hidden against what was named.

use crate::error::Error;
use crate::outcome::{Gap, Outcome};
use crate::plan::NOTHING;
use ::recordings::WholeFile;
use calibrate::results::ByName;
use gap::Verdict;
use input::effects::{Proposal, entry, proposed};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

/// Classes of an effect's size over the noise: the misfit of the calibrated machine without it.
const CLASSES: [(&str, [f64; 2]); 4] = [
    ("below 3", [0.0, 3.0]),
    ("3 to 10", [3.0, 10.0]),
    ("10 and more", [10.0, f64::INFINITY]),
    ("3 and more", [3.0, f64::INFINITY]),
];
/// Names of the files with the counts over all cases.
pub const MATRIX: [&str; 2] = ["matrix.json", "matrix.md"];
/// Share of the distance to the noise that counts as closed.
const CLOSED: f64 = 0.8;

/// How often something was so, of how many.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Share {
    /// How often.
    pub so: usize,
    /// Of how many.
    pub of: usize,
}

impl Share {
    fn count<'a>(
        outcomes: impl Iterator<Item = &'a Outcome>,
        is: impl Fn(&Outcome) -> bool,
    ) -> Self {
        let mut share = Self::default();
        for outcome in outcomes {
            share.of += 1;
            share.so += usize::from(is(outcome));
        }
        share
    }

    fn text(self) -> String {
        match self.of {
            0 => "–".into(),
            of => format!(
                "{} of {of} ({:.0} %)",
                self.so,
                100.0 * self.so as f64 / of as f64
            ),
        }
    }
}

/// The counts over all cases: the content of `matrix.json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Counts {
    /// How many cases there are.
    pub cases: usize,
    /// In how many the explanation failed.
    pub failed: usize,
    /// How often one hidden effect was found, by its size over the noise.
    pub recall: ByName<Recall>,
    /// Something named where nothing is hidden.
    pub false_discoveries: Share,
    /// Both of two hidden effects named.
    pub pairs_found: Share,
    /// What is in no catalogue taken for an effect, with confidence.
    pub mistaken: Share,
    /// Mean square of the probability of what was named first less 1 where it is right and 0 where it is not (Brier
    /// 1950); none where nothing was named with a probability.
    pub brier: Option<f64>,
    /// How far the gap on held-out runs was closed where the hidden effect was named first.
    pub held_out_gap_closed: Closed,
    /// For each thing hidden how often what was named first.
    pub hidden_against_named: BTreeMap<String, BTreeMap<String, usize>>,
}

/// How often a hidden effect was found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Recall {
    /// It was named first.
    pub named_first: Share,
    /// It was named, or is a rival of what was.
    pub among_rivals: Share,
    /// It was named first, at its place.
    pub at_its_place: Share,
}

/// Shares of a distance to the noise that are gone, 0 to 1; none without a case.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Closed {
    /// The median.
    pub median: Option<f64>,
    /// The least.
    pub least: Option<f64>,
    /// How many are four fifths or more.
    pub by_80_percent: Share,
}

/// The outcomes of a test bench, looked at together.
pub struct Matrix<'a> {
    outcomes: &'a [Outcome],
}

impl<'a> Matrix<'a> {
    /// Of these outcomes.
    pub fn new(outcomes: &'a [Outcome]) -> Self {
        Self { outcomes }
    }

    /// Those in which so many effects are hidden and the workflow came to an end.
    fn ended(&self, hidden: usize) -> impl Iterator<Item = &'a Outcome> + use<'a> {
        let outcomes = self.outcomes.iter();
        let within = outcomes.filter(|o| o.outside.is_none());
        within.filter(move |o| o.hidden.len() == hidden && o.found.is_some())
    }

    /// Those of one hidden effect whose size over the noise is within `range`.
    fn of_size(&self, [low, high]: [f64; 2]) -> impl Iterator<Item = &'a Outcome> + use<'a> {
        self.ended(1).filter(move |o| {
            gap(o).is_some_and(|gap| (low..high).contains(&(gap.before / gap.noise_floor)))
        })
    }

    fn failed(&self) -> usize {
        self.outcomes.iter().filter(|o| o.found.is_none()).count()
    }

    fn false_discoveries(&self) -> Share {
        Share::count(self.ended(0), |o| named(o).next().is_some())
    }

    /// Those in which something is taken, with confidence, for an effect that it is not, where what is
    /// hidden is in no catalogue.
    fn mistaken(&self) -> Share {
        let outside = self.outcomes.iter().filter(|o| o.outside.is_some());
        Share::count(outside.filter(|o| o.found.is_some()), |o| {
            let sure = o
                .found
                .as_ref()
                .is_some_and(|found| found.verdict == Verdict::Explained);
            sure && named(o).any(|name| entry(name) != proposed(Proposal::ForceLaw))
        })
    }

    fn pairs_found(&self) -> Share {
        let all = |o: &Outcome| {
            let mut hidden = o.hidden.iter();
            hidden.all(|hidden| named(o).any(|name| name == hidden.effect))
        };
        Share::count(self.ended(2), all)
    }

    fn brier(&self) -> Option<f64> {
        let ended = self.outcomes.iter().filter(|o| o.found.is_some());
        let squares = ended.filter_map(|o| {
            let first = o.found.as_ref()?.named.first()?;
            let right = o.hidden.iter().any(|hidden| hidden.effect == first.effect);
            Some((first.probability? - f64::from(u8::from(right))).powi(2))
        });
        let squares: Vec<f64> = squares.collect();
        (!squares.is_empty()).then(|| squares.iter().sum::<f64>() / squares.len() as f64)
    }

    /// How far the gap on held-out runs was closed where what is hidden was named first: the shares,
    /// sorted.
    fn closed(&self) -> Vec<f64> {
        let named = self.ended(1).filter(|o| first_is_right(o));
        let mut closed: Vec<f64> = named.filter_map(|o| gap(o)?.closed()).collect();
        closed.sort_by(f64::total_cmp);
        closed
    }

    /// For each thing hidden how often what was named first.
    fn confusion(&self) -> BTreeMap<String, BTreeMap<String, usize>> {
        let mut confusion: BTreeMap<String, BTreeMap<String, usize>> = BTreeMap::new();
        for outcome in self.outcomes {
            let first = match &outcome.found {
                Some(found) => found.first(),
                None => "failed",
            };
            let row = confusion.entry(label(outcome)).or_default();
            *row.entry(first.to_owned()).or_default() += 1;
        }
        confusion
    }

    /// All of it in numbers.
    pub fn counts(&self) -> Counts {
        let recall = CLASSES.iter().map(|(name, range)| {
            let [named_first, among_rivals, at_its_place] =
                [first_is_right, is_among_rivals, place_is_right]
                    .map(|is| Share::count(self.of_size(*range), is));
            let recall = Recall {
                named_first,
                among_rivals,
                at_its_place,
            };
            ((*name).to_owned(), recall)
        });
        let closed = self.closed();
        Counts {
            cases: self.outcomes.len(),
            failed: self.failed(),
            recall: recall.collect(),
            false_discoveries: self.false_discoveries(),
            pairs_found: self.pairs_found(),
            brier: self.brier(),
            mistaken: self.mistaken(),
            held_out_gap_closed: Closed {
                median: median(&closed),
                least: closed.first().copied(),
                by_80_percent: enough(&closed),
            },
            hidden_against_named: self.confusion(),
        }
    }

    /// Writes the counts and the page of Markdown into the folder `out`.
    ///
    /// # Errors
    /// Files that cannot be written.
    pub fn write(&self, out: &Path) -> Result<(), Error> {
        let counts = serde_json::to_string_pretty(&self.counts())?;
        WholeFile::write(&out.join(MATRIX[0]), &counts)?;
        WholeFile::write(&out.join(MATRIX[1]), &self.markdown())?;
        Ok(())
    }

    /// All of it as a page of Markdown.
    pub fn markdown(&self) -> String {
        let mut page = String::new();
        self.write_figures(&mut page);
        self.write_confusion(&mut page);
        self.write_cases(&mut page);
        page
    }

    /// The figures alone.
    pub fn summary(&self) -> String {
        let mut page = String::new();
        self.write_figures(&mut page);
        page
    }

    fn write_figures(&self, page: &mut String) {
        let mut line = |text: String| page.push_str(&(text + "\n"));
        let failed = match self.failed() {
            0 => String::new(),
            failed => format!(", {failed} of them failed"),
        };
        line(format!("{} cases{failed}\n", self.outcomes.len()));
        line("| size over the noise | named first | at its place | among the rivals |".into());
        line("|---|---|---|---|".into());
        for (name, range) in CLASSES {
            let [first, place, rival] = [first_is_right, place_is_right, is_among_rivals]
                .map(|is| Share::count(self.of_size(range), is).text());
            line(format!("| {name} | {first} | {place} | {rival} |"));
        }
        line(String::new());
        line("| | |".into());
        line("|---|---|".into());
        let false_ones = self.false_discoveries().text();
        line(format!(
            "| something named where nothing is hidden | {false_ones} |"
        ));
        line(format!(
            "| what is in no catalogue taken for an effect (`explained`) | {} |",
            self.mistaken().text()
        ));
        line(format!(
            "| both of two effects named | {} |",
            self.pairs_found().text()
        ));
        line(format!(
            "| Brier score of the probabilities | {} |",
            number(self.brier())
        ));
        let enough = enough(&self.closed()).text();
        line(format!(
            "| four fifths of the held-out gap closed, where named first | {enough} |"
        ));
    }

    fn write_confusion(&self, page: &mut String) {
        page.push_str("\n| hidden | named first | gap | explained | held out | explained |\n");
        page.push_str("|---|---|---|---|---|---|\n");
        for (hidden, row) in self.confusion() {
            let named: Vec<String> = row.iter().map(|(name, n)| format!("{name} {n}")).collect();
            let of_row = || {
                self.outcomes
                    .iter()
                    .filter(|o| label(o) == hidden)
                    .filter_map(gap)
            };
            let middle = |of: fn(&Gap) -> Option<f64>| {
                let mut values: Vec<f64> = of_row().filter_map(|gap| of(&gap)).collect();
                values.sort_by(f64::total_cmp);
                number(median(&values))
            };
            let cells = [
                middle(|gap| Some(gap.before)),
                middle(|gap| Some(gap.after)),
                middle(|gap| gap.heldout_before),
                middle(|gap| gap.heldout_after),
            ];
            let _ = writeln!(
                page,
                "| {hidden} | {} | {} |",
                named.join(", "),
                cells.join(" | ")
            );
        }
        page.push_str("\nGaps are medians, in standard deviations of the noise.\n");
    }

    fn write_cases(&self, page: &mut String) {
        page.push_str(
            "\n| case | machine | hidden | noise | size | gap | explained | held out | explained | \
             verdict | named | rivals | CPU s |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
        );
        for outcome in self.outcomes {
            let gap = gap(outcome);
            let of = |value: fn(&Gap) -> Option<f64>| number(gap.as_ref().and_then(value));
            let verdict = match &outcome.found {
                Some(found) => found.verdict.name().to_owned(),
                None => outcome.error.clone().unwrap_or_default(),
            };
            let found = outcome.found.iter().flat_map(|found| &found.named);
            let rivals = found.flat_map(|named| named.rivals.clone());
            let _ = writeln!(
                page,
                "| {} | {} | {} | {:.0} % | {} | {} | {} | {} | {} | {verdict} | {} | {} | {} |",
                outcome.case,
                outcome.machine,
                label(outcome),
                100.0 * outcome.noise,
                outcome.size,
                of(|gap| Some(gap.before)),
                of(|gap| Some(gap.after)),
                of(|gap| gap.heldout_before),
                of(|gap| gap.heldout_after),
                named(outcome).collect::<Vec<_>>().join(", "),
                rivals.collect::<Vec<_>>().join(", "),
                outcome
                    .cpu_seconds
                    .map_or("–".into(), |s| format!("{s:.0}")),
            );
        }
    }
}

fn gap(outcome: &Outcome) -> Option<Gap> {
    outcome.found.as_ref().map(|found| found.gap)
}

fn named(outcome: &Outcome) -> impl Iterator<Item = &str> {
    let found = outcome.found.iter().flat_map(|found| &found.named);
    found.map(|named| named.effect.as_str())
}

fn first_is_right(outcome: &Outcome) -> bool {
    named(outcome).next() == outcome.hidden.first().map(|hidden| hidden.effect.as_str())
}

fn place_is_right(outcome: &Outcome) -> bool {
    let first = outcome.found.as_ref().and_then(|found| found.named.first());
    let hidden = outcome.hidden.first();
    first_is_right(outcome)
        && first
            .zip(hidden)
            .is_some_and(|(first, hidden)| first.is_at(hidden))
}

/// Whether the hidden effect is named, or listed as a rival of a named one.
fn is_among_rivals(outcome: &Outcome) -> bool {
    let found = outcome.found.iter().flat_map(|found| &found.named);
    let mut listed = found.flat_map(|named| named.rivals.iter().chain([&named.effect]));
    listed.any(|name| outcome.hidden.iter().any(|hidden| hidden.effect == *name))
}

fn label(outcome: &Outcome) -> String {
    let names: Vec<&str> = outcome.hidden.iter().map(|h| h.effect.as_str()).collect();
    match (outcome.outside, names.is_empty()) {
        (Some(outside), _) => outside.name().to_owned(),
        (None, true) => NOTHING.to_owned(),
        (None, false) => names.join(" + "),
    }
}

/// How many of the shares count as closed.
fn enough(closed: &[f64]) -> Share {
    Share {
        so: closed.iter().filter(|share| **share >= CLOSED).count(),
        of: closed.len(),
    }
}

/// The middle of sorted values.
fn median(sorted: &[f64]) -> Option<f64> {
    let [low, high] = [sorted.len().checked_sub(1)? / 2, sorted.len() / 2];
    Some(0.5 * (sorted[low] + sorted[high]))
}

fn number(value: Option<f64>) -> String {
    value.map_or("–".into(), |value| format!("{value:.2}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::{Explained, Hidden, Named};
    use crate::outside::Outside;
    use serde_json::{Value, json};

    /// A case that hides `hidden` and in which `named` is found, each with one rival after a slash;
    /// misfits on fitted and held-out runs alike.
    fn outcome(hidden: &[&str], named: &[&str], [before, after]: [f64; 2]) -> Outcome {
        let named = named.iter().map(|name| {
            let (name, rival) = name.split_once('/').unwrap_or((name, ""));
            Named {
                effect: name.into(),
                joint: Some("big_end".into()),
                throw: None,
                probability: Some(0.9),
                rivals: vec![rival.into()],
            }
        });
        Outcome {
            case: 1,
            fingerprint: String::new(),
            machine: "a".into(),
            noise: 0.02,
            size: 1.0,
            hidden: hidden
                .iter()
                .map(|effect| Hidden {
                    section: json!({"joint": "small_end"}),
                    ..Hidden::somewhere(effect)
                })
                .collect(),
            outside: None,
            other_contact_law: false,
            found: Some(Explained {
                verdict: Verdict::Explained,
                named: named.collect(),
                gap: Gap {
                    noise_floor: 1.0,
                    before,
                    after,
                    heldout_before: Some(before),
                    heldout_after: Some(after),
                },
                seconds: 1.0,
            }),
            error: None,
            cpu_seconds: None,
        }
    }

    fn strange(outcome: Outcome) -> Outcome {
        Outcome {
            outside: Some(Outside::Compression),
            ..outcome
        }
    }

    #[test]
    fn cases_are_counted() {
        let failed = Outcome {
            found: None,
            error: Some("no".into()),
            ..outcome(&["x"], &[], [5.0, 5.0])
        };
        let outcomes = [
            outcome(&["x"], &["x"], [5.0, 1.0]),
            outcome(&["x"], &["y/x", "z"], [5.0, 4.0]),
            outcome(&["y"], &["z"], [11.0, 2.0]),
            outcome(&["y"], &["y"], [11.0, 4.0]),
            outcome(&["y"], &[], [2.0, 2.0]),
            outcome(&[], &[], [0.9, 0.9]),
            outcome(&[], &["x"], [1.5, 1.0]),
            outcome(&["x", "y"], &["y", "x"], [9.0, 1.0]),
            outcome(&["x", "y"], &["y/x"], [9.0, 3.0]),
            failed,
            strange(outcome(&[], &["x"], [9.0, 1.0])),
            strange(outcome(&[], &["empirical_force"], [9.0, 1.0])),
            strange(outcome(&[], &[], [9.0, 9.0])),
        ];
        let found = serde_json::to_value(Matrix::new(&outcomes).counts()).unwrap();
        let share = |so: usize, of: usize| json!({"so": so, "of": of});
        assert_eq!(found["cases"], 13);
        assert_eq!(found["failed"], 1);
        let middle = &found["recall"]["3 to 10"];
        assert_eq!(middle["named_first"], share(1, 2));
        assert_eq!(middle["among_rivals"], share(2, 2));
        assert_eq!(middle["at_its_place"], share(0, 2));
        assert_eq!(found["recall"]["10 and more"]["named_first"], share(1, 2));
        assert_eq!(found["recall"]["3 and more"]["among_rivals"], share(3, 4));
        assert_eq!(found["recall"]["below 3"]["named_first"], share(0, 1));
        assert_eq!(found["false_discoveries"], share(1, 2));
        assert_eq!(found["pairs_found"], share(1, 2));
        assert_eq!(found["mistaken"], share(1, 3));
        assert_eq!(found["hidden_against_named"]["compression"]["x"], 1);
        // Named first are two: from 5 to 1, and from 11 to 4.
        assert_eq!(found["held_out_gap_closed"]["by_80_percent"], share(1, 2));
        assert_eq!(found["held_out_gap_closed"]["median"], 0.85);
        assert_eq!(
            found["hidden_against_named"]["x"],
            json!({"failed": 1, "x": 1, "y": 1})
        );
        assert_eq!(
            found["hidden_against_named"]["nothing"],
            json!({"explained": 1, "x": 1})
        );
        let page = Matrix::new(&outcomes).markdown();
        assert!(page.contains("| 3 to 10 | 1 of 2 (50 %) | 0 of 2 (0 %) | 2 of 2 (100 %) |"));
        assert!(page.contains("| x + y | y 2 | 9.00 | 2.00 | 9.00 | 2.00 |"));
    }

    #[test]
    fn nothing_comes_to_nothing() {
        let found = serde_json::to_value(Matrix::new(&[]).counts()).unwrap();
        assert_eq!(found["held_out_gap_closed"]["median"], Value::Null);
        assert!(Matrix::new(&[]).markdown().contains("| below 3 | – |"));
    }
}
