//! The columns of a motion judged from the equations, where the sweep asks for that.

use recordings::{Column, Kind, Value};
use simulate::{Exponent, Extent, Motion, Regime};

use crate::plan::Judgement;

/// The columns for what `judgement` asks for.
pub(super) fn judged_columns(judgement: &Judgement) -> Vec<Column> {
    let column = |name: &str, kind, unit: &str, meaning: &str| {
        let column = Column::new(name, kind, meaning).optional();
        if unit.is_empty() {
            column
        } else {
            column.unit(unit)
        }
    };
    let mut columns = vec![
        column(
            "lyapunov_true_per_s",
            Kind::Real,
            "1/s",
            "largest Lyapunov exponent of the case, from the equations of motion; none where \
             nothing moves freely",
        ),
        column(
            "lyapunov_true_standard_error_per_s",
            Kind::Real,
            "1/s",
            "standard error of lyapunov_true_per_s, from batches of revolutions",
        ),
        column(
            "lyapunov_true_per_revolution",
            Kind::Real,
            "",
            "lyapunov_true_per_s times the length of a revolution",
        ),
        column(
            "regime_true",
            Kind::Text,
            "",
            "what the motion settles to, from the equations: periodic, quasi-periodic, chaotic or \
             undecided",
        ),
        column(
            "period_true_revolutions",
            Kind::Integer,
            "",
            "revolutions after which a periodic motion repeats; none elsewhere",
        ),
        column(
            "floquet_multiplier_true",
            Kind::Real,
            "",
            "modulus of the largest Floquet multiplier of a periodic motion, over its period, \
             without the 1 of a free crank; none elsewhere",
        ),
    ];
    if judgement.extent == Extent::Spectrum {
        columns.push(column(
            "lyapunov_spectrum_true_per_s",
            Kind::Samples,
            "1/s",
            "all Lyapunov exponents, the largest first; minus infinity for a direction that a \
             rigid impact swallows",
        ));
    }
    if judgement.convergence {
        columns.push(column(
            "lyapunov_convergence_true_per_s",
            Kind::Samples,
            "1/s",
            "lyapunov_true_per_s as averaged up to each revolution",
        ));
    }
    columns
}

/// The values of those columns. What cannot be disturbed (no `motion`) repeats every revolution.
pub(super) fn judged_values(judgement: &Judgement, motion: Option<&Motion>) -> Vec<Value> {
    let exponents = motion.map(|m| m.exponents.as_slice());
    let largest = exponents.and_then(<[Exponent]>::first);
    let regime = motion.map_or(Regime::Periodic { revolutions: 1 }, |m| m.regime);
    let orbit = motion.and_then(|m| m.orbit.as_ref());
    let period = match regime {
        Regime::Periodic { revolutions } => Some(i64::from(revolutions)),
        _ => None,
    };
    let mut values = vec![
        largest.map(|e| e.per_second).into(),
        largest.map(|e| e.standard_error).into(),
        largest.map(Exponent::per_revolution).into(),
        regime.name().into(),
        period.into(),
        orbit.map(|orbit| orbit.largest_modulus()).into(),
    ];
    if judgement.extent == Extent::Spectrum {
        let spectrum = exponents.unwrap_or_default().iter();
        values.push(list(spectrum.map(|e| e.per_second)));
    }
    if judgement.convergence {
        let course = largest.map(|e| e.convergence.as_slice());
        values.push(list(course.unwrap_or_default().iter().copied()));
    }
    values
}

fn list(numbers: impl Iterator<Item = f64>) -> Value {
    Value::Samples(numbers.map(|x| x as f32).collect())
}
