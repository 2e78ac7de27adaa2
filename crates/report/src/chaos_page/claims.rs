//! The clearance study's claims about chaos, and the table of all cases.
//!
//! The study (dynamic analysis of the moving mechanism of the reciprocating compressor with
//! clearance joints, section 4) concludes from portraits by eye: with a larger clearance chaos is
//! "more possible", and the number of joints with clearance affects it.

use super::{CaseChaos, Regime};
use crate::text;

/// An exponent is above another if it exceeds it by more than this many standard errors of their
/// difference.
const HIGHER: f64 = 2.0;

/// What the exponents from the equations say about each claim; empty where there is nothing to
/// compare.
pub(super) fn claims(cases: &[CaseChaos]) -> Vec<String> {
    let clear: Vec<&CaseChaos> = cases.iter().filter(|case| case.clearance_m > 0.0).collect();
    let larger = |a: &CaseChaos, b: &CaseChaos| {
        a.joints == b.joints && a.speed_rpm == b.speed_rpm && next(&clear, a) == Some(b.clearance_m)
    };
    let more = |a: &CaseChaos, b: &CaseChaos| {
        a.clearance_m == b.clearance_m && a.speed_rpm == b.speed_rpm && within(&a.joints, &b.joints)
    };
    [
        compared(
            &clear,
            larger,
            "to the next larger clearance in the same joints at the same speed",
        ),
        compared(
            &clear,
            more,
            "to clearance in more joints, of the same size at the same speed",
        ),
        by_joints(&clear),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// The next larger clearance in the same joints at the same speed.
fn next(cases: &[&CaseChaos], of: &CaseChaos) -> Option<f64> {
    cases
        .iter()
        .filter(|case| case.joints == of.joints && case.speed_rpm == of.speed_rpm)
        .map(|case| case.clearance_m)
        .filter(|clearance| *clearance > of.clearance_m)
        .min_by(f64::total_cmp)
}

/// Whether `many` names all of the `few` joints, and more.
fn within(few: &str, many: &str) -> bool {
    let many: Vec<&str> = many.split('+').collect();
    let few: Vec<&str> = few.split('+').collect();
    few.len() < many.len() && few.iter().all(|joint| many.contains(joint))
}

fn compared(
    cases: &[&CaseChaos],
    step: impl Fn(&CaseChaos, &CaseChaos) -> bool,
    words: &str,
) -> Option<String> {
    let (mut steps, mut rises, mut falls) = (0, 0, 0);
    for a in cases {
        for b in cases.iter().filter(|b| step(a, b)) {
            let ([from, from_error], [to, to_error]) = (a.exponent?, b.exponent?);
            let sure = HIGHER * from_error.hypot(to_error);
            steps += 1;
            rises += usize::from(to - from > sure);
            falls += usize::from(from - to > sure);
        }
    }
    (steps > 0).then(|| {
        format!(
            "Of {} {words}, the exponent rises in {rises} and falls in {falls} by more than {HIGHER} standard errors.",
            text::counted(steps, "step")
        )
    })
}

/// How many cases are chaotic, by the number of joints with clearance.
fn by_joints(cases: &[&CaseChaos]) -> Option<String> {
    let mut counts: std::collections::BTreeMap<usize, [usize; 2]> = Default::default();
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

/// The cells of a case in the table: joints, clearance, speed, exponent per second and per
/// revolution and regime from the equations, exponent and regime from the signal.
pub(super) fn cells(case: &CaseChaos) -> [String; 9] {
    let revolution = 60.0 / case.speed_rpm;
    let dash = || "–".to_owned();
    let exponent = |factor: f64| {
        let exponent = case
            .exponent
            .map(|[value, error]| text::mean_and_spread(value * factor, error * factor));
        exponent.unwrap_or_else(dash)
    };
    let regime = |regime: Regime| match regime {
        Regime::Periodic(n @ 2..) => format!("periodic, {n} revolutions"),
        other => other.label().to_owned(),
    };
    let each = |said: &dyn Fn(&super::WindowChaos) -> String| {
        let said: Vec<String> = case
            .windows
            .iter()
            .map(said)
            .filter(|said| !said.is_empty())
            .collect();
        let alike = said.windows(2).all(|two| two[0] == two[1]);
        match said.first() {
            None => dash(),
            Some(first) if alike => first.clone(),
            Some(_) => said.join("; "),
        }
    };
    let signal = |window: &super::WindowChaos| match window.exponent {
        Some([value, low, high]) => {
            let [value, low, high] = [value, low, high].map(|v| text::number(v, 3));
            format!("{value} ({low} to {high})")
        }
        None => window.reason.clone(),
    };
    [
        case.case_id.clone(),
        if case.joints == "none" {
            "none".to_owned()
        } else {
            text::words(&case.joints)
        },
        if case.clearance_m > 0.0 {
            text::clearance(case.clearance_m)
        } else {
            dash()
        },
        text::quantity(case.speed_rpm, "rpm"),
        exponent(1.0),
        exponent(revolution),
        case.regime.map_or_else(dash, regime),
        each(&signal),
        each(&|window| window.regime.map_or_else(String::new, regime)),
    ]
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
        let said = claims(&cases);
        assert!(said[0].starts_with("Of 2\u{a0}steps"), "{}", said[0]);
        assert!(said[0].contains("rises in 1 and falls in 0"));
        assert!(said[1].contains("rises in 0 and falls in 1"));
        assert_eq!(
            said[2],
            "Chaotic by the equations are 2 of 3 with clearance in 1\u{a0}joint, 0 of 1 with clearance in 2\u{a0}joints."
        );
        assert!(claims(&[CaseChaos::default()]).is_empty());
    }
}
