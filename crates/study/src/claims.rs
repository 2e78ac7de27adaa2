//! The claims of the clearance study, held against the levels of a grid.
//!
//! The study (dynamic analysis of the moving mechanism of the reciprocating compressor with
//! clearance joints, sections 3 to 5) says: with a larger clearance, and with clearance in more
//! joints, the acceleration oscillates more violently, has a higher amplitude, and is more likely to
//! be chaotic; and the place of the clearance matters. Amplitude is read here as the peak, violence
//! as the rms above a frequency that the ideal motion hardly reaches, and chaos from the equations.

use crate::Level;
use crate::classes;
use crate::grid::{CaseLevel, ClearanceGrid};
use std::collections::BTreeMap;
use std::fmt::Write;

/// Places differ if the larger level exceeds the smaller by more than this factor.
const MATTERS: f64 = 1.1;
/// At most this many comparisons that go the other way are named.
const MOST_EXCEPTIONS: usize = 4;

/// What the levels say about a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// In every comparison.
    Holds,
    /// In some comparisons.
    HoldsInPart,
    /// In no comparison.
    DoesNotHold,
    /// There is nothing to compare.
    NotTested,
}

impl Verdict {
    /// Of so many comparisons, `for_it` of which are as claimed.
    fn from_counts(for_it: usize, all: usize) -> Self {
        match for_it {
            _ if all == 0 => Self::NotTested,
            0 => Self::DoesNotHold,
            _ if for_it == all => Self::Holds,
            _ => Self::HoldsInPart,
        }
    }

    /// The verdict in words: «holds in part».
    pub fn words(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::HoldsInPart => "holds in part",
            Self::DoesNotHold => "does not hold",
            Self::NotTested => "not tested",
        }
    }
}

/// A claim and what the levels say about it.
pub struct Claim {
    /// What is claimed.
    pub claim: &'static str,
    /// What the levels say.
    pub verdict: Verdict,
    /// The figures in a word: «4 of 6».
    pub figures: String,
    /// The comparisons in a sentence.
    pub evidence: String,
}

/// A level by which cases are compared.
struct Measure {
    name: String,
    of: fn(&CaseLevel) -> Level,
}

/// Two cases of which the second is claimed to have the higher level.
type Pair<'a> = (&'a CaseLevel, &'a CaseLevel);

/// The verdict on each claim.
pub fn claims(grid: &ClearanceGrid) -> Vec<Claim> {
    let peak = Measure {
        name: "peak".to_owned(),
        of: |level| level.peak,
    };
    let high = Measure {
        name: format!("rms above {}", text::quantity(grid.high_from_hz, "Hz")),
        of: |level| level.high_rms,
    };
    let (larger, more) = (larger_clearance(&grid.levels), more_joints(&grid.levels));
    vec![
        compared(
            "The larger the clearance, the higher the amplitude",
            &peak,
            &larger,
        ),
        compared(
            "The larger the clearance, the more violent the oscillation",
            &high,
            &larger,
        ),
        compared("More joints, higher amplitude", &peak, &more),
        compared("More joints, more violent oscillation", &high, &more),
        place(&grid.levels, &[high, peak]),
        chaos(
            "The larger the clearance, the more likely is chaos",
            &grid.levels,
            |level| (level.clearance_m * 1e9).round() as u64,
            |level| text::clearance(level.clearance_m),
        ),
        chaos(
            "More joints, chaos more likely",
            &grid.levels,
            |level| level.joints.split('+').count() as u64,
            |level| text::counted(level.joints.split('+').count(), "joint"),
        ),
    ]
}

/// Every case, and the one with the next larger clearance in the same joints.
fn larger_clearance(levels: &[CaseLevel]) -> Vec<Pair<'_>> {
    let next = |level: &CaseLevel| {
        levels
            .iter()
            .filter(|other| other.joints == level.joints && other.clearance_m > level.clearance_m)
            .min_by(|a, b| a.clearance_m.total_cmp(&b.clearance_m))
    };
    levels
        .iter()
        .filter_map(|level| Some((level, next(level)?)))
        .collect()
}

