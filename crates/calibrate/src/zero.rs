//! The zero of a recorded crank angle that is nowhere near top dead centre: a keyphasor sits anywhere.
//!
//! The low orders of every channel show it, for they hardly depend on the calibrated parameters. The angle at which
//! all runs together agree best with the machine is searched over the whole turn.

use crate::alignment::zero;
use crate::error::Error;
use crate::likelihood::Likelihood;
use crate::observation::Observation;
use crate::problem::Problem;
use signal::Complex64;
use std::f64::consts::{PI, TAU};

/// Orders that must agree at the zero that was found. An acceleration with the wrong sign looks in its first order
/// like one that is half a turn away, and in the second not.
const ORDERS: [usize; 2] = [1, 2];
/// Share of a channel's greatest order from which the phase of an order counts.
const COUNTS: f64 = 0.1;
/// Phases further apart than this do not agree, rad: contacts and losses of valves turn low orders by much less.
const APART: f64 = PI / 4.0;

/// By how much the recorded crank angles of the runs that `holds` are ahead of the crank, rad, where all channels agree about
/// it. None where no offset brings them together, or where several do.
///
/// # Errors
/// A machine that cannot be simulated.
pub fn crank_angle_offset(
    problem: &Problem,
    holds: impl Fn(&Observation) -> bool,
) -> Result<Option<f64>, Error> {
    let nominal = vec![0.0; problem.parameters.len()];
    let predictions = Likelihood::new(problem).predictions(&nominal)?;
    let pairs = problem.runs.iter().zip(&predictions);
    let pairs: Vec<_> = pairs.filter(|(run, _)| holds(run)).collect();
    let found = zero(&pairs);
    let raised = found.raised;
    let agrees = pairs.iter().all(|(observed, predicted)| {
        let channels = observed.channels.iter().zip(&predicted.lines);
        channels
            .map(|(seen, shown)| (&seen.lines.amplitude, &shown.amplitude))
            .all(|(seen, shown)| ORDERS.iter().all(|k| agree(seen, shown, *k, raised)))
    });
    let offset = -raised;
    let determined = found.rival.is_none();
    Ok((agrees && determined).then(|| offset - TAU * ((offset + PI) / TAU).floor()))
}

/// Whether the lines `seen` have, over an angle that is raised, the phase of those `shown` in an order.
fn agree(seen: &[Complex64], shown: &[Complex64], order: usize, raised: f64) -> bool {
    let greatest = shown.iter().skip(1).map(|c| c.norm()).fold(0.0, f64::max);
    let (Some(seen), Some(shown)) = (seen.get(order), shown.get(order)) else {
        return true;
    };
    let turned = seen * Complex64::cis(-(order as f64) * raised);
    let apart = (turned * shown.conj()).arg();
    shown.norm() < COUNTS * greatest || apart.abs() <= APART
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrong_sign_is_no_offset() {
        let shown = [Complex64::ZERO, Complex64::from(3.0), Complex64::from(1.0)];
        // Over an angle that is ahead by 0.5 the lines are turned back.
        let seen = [0, 1, 2].map(|k| shown[k] * Complex64::cis(-(k as f64) * 0.5));
        assert!(ORDERS.iter().all(|k| agree(&seen, &shown, *k, -0.5)));
        assert!(!agree(&seen, &shown, 2, 0.0));
        let negative = shown.map(|c| -c);
        assert!(agree(&negative, &shown, 1, PI) && !agree(&negative, &shown, 2, PI));
    }
}
