//! The indicator diagram of a measured cylinder pressure.
//!
//! While both valves are closed, ln p falls in a straight line over ln V, whose slope is the
//! polytropic exponent. Where these lines meet the pressures of the suction and the discharge line,
//! the valves open and close in effect. A valve that took no time and no pressure there would enclose
//! the same gas. (The method is that of indicator cards, as old as the steam engine.)
//!
//! ```text
//! ln p    discharge closes ┌────┐ discharge opens
//!                           \    \
//!                  expansion \    \ compression
//!                             \    \
//!                suction opens └────┘ suction closes      ln V
//! ```

pub use crate::chamber::Chamber;

use std::f64::consts::{PI, TAU};

/// Share of the way from suction to discharge, in ln p, that is left out at either end of a
/// polytrope. The valves do not open and close at once there.
const MARGIN: f64 = 0.15;
/// Fewest samples of a polytrope.
const FEWEST: usize = 8;
/// Exponents that the expansion of a gas may have: isothermal, and isentropic of a monatomic gas.
const EXPONENTS: [f64; 2] = [1.0, 5.0 / 3.0];
/// Clearances among which those that go with them are looked for, as shares of the stroke.
const CLEARANCES: [f64; 2] = [1e-3, 1.0];

/// The effective angles at which valves open and close, of the crankshaft, rad in [0, 2π).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValveEvents {
    /// The suction valve opens.
    pub suction_opens: Event,
    /// The suction valve closes.
    pub suction_closes: Event,
    /// The discharge valve opens.
    pub discharge_opens: Event,
    /// The discharge valve closes.
    pub discharge_closes: Event,
}

/// An effective event of a valve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// Where the polytrope meets the pressure of the line, rad.
    pub angle: f64,
    /// Where it meets the line's quartiles, in the order of the revolution: the line's pressure is no
    /// one number.
    pub quartiles: [f64; 2],
}

/// The pressure of a valve's line, as the chamber shows it while the valve is open, Pa.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Median.
    pub pressure: f64,
    /// Lower and upper quartile.
    pub quartiles: [f64; 2],
}

/// A straight piece of ln p over ln V.
#[derive(Clone, Debug, PartialEq)]
pub struct Polytrope {
    /// Where it begins and ends, of the crankshaft, rad.
    pub angles: [f64; 2],
    /// The exponent n of p Vⁿ, at the chamber's clearance.
    pub exponent: f64,
    /// How much the exponent rises for every metre by which the clearance is taken larger.
    pub exponent_per_clearance: f64,
    /// Root mean square of ln p about the line.
    pub scatter: f64,
    /// ln p at ln V = 0, V in metres.
    intercept: f64,
    samples: Vec<usize>,
}

/// The same curve read with another clearance.
///
/// A wider clearance asks for greater exponents, and both polytropes stay nearly as straight: clearance and
/// exponents are strongly correlated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alternative {
    /// The clearance, m.
    pub clearance: f64,
    /// Exponents of compression and expansion.
    pub exponents: [f64; 2],
    /// Root mean square of ln p about both lines.
    pub scatter: f64,
}

/// The indicator diagram of a chamber over one revolution.
#[derive(Clone, Debug, PartialEq)]
pub struct Indicator {
    /// The chamber.
    pub chamber: Chamber,
    /// The suction line.
    pub suction: Line,
    /// The discharge line.
    pub discharge: Line,
    /// Compression.
    pub compression: Polytrope,
    /// Expansion of what stays in the clearance.
    pub expansion: Polytrope,
    /// When the valves open and close.
    pub events: ValveEvents,
    /// What the curve leaves open: the readings at which the expansion is isothermal, and isentropic
    /// of a monatomic gas.
    pub alternatives: [Alternative; 2],
}