/// Cases of one clearance: one with clearance in some joints, the other in these and more.
fn more_joints(levels: &[CaseLevel]) -> Vec<Pair<'_>> {
    let clear = || levels.iter().filter(|level| level.joints != "none");
    clear()
        .flat_map(|few| clear().map(move |many| (few, many)))
        .filter(|(few, many)| few.clearance_m == many.clearance_m)
        .filter(|(few, many)| classes::has_more_joints(&many.joints, &few.joints))
        .collect()
}

fn compared(claim: &'static str, measure: &Measure, pairs: &[Pair]) -> Claim {
    let higher = |(low, high): &&Pair| (measure.of)(high).exceeds((measure.of)(low));
    let (for_it, others): (Vec<&Pair>, Vec<&Pair>) = pairs.iter().partition(higher);
    let named = |level: &CaseLevel| {
        format!(
            "{} {}",
            text::words(&level.joints),
            text::clearance(level.clearance_m)
        )
    };
    let exception = |(low, high): &&Pair| {
        let [a, b] = [low, high].map(|level| (measure.of)(level));
        let is_lower = a.exceeds(b);
        let [a, b] = [a, b].map(|level| text::decimal(level.value, 1));
        match is_lower {
            true => format!("{} {a} but {} {b}", named(low), named(high)),
            false => format!("{} {b} does not exceed {} {a}", named(high), named(low)),
        }
    };
    let exceptions: Vec<String> = others.iter().take(MOST_EXCEPTIONS).map(exception).collect();
    let figures = format!("{} of {}", for_it.len(), pairs.len());
    let mut evidence = format!("{}: higher in {figures} comparisons", measure.name);
    if !exceptions.is_empty() {
        let _ = write!(evidence, "; {}", exceptions.join("; "));
    }
    if others.len() > MOST_EXCEPTIONS {
        evidence.push_str("; …");
    }
    Claim {
        claim,
        verdict: Verdict::from_counts(for_it.len(), pairs.len()),
        figures,
        evidence,
    }
}

/// Whether cases of one clearance, in equally many but other joints, differ in the first measure.
fn place(levels: &[CaseLevel], measures: &[Measure; 2]) -> Claim {
    let pairs = other_places(levels);
    let ratio = |measure: &Measure, (a, b): &Pair| {
        let [a, b] = [a, b].map(|level| (measure.of)(level));
        let ratio = a.value.max(b.value) / a.value.min(b.value);
        (ratio, ratio > MATTERS && a.against(b).is_ne())
    };
    let differ = pairs
        .iter()
        .filter(|pair| ratio(&measures[0], pair).1)
        .count();
    let evidence = measures
        .iter()
        .filter(|_| !pairs.is_empty())
        .map(|measure| {
            let ratios = pairs.iter().map(|pair| ratio(measure, pair).0);
            let (low, high) = ratios.fold((f64::INFINITY, 0.0_f64), |(low, high), ratio| {
                (low.min(ratio), high.max(ratio))
            });
            format!(
                "{}: one place {} to {} times the other",
                measure.name,
                text::number(low, 3),
                text::number(high, 3)
            )
        });
    Claim {
        claim: "The place of the clearance matters",
        verdict: Verdict::from_counts(differ, pairs.len()),
        figures: format!("{differ} of {}", pairs.len()),
        evidence: evidence.collect::<Vec<_>>().join("; "),
    }
}

