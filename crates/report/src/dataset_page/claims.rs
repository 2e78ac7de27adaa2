//! The claims of the clearance study, held against the levels of a grid.
//!
//! The study (dynamic analysis of the moving mechanism of the reciprocating compressor with
//! clearance joints, sections 3 and 5) says: with a larger clearance, and with clearance in more
//! joints, the acceleration oscillates more violently and has a higher amplitude; and the place
//! of the clearance matters. Amplitude is read here as the peak, violence as the rms above a
//! frequency that the ideal motion hardly reaches.

use super::ClearanceGrid;
use crate::{classes, text};
use std::fmt::Write;

/// A level is higher than another if it exceeds it by more than this factor: less may be the noise
/// of the sensor.
const HIGHER: f64 = 1.01;
/// Places differ if the larger level exceeds the smaller by more than this factor.
const MATTERS: f64 = 1.1;
/// At most this many comparisons that go the other way are named.
const MOST_EXCEPTIONS: usize = 4;

/// How large and how violent the acceleration of one case is.
#[derive(Clone, Debug)]
pub struct CaseLevel {
    /// The joints with clearance as a label; `none` for the ideal machine.
    pub joints: String,
    /// Radial clearance in m; 0 for the ideal machine.
    pub clearance_m: f64,
    /// Root mean square.
    pub rms_m_s2: f64,
    /// Largest absolute value.
    pub peak_m_s2: f64,
    /// Root mean square of what lies above [`ClearanceGrid::high_from_hz`].
    pub high_rms_m_s2: f64,
    /// Share of the variance that lies above it.
    pub high_share: f64,
}

/// A claim and what the levels say about it.
pub(super) struct Claim {
    pub(super) claim: String,
    pub(super) verdict: &'static str,
    pub(super) evidence: String,
}

/// A level by which cases are compared.
struct Measure {
    name: String,
    of: fn(&CaseLevel) -> f64,
}

/// Two cases of which the second is claimed to have the higher level.
type Pair<'a> = (&'a CaseLevel, &'a CaseLevel);

impl ClearanceGrid {
    /// The levels of all cases and the verdicts on the claims, as Markdown tables.
    pub fn claims_markdown(&self) -> String {
        let mut out = String::new();
        let mut row = |cells: &[String]| {
            let _ = writeln!(out, "| {} |", cells.join(" | "));
        };
        let rule = |n: usize, left: usize| {
            (0..n)
                .map(|i| if i < left { "---" } else { "--:" }.to_owned())
                .collect::<Vec<_>>()
        };
        row(&self.level_heads());
        row(&rule(6, 1));
        for level in &self.levels {
            row(&level_cells(level));
        }
        row(&[]);
        row(&["claim", "verdict", "evidence"].map(str::to_owned));
        row(&rule(3, 3));
        for claim in claims(self) {
            row(&[claim.claim, claim.verdict.to_owned(), claim.evidence]);
        }
        out.replace("|  |\n", "\n").replace('\u{a0}', " ")
    }

    /// Heads of the columns of the levels.
    pub(super) fn level_heads(&self) -> [String; 6] {
        let above = text::quantity(self.high_from_hz, "Hz");
        [
            "joints with clearance".to_owned(),
            "clearance".to_owned(),
            "peak (m/s²)".to_owned(),
            "rms (m/s²)".to_owned(),
            format!("rms above {above} (m/s²)"),
            format!("energy above {above}"),
        ]
    }
}

/// The cells of a case in the table of levels.
pub(super) fn level_cells(level: &CaseLevel) -> [String; 6] {
    let ideal = level.joints == "none";
    [
        classes::name(&level.joints),
        if ideal {
            "–".to_owned()
        } else {
            text::clearance(level.clearance_m)
        },
        text::decimal(level.peak_m_s2, 1),
        text::decimal(level.rms_m_s2, 1),
        text::decimal(level.high_rms_m_s2, 1),
        format!("{}\u{a0}%", text::decimal(100.0 * level.high_share, 2)),
    ]
}