impl Indicator {
    /// The diagram of one revolution of pressure, Pa, in `chamber`: its samples follow each other
    /// at `angles`, rad. None where the pressure has no lines and polytropes: it is not that of a
    /// compressor at work.
    pub fn from_pressure(chamber: Chamber, angles: &[f64], pressure: &[f64]) -> Option<Self> {
        if pressure.iter().any(|p| *p <= 0.0) {
            return None;
        }
        let [suction, discharge] = lines(pressure)?;
        let whole = [angles, pressure];
        let samples = |expanding| polytrope(&chamber, whole, [&suction, &discharge], expanding);
        let [compressed, expanded] = [samples(false)?, samples(true)?];
        let compression = Polytrope::fit(&chamber, whole, &compressed);
        let expansion = Polytrope::fit(&chamber, whole, &expanded);
        // A gas that is closed in loses pressure as its volume grows; what does not is another's.
        if compression.exponent <= 0.0 || expansion.exponent <= 0.0 {
            return None;
        }
        let event = |polytrope: &Polytrope, line: &Line, expanding: bool| {
            let angle = |pressure: f64| polytrope.angle(&chamber, pressure, expanding);
            let [a, b] = line.quartiles.map(angle);
            Event {
                angle: angle(line.pressure),
                // Pressure falls in the expansion and rises in the compression.
                quartiles: if expanding { [b, a] } else { [a, b] },
            }
        };
        Some(Self {
            events: ValveEvents {
                suction_opens: event(&expansion, &suction, true),
                suction_closes: event(&compression, &suction, false),
                discharge_opens: event(&compression, &discharge, false),
                discharge_closes: event(&expansion, &discharge, true),
            },
            alternatives: EXPONENTS
                .map(|exponent| alternative(&chamber, whole, [&compressed, &expanded], exponent)),
            chamber,
            suction,
            discharge,
            compression,
            expansion,
        })
    }
}

impl Polytrope {
    fn fit(chamber: &Chamber, [angles, pressure]: [&[f64]; 2], samples: &[usize]) -> Self {
        let fitted = |chamber: &Chamber| {
            let at = |i: &usize| (chamber.distance(angles[*i]).ln(), pressure[*i].ln());
            straight_line(samples.iter().map(at))
        };
        let [intercept, slope, squares] = fitted(chamber);
        let step = 1e-4 * chamber.stroke();
        let wider = Chamber {
            clearance: chamber.clearance + step,
            ..*chamber
        };
        Self {
            angles: [samples[0], samples[samples.len() - 1]].map(|i| angles[i]),
            exponent: -slope,
            exponent_per_clearance: (slope - fitted(&wider)[1]) / step,
            scatter: (squares / samples.len() as f64).sqrt(),
            intercept,
            samples: samples.to_vec(),
        }
    }

    /// ln p on the line where the piston is at `distance` from the cover.
    pub fn log_pressure(&self, distance: f64) -> f64 {
        self.intercept - self.exponent * distance.ln()
    }

    /// Where the line, prolonged, meets a pressure; a dead centre where it does so nowhere.
    fn angle(&self, chamber: &Chamber, pressure: f64, expanding: bool) -> f64 {
        let distance = ((self.intercept - pressure.ln()) / self.exponent).exp();
        let turned = chamber.turned(distance);
        let sign = if expanding { 1.0 } else { -1.0 };
        (chamber.dead_centre() + sign * turned).rem_euclid(TAU)
    }
}

/// Suction and discharge line: the samples below and above the middle of the pressure's range. Of
/// the few that belong to a polytrope the medians and quartiles feel little.
fn lines(pressure: &[f64]) -> Option<[Line; 2]> {
    let least = pressure.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = pressure.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let middle = 0.5 * (least + greatest);
    let line = |belongs: &dyn Fn(f64) -> bool| {
        let mut values: Vec<f64> = pressure.iter().copied().filter(|p| belongs(*p)).collect();
        values.sort_by(f64::total_cmp);
        let at = |share: f64| values[(share * (values.len() - 1) as f64).round() as usize];
        (!values.is_empty()).then(|| Line {
            pressure: at(0.5),
            quartiles: [at(0.25), at(0.75)],
        })
    };
    Some([line(&|p| p < middle)?, line(&|p| p >= middle)?])
}

