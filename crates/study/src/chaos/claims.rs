//! The clearance study's claims about chaos.
//!
//! The study (dynamic analysis of the moving mechanism of the reciprocating compressor with
//! clearance joints, section 4) concludes from portraits by eye: with a larger clearance chaos is
//! "more possible", and the number of joints with clearance affects it.

use crate::chaos::cases::CaseChaos;
use crate::chaos::regime::Regime;
use crate::classes;
use std::collections::BTreeMap;

/// An exponent is above another if it exceeds it by more than this many standard errors of their
/// difference.
const HIGHER: f64 = 2.0;

/// The number of chaotic cases. For a sweep that repeats the study, the comparison of the exponents
/// from the equations with each claim comes first. Empty if there is nothing to compare.
pub fn claims(cases: &[CaseChaos], study: bool) -> Vec<String> {
    let clear: Vec<&CaseChaos> = cases.iter().filter(|case| case.clearance_m > 0.0).collect();
    let steps = study.then(|| {
        [
            compared(
                &larger(&clear),
                "to the next larger clearance in the same joints, all else equal",
            ),
            compared(
                &more(&clear),
                "to clearance in more joints, of the same size, all else equal",
            ),
        ]
    });
    let steps = steps.into_iter().flatten().flatten();
    steps.chain(by_joints(&clear)).collect()
}

/// Two cases of which the second is claimed to have the higher exponent.
type Step<'a> = (&'a CaseChaos, &'a CaseChaos);

/// Every case, and the one with the next larger clearance in the same joints, all else equal.
fn larger<'a>(cases: &[&'a CaseChaos]) -> Vec<Step<'a>> {
    let mut alike: BTreeMap<(&str, usize), Vec<&CaseChaos>> = BTreeMap::new();
    for case in cases {
        let key = (case.joints.as_str(), case.operating_point);
        alike.entry(key).or_default().push(case);
    }
    let mut steps = Vec::new();
    for mut group in alike.into_values() {
        group.sort_by(|a, b| a.clearance_m.total_cmp(&b.clearance_m));
        group.dedup_by_key(|case| case.clearance_m);
        steps.extend(group.windows(2).map(|two| (two[0], two[1])));
    }
    steps
}

/// Cases of one clearance, all else equal: one with clearance in some joints, the other in these and
/// more.
fn more<'a>(cases: &[&'a CaseChaos]) -> Vec<Step<'a>> {
    let mut alike: BTreeMap<(u64, usize), BTreeMap<&str, &CaseChaos>> = BTreeMap::new();
    for case in cases {
        let key = (case.clearance_m.to_bits(), case.operating_point);
        let group = alike.entry(key).or_default();
        group.entry(&case.joints).or_insert(case);
    }
    let mut steps = Vec::new();
    for group in alike.values() {
        for few in group.values() {
            let many = group
                .values()
                .filter(|many| classes::has_more_joints(&many.joints, &few.joints));
            steps.extend(many.map(|many| (*few, *many)));
        }
    }
    steps
}

fn compared(steps: &[Step], words: &str) -> Option<String> {
    let known = steps
        .iter()
        .filter_map(|(a, b)| Some((a.exponent?, b.exponent?)));
    let (mut count, mut rises, mut falls) = (0, 0, 0);
    for ([from, from_error], [to, to_error]) in known {
        let sure = HIGHER * from_error.hypot(to_error);
        count += 1;
        rises += usize::from(to - from > sure);
        falls += usize::from(from - to > sure);
    }
    (count > 0).then(|| {
        format!(
            "Of {} {words}, the exponent rises in {rises} and falls in {falls} by more than {HIGHER} standard errors.",
            text::counted(count, "step")
        )
    })
}

/// How many cases are chaotic, by the number of joints with clearance.
fn by_joints(cases: &[&CaseChaos]) -> Option<String> {
    let mut counts: BTreeMap<usize, [usize; 2]> = BTreeMap::new();
    for case in cases {
        if let Some(regime) = case.regime {
            let count = counts.entry(case.joints.split('+').count()).or_default();
            count[1] += 1;
            count[0] += usize::from(regime == Regime::Chaotic);
        }
    }
    let each: Vec<String> = counts
        .iter()
        .map(|(joints, [chaotic, all])| {
            format!(
                "{chaotic} of {all} with clearance in {}",
                text::counted(*joints, "joint")
            )
        })
        .collect();
    (!each.is_empty()).then(|| format!("Chaotic by the equations are {}.", each.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn case(joints: &str, millimetres: f64, exponent: f64, regime: Regime) -> CaseChaos {
        CaseChaos {
            joints: joints.to_owned(),
            clearance_m: millimetres * 1e-3,
            speed_rpm: 500.0,
            exponent: Some([exponent, 0.1]),
            regime: Some(regime),
            ..CaseChaos::default()
        }
    }

    #[test]
    fn claims_are_counted_step_by_step() {
        let cases = [
            case("a", 0.1, -1.0, Regime::Periodic(1)),
            case("a", 0.3, 2.0, Regime::Chaotic),
            case("a", 0.2, 1.9, Regime::Chaotic),
            case("a+b", 0.1, -3.0, Regime::Periodic(2)),
            case("none", 0.0, -3.0, Regime::Periodic(1)),
        ];
        let said = claims(&cases, true);
        assert!(said[0].starts_with("Of 2\u{a0}steps"), "{}", said[0]);
        assert!(said[0].contains("rises in 1 and falls in 0"));
        assert!(said[1].contains("rises in 0 and falls in 1"));
        assert_eq!(
            said[2],
            "Chaotic by the equations are 2 of 3 with clearance in 1\u{a0}joint, 0 of 1 with clearance in 2\u{a0}joints."
        );
        assert!(claims(&[CaseChaos::default()], true).is_empty());
        // Without the study the count alone, and steps only between cases of one operating point.
        assert_eq!(claims(&cases, false), said[2..]);
        let mut apart = cases;
        apart[1].operating_point = 1;
        assert!(claims(&apart, true)[0].starts_with("Of 1\u{a0}step "));
    }
}