/// The verdict on each claim.
pub(super) fn claims(grid: &ClearanceGrid) -> Vec<Claim> {
    let peak = Measure {
        name: "peak".to_owned(),
        of: |level| level.peak_m_s2,
    };
    let high = Measure {
        name: format!("rms above {}", text::quantity(grid.high_from_hz, "Hz")),
        of: |level| level.high_rms_m_s2,
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
    let within = |few: &CaseLevel, many: &CaseLevel| {
        let many: Vec<&str> = many.joints.split('+').collect();
        let few: Vec<&str> = few.joints.split('+').collect();
        few.len() < many.len() && few.iter().all(|joint| many.contains(joint))
    };
    clear()
        .flat_map(|few| clear().map(move |many| (few, many)))
        .filter(|(few, many)| few.clearance_m == many.clearance_m && within(few, many))
        .collect()
}

fn compared(claim: &str, measure: &Measure, pairs: &[Pair]) -> Claim {
    let (for_it, against): (Vec<Pair>, Vec<Pair>) = pairs
        .iter()
        .partition(|(low, high)| (measure.of)(high) > HIGHER * (measure.of)(low));
    let verdict = match (for_it.len(), against.len()) {
        (0, 0) => "not tested",
        (_, 0) => "holds",
        (0, _) => "does not hold",
        _ => "holds in part",
    };
    let named = |level: &CaseLevel| {
        format!(
            "{} {}",
            text::words(&level.joints),
            text::clearance(level.clearance_m)
        )
    };
    let exceptions: Vec<String> = against
        .iter()
        .take(MOST_EXCEPTIONS)
        .map(|(low, high)| {
            let [low_level, high_level] =
                [low, high].map(|level| text::decimal((measure.of)(level), 1));
            format!(
                "{} {low_level} but {} {high_level}",
                named(low),
                named(high)
            )
        })
        .collect();
    let mut evidence = format!(
        "{}: higher in {} of {} comparisons",
        measure.name,
        for_it.len(),
        pairs.len()
    );
    if !exceptions.is_empty() {
        let _ = write!(evidence, "; {}", exceptions.join("; "));
    }
    if against.len() > MOST_EXCEPTIONS {
        evidence.push_str("; …");
    }
    Claim {
        claim: claim.to_owned(),
        verdict,
        evidence,
    }
}

/// Whether cases of one clearance, in equally many but other joints, differ in the first measure.
fn place(levels: &[CaseLevel], measures: &[Measure; 2]) -> Claim {
    let ratios = measures.each_ref().map(|measure| {
        let ratio = |(a, b): &Pair| {
            let (a, b) = ((measure.of)(a), (measure.of)(b));
            a.max(b) / a.min(b)
        };
        let ratios: Vec<f64> = other_places(levels).iter().map(ratio).collect();
        ratios
    });
    let decisive = &ratios[0];
    let differ = decisive.iter().filter(|ratio| **ratio > MATTERS).count();
    let verdict = match differ {
        _ if decisive.is_empty() => "not tested",
        0 => "does not hold",
        all if all == decisive.len() => "holds",
        _ => "holds in part",
    };
    let evidence = measures.iter().zip(&ratios).map(|(measure, ratios)| {
        let low = ratios.iter().copied().fold(f64::INFINITY, f64::min);
        let high = ratios.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        format!(
            "{}: one place {} to {} times the other",
            measure.name,
            text::number(low, 3),
            text::number(high, 3)
        )
    });
    Claim {
        claim: "The place of the clearance matters".to_owned(),
        verdict,
        evidence: evidence.collect::<Vec<_>>().join("; "),
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
    use super::super::ClearanceGrid;
    use super::*;

    fn grid(levels: &[(&str, f64, f64, f64)]) -> ClearanceGrid {
        let level =
            |&(joints, clearance_m, peak_m_s2, high_rms_m_s2): &(&str, f64, f64, f64)| CaseLevel {
                joints: joints.to_owned(),
                clearance_m,
                rms_m_s2: 200.0,
                peak_m_s2,
                high_rms_m_s2,
                high_share: 0.01,
            };
        ClearanceGrid {
            operating_point: String::new(),
            ideal: None,
            joint_sets: Vec::new(),
            high_from_hz: 160.0,
            levels: levels.iter().map(level).collect(),
        }
    }

    fn verdicts(grid: &ClearanceGrid) -> Vec<&'static str> {
        claims(grid).iter().map(|claim| claim.verdict).collect()
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
        grid.levels[6].peak_m_s2 = 340.0;
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
        // A difference that may be noise is none.
        grid.levels[5].high_rms_m_s2 = 12.05;
        assert_eq!(verdicts(&grid)[3], "holds in part");
        grid.levels[3].high_rms_m_s2 = 10.5;
        assert_eq!(verdicts(&grid)[4], "holds in part");
    }

    #[test]
    fn what_cannot_be_compared_is_not_tested() {
        assert_eq!(verdicts(&grid(&[("a", 1e-4, 1.0, 1.0)])), ["not tested"; 5]);
        let falls = grid(&[("a", 1e-4, 2.0, 2.0), ("a", 2e-4, 1.0, 1.0)]);
        assert_eq!(verdicts(&falls)[..2], ["does not hold"; 2]);
    }

    #[test]
    fn the_markdown_has_a_row_for_each_case_and_claim() {
        let markdown = grid(&[("none", 0.0, 100.0, 1.0), ("a+b", 1e-4, 200.0, 10.0)]);
        let lines: Vec<String> = markdown
            .claims_markdown()
            .lines()
            .map(str::to_owned)
            .collect();
        assert_eq!(lines.len(), 2 + 2 + 1 + 2 + 5);
        assert_eq!(
            lines[3],
            "| a + b | 0.1 mm | 200.0 | 200.0 | 10.0 | 1.00 % |"
        );
        assert_eq!(lines[4], "");
    }
}