/// The samples of the compression or the expansion: the longest stretch on its stroke whose
/// pressures lie between the lines.
fn polytrope(
    chamber: &Chamber,
    [angles, pressure]: [&[f64]; 2],
    [suction, discharge]: [&Line; 2],
    expanding: bool,
) -> Option<Vec<usize>> {
    let range = discharge.pressure / suction.pressure;
    let [low, high] = [MARGIN, 1.0 - MARGIN].map(|share| suction.pressure * range.powf(share));
    let belongs = |i: usize| {
        let after = (angles[i] - chamber.dead_centre()).rem_euclid(TAU);
        (after < PI) == expanding && (low..=high).contains(&pressure[i])
    };
    let count = angles.len();
    // The revolution begins anywhere; a stretch may go on over its end.
    let outside = (0..count).find(|i| !belongs(*i))?;
    let mut longest = Vec::new();
    let mut stretch = Vec::new();
    for i in (outside..outside + count).map(|i| i % count) {
        if belongs(i) {
            stretch.push(i);
        } else {
            stretch.clear();
        }
        if stretch.len() > longest.len() {
            longest.clone_from(&stretch);
        }
    }
    (longest.len() >= FEWEST).then_some(longest)
}

/// The reading whose expansion has this exponent: bisection, as exponents grow with the clearance.
fn alternative(
    chamber: &Chamber,
    [angles, pressure]: [&[f64]; 2],
    polytropes: [&[usize]; 2],
    exponent: f64,
) -> Alternative {
    let lines = |clearance: f64| {
        let chamber = Chamber {
            clearance,
            ..*chamber
        };
        let at = |i: &usize| (chamber.distance(angles[*i]).ln(), pressure[*i].ln());
        polytropes.map(|samples| straight_line(samples.iter().map(at)))
    };
    let [mut low, mut high] = CLEARANCES.map(|share| share * chamber.stroke());
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        let [_, [_, slope, _]] = lines(middle);
        if -slope < exponent {
            low = middle;
        } else {
            high = middle;
        }
    }
    let clearance = 0.5 * (low + high);
    let lines = lines(clearance);
    let count: usize = polytropes.iter().map(|samples| samples.len()).sum();
    Alternative {
        clearance,
        exponents: lines.map(|line| -line[1]),
        scatter: (lines.iter().map(|line| line[2]).sum::<f64>() / count as f64).sqrt(),
    }
}

/// Intercept, slope and remaining sum of squares of a line through points, by least squares.
fn straight_line(points: impl Iterator<Item = (f64, f64)> + Clone) -> [f64; 3] {
    let count = points.clone().count() as f64;
    let mean_x = points.clone().map(|p| p.0).sum::<f64>() / count;
    let mean_y = points.clone().map(|p| p.1).sum::<f64>() / count;
    let sum = |f: &dyn Fn(f64, f64) -> f64| -> f64 {
        points.clone().map(|(x, y)| f(x - mean_x, y - mean_y)).sum()
    };
    let slope = sum(&|x, y| x * y) / sum(&|x, _| x * x).max(f64::MIN_POSITIVE);
    let squares = sum(&|x, y| (y - slope * x).powi(2));
    [mean_y - slope * mean_x, slope, squares]
}

#[cfg(test)]
mod tests {
    use super::*;

    use simulate::ChamberEnd;

    const SUCTION: f64 = 1e5;
    const DISCHARGE: f64 = 4e5;
    /// A suction valve that is held open for so long after the dead centre, rad.
    const LATE: f64 = 1.0;

    fn chamber(end: ChamberEnd) -> Chamber {
        Chamber {
            end,
            clearance: 0.03,
            crank_radius: 0.12,
            rod_length: 0.6,
            phase: 0.3,
        }
    }