/// Whether the share of chaotic cases rises from group to group: in no step it falls, and the last
/// is above the first.
fn chaos(
    claim: &'static str,
    levels: &[CaseLevel],
    group: fn(&CaseLevel) -> u64,
    name: fn(&CaseLevel) -> String,
) -> Claim {
    let mut groups: BTreeMap<u64, (String, usize, usize)> = BTreeMap::new();
    for level in levels.iter().filter(|level| level.joints != "none") {
        if let Some(chaotic) = level.chaotic {
            let entry = groups.entry(group(level));
            let (_, count, all) = entry.or_insert_with(|| (name(level), 0, 0));
            *count += usize::from(chaotic);
            *all += 1;
        }
    }
    let share = |(_, count, all): &(String, usize, usize)| *count as f64 / *all as f64;
    let shares: Vec<f64> = groups.values().map(share).collect();
    let rises = shares.last() > shares.first();
    let falls = shares.windows(2).any(|two| two[1] < two[0]);
    let count: usize = groups.values().map(|(_, count, _)| count).sum();
    let all: usize = groups.values().map(|(.., all)| all).sum();
    let each = groups
        .values()
        .map(|(name, count, all)| format!("{name} {count} of {all}"));
    Claim {
        claim,
        verdict: match (shares.len(), rises, falls) {
            (0 | 1, ..) => Verdict::NotTested,
            (_, true, false) => Verdict::Holds,
            (_, true, true) => Verdict::HoldsInPart,
            (_, false, _) => Verdict::DoesNotHold,
        },
        figures: match all {
            0 => "–".to_owned(),
            _ => {
                let counts = groups.values().map(|(_, count, _)| count.to_string());
                counts.collect::<Vec<_>>().join(", ")
            }
        },
        evidence: match all {
            0 => "the sweep has no exponents from the equations".to_owned(),
            _ => format!(
                "chaotic are {count} of {all}: {}",
                each.collect::<Vec<_>>().join(", ")
            ),
        },
    }
}