    /// The pressure with exponents 1.3 and 1.1, and three angles after the dead centre: the suction valve opens, it
    /// closes, and the discharge valve opens.
    fn late_closing(chamber: &Chamber, angles: &[f64]) -> (Vec<f64>, [f64; 3]) {
        let start = chamber.dead_centre();
        let enclosed = chamber.distance(start + PI + LATE);
        let opens = chamber.clearance * (DISCHARGE / SUCTION).powf(1.0 / 1.1);
        let raised = enclosed * (SUCTION / DISCHARGE).powf(1.0 / 1.3);
        let pressure = |angle: &f64| {
            let after = (angle - start).rem_euclid(TAU);
            let distance = chamber.distance(*angle);
            let gas = if after < PI {
                DISCHARGE * (chamber.clearance / distance).powf(1.1)
            } else if after < PI + LATE {
                SUCTION
            } else {
                SUCTION * (enclosed / distance).powf(1.3)
            };
            gas.clamp(SUCTION, DISCHARGE)
        };
        let events = [
            chamber.turned(opens),
            PI + LATE,
            TAU - chamber.turned(raised),
        ];
        (angles.iter().map(pressure).collect(), events)
    }

    #[test]
    fn a_late_valve_and_both_exponents_are_read_off_exactly() {
        let angles: Vec<f64> = (0..720).map(|i| TAU * f64::from(i) / 720.0).collect();
        for end in [ChamberEnd::Head, ChamberEnd::Crank] {
            let chamber = chamber(end);
            let (pressure, expected) = late_closing(&chamber, &angles);
            let found = Indicator::from_pressure(chamber, &angles, &pressure).unwrap();
            assert!((found.compression.exponent - 1.3).abs() < 1e-9);
            assert!((found.expansion.exponent - 1.1).abs() < 1e-9);
            assert!(found.compression.scatter < 1e-9);
            let events = &found.events;
            let found_events = [
                &events.suction_opens,
                &events.suction_closes,
                &events.discharge_opens,
            ];
            for (event, expected) in found_events.iter().zip(expected) {
                let after = (event.angle - chamber.dead_centre()).rem_euclid(TAU);
                assert!((after - expected).abs() < 1e-9, "{after} {expected}");
            }
            let closes = events.discharge_closes.angle - chamber.dead_centre();
            assert!(closes.sin().abs() < 1e-6, "{closes}");
            let [isothermal, isentropic] = found.alternatives;
            assert!((isothermal.exponents[1] - 1.0).abs() < 1e-9);
            assert!((isentropic.exponents[1] - 5.0 / 3.0).abs() < 1e-9);
            assert!(isothermal.clearance < 0.03 && isentropic.clearance > 0.03);
            // Over so wide a range the lines bend by little, and the exact one does not at all.
            assert!(isothermal.scatter < 3e-3 && isentropic.scatter < 1e-2);
        }
    }

    #[test]
    fn a_wider_clearance_asks_for_a_greater_exponent_by_the_stated_slope() {
        let angles: Vec<f64> = (0..720).map(|i| TAU * f64::from(i) / 720.0).collect();
        let chamber = chamber(ChamberEnd::Head);
        let (pressure, _) = late_closing(&chamber, &angles);
        let found = Indicator::from_pressure(chamber, &angles, &pressure).unwrap();
        let wider = Chamber {
            clearance: chamber.clearance + 1e-3,
            ..chamber
        };
        let other = Indicator::from_pressure(wider, &angles, &pressure).unwrap();
        for (polytrope, other) in [
            (&found.compression, &other.compression),
            (&found.expansion, &other.expansion),
        ] {
            let rise = other.exponent - polytrope.exponent;
            let expected = 1e-3 * polytrope.exponent_per_clearance;
            assert!(rise > 0.0 && (rise / expected - 1.0).abs() < 0.05);
        }
    }

    #[test]
    fn what_is_no_cycle_has_no_diagram() {
        let angles: Vec<f64> = (0..720).map(|i| TAU * f64::from(i) / 720.0).collect();
        let chamber = chamber(ChamberEnd::Head);
        for wave in [
            |_: f64| 1e5,
            |a: f64| a.sin(),
            |a: f64| 1e5 + a.cos().signum(),
        ] {
            let pressure: Vec<f64> = angles.iter().map(|a| wave(*a)).collect();
            assert!(Indicator::from_pressure(chamber, &angles, &pressure).is_none());
        }
    }
}