/// Cases of one clearance in equally many joints, each two once.
fn other_places(levels: &[CaseLevel]) -> Vec<Pair<'_>> {
    let joints = |level: &CaseLevel| level.joints.split('+').count();
    let alike = |a: &CaseLevel, b: &CaseLevel| {
        a.clearance_m == b.clearance_m && joints(a) == joints(b) && a.joints != b.joints
    };
    let pairs = levels.iter().enumerate().flat_map(|(i, a)| {
        let later = levels[i + 1..].iter();
        later.filter(move |b| alike(a, b)).map(move |b| (a, b))
    });
    pairs.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{ClearanceGrid, ClearanceGrids};

    fn level(joints: &str, clearance_m: f64, peak: f64, high_rms: f64) -> CaseLevel {
        let certain = |value| Level { value, spread: 0.0 };
        CaseLevel {
            joints: joints.to_owned(),
            clearance_m,
            rms: certain(200.0),
            peak: certain(peak),
            high_rms: certain(high_rms),
            high_share: 0.01,
            chaotic: None,
        }
    }

    fn grid(levels: &[(&str, f64, f64, f64)]) -> ClearanceGrid {
        let levels = levels.iter().map(|&(j, c, p, h)| level(j, c, p, h));
        ClearanceGrid {
            high_from_hz: 160.0,
            levels: levels.collect(),
            ..ClearanceGrid::default()
        }
    }

    fn verdicts(grid: &ClearanceGrid) -> Vec<&'static str> {
        claims(grid)[..5]
            .iter()
            .map(|claim| claim.verdict.words())
            .collect()
    }

    #[test]
    fn verdicts_follow_the_numbers() {
        let mut grid = grid(&[
            ("none", 0.0, 100.0, 1.0),
            ("a", 1e-4, 200.0, 10.0),
            ("a", 2e-4, 300.0, 20.0),
            ("b", 1e-4, 250.0, 12.0),
            ("b", 2e-4, 350.0, 30.0),
            ("a+b", 1e-4, 400.0, 15.0),
            ("a+b", 2e-4, 500.0, 40.0),
        ]);
        assert_eq!(verdicts(&grid), ["holds"; 5]);
        // One of three steps of clearance, and one of four pairs of joints, now go the other way.
        grid.levels[6].peak.value = 340.0;
        assert_eq!(
            verdicts(&grid),
            ["holds in part", "holds", "holds in part", "holds", "holds"]
        );
        let said = claims(&grid);
        assert_eq!(
            said[0].evidence.replace('\u{a0}', " "),
            "peak: higher in 2 of 3 comparisons; a + b 0.1 mm 400.0 but a + b 0.2 mm 340.0"
        );
        assert!(said[2].evidence.contains("3 of 4"));
        assert_eq!(
            said[4].evidence.replace('\u{a0}', " "),
            "rms above 160 Hz: one place 1.2 to 1.5 times the other; \
             peak: one place 1.17 to 1.25 times the other"
        );
        // A difference that may be noise does not count.
        grid.levels[5].high_rms.value = 12.05;
        assert_eq!(verdicts(&grid)[3], "holds in part");
        grid.levels[3].high_rms.value = 10.5;
        assert_eq!(verdicts(&grid)[4], "holds in part");
    }

    /// 15 % more is nothing where two recordings of one machine differ by as much.
    #[test]
    fn a_difference_within_the_spread_is_none() {
        let mut grid = grid(&[("a", 1e-4, 200.0, 10.0), ("a", 2e-4, 230.0, 20.0)]);
        assert_eq!(verdicts(&grid)[0], "holds");
        for level in &mut grid.levels {
            level.peak.spread = 15.0;
        }
        let said = &claims(&grid)[0];
        assert_eq!(said.verdict, Verdict::DoesNotHold);
        assert!(
            said.evidence.contains("does not exceed"),
            "{}",
            said.evidence
        );
    }

    #[test]
    fn chaos_is_counted_by_size_and_by_number() {
        let mut grid = grid(&[
            ("a", 1e-4, 1.0, 1.0),
            ("b", 1e-4, 1.0, 1.0),
            ("a+b", 1e-4, 1.0, 1.0),
            ("a", 2e-4, 1.0, 1.0),
            ("b", 2e-4, 1.0, 1.0),
            ("a+b", 2e-4, 1.0, 1.0),
        ]);
        let untested = claims(&grid);
        assert_eq!(untested[5].verdict, Verdict::NotTested);
        for (level, chaotic) in grid
            .levels
            .iter_mut()
            .zip([false, false, false, false, true, true])
        {
            level.chaotic = Some(chaotic);
        }
        let said = claims(&grid);
        assert_eq!(
            (said[5].verdict, said[6].verdict),
            (Verdict::Holds, Verdict::Holds)
        );
        assert_eq!(
            said[5].evidence.replace('\u{a0}', " "),
            "chaotic are 2 of 6: 0.1 mm 0 of 3, 0.2 mm 2 of 3"
        );
        assert_eq!(said[6].figures, "1, 1");
        for level in &mut grid.levels {
            level.chaotic = Some(false);
        }
        assert_eq!(claims(&grid)[5].verdict, Verdict::DoesNotHold);
    }

    #[test]
    fn what_cannot_be_compared_is_not_tested() {
        assert_eq!(verdicts(&grid(&[("a", 1e-4, 1.0, 1.0)])), ["not tested"; 5]);
        let falls = grid(&[("a", 1e-4, 2.0, 2.0), ("a", 2e-4, 1.0, 1.0)]);
        assert_eq!(verdicts(&falls)[..2], ["does not hold"; 2]);
    }

    #[test]
    fn the_markdown_has_a_row_for_each_case_and_claim() {
        let mut grids = ClearanceGrids {
            grids: vec![grid(&[
                ("none", 0.0, 100.0, 1.0),
                ("a+b", 1e-4, 200.0, 10.0),
            ])],
            left_out: 0,
            claims: true,
        };
        let markdown = grids.markdown();
        let lines: Vec<&str> = markdown.lines().collect();
        assert_eq!(lines.len(), 1 + 2 + 2 + 1 + 2 + 7);
        assert_eq!(
            lines[4],
            "| a + b | 0.1 mm | 200.0 | 200.0 | 10.0 | 1.00 % |"
        );
        assert_eq!(lines[5], "");
        // Of a machine that is not the study's nothing is claimed.
        grids.claims = false;
        assert_eq!(grids.markdown().lines().count(), 1 + 2 + 2);
    }
}
