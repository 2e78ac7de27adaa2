//! The derivatives of a periodic motion by the machine's parameters.
//!
//! A motion y that repeats itself after a period satisfies y = φ(y, p), with φ the flow over the
//! period. Hence dy/dp = (1 − ∂φ/∂y)⁻¹ ∂φ/∂p (Seydel 2010, section 7.3: the sensitivity of a fixed
//! point). What a sensor sees changes by its tangent toward p, plus its tangents toward each component
//! of y times those of dy/dp. Only one period is integrated with tangents, the transient without.
//!
//! With a free crank the period moves, too. The crank angle at the start is held in its place, and
//! tangents at the end are taken at the same angle a whole number of turns later.

use crate::error::Error;
use crate::instants::Instants;
use crate::moved::Moved;
use crate::periodic_orbit::keeps;
use crate::recorder::{Recorder, apart};
use crate::run::{Run, Standing};
use crate::sensor::Sensor;
use crate::settings::Settings;
use crate::span::Span;
use integrate::Real;
use mechanism::{Evaluation, Machine, lift};
use nalgebra::DMatrix;
use rayon::prelude::*;
use scalar::{Dual, Scalar};
use std::f64::consts::TAU;

/// Tangents that are carried together.
const TOGETHER: usize = 8;

/// A settled motion of a machine.
pub(crate) struct Orbit<'a> {
    pub machine: &'a Machine,
    pub sensors: &'a [Sensor],
    pub moved: &'a [Moved],
    pub settings: &'a Settings,
    /// Revolutions after which it repeats itself.
    pub period: u32,
}

/// What the sensors measure along an orbit.
pub(crate) struct Carried {
    /// What records it.
    pub recorder: Recorder,
    /// Inner samples of each sensor.
    pub values: Vec<Vec<f64>>,
    /// For each parameter the derivatives of these.
    pub tangents: Vec<Vec<Vec<f64>>>,
    /// Steps that it took, the transient included.
    pub steps: u64,
}

/// Where tangents are carried along: from a point to the end of the period, and beyond to the last of
/// the instants.
struct Stretch {
    from: Standing,
    /// The components of the state that are disturbed, and their scales.
    disturbed: Vec<(usize, f64)>,
    /// How many numbers the mode remembers.
    remembered: usize,
    /// The angle of a free crank.
    crank: Option<usize>,
    end: f64,
    instants: Instants,
}

/// Inner samples of each sensor, for each parameter the derivatives of these, and steps.
type Along = (Vec<Vec<f64>>, Vec<Vec<Vec<f64>>>, u64);

/// A part of the directions.
struct Part {
    values: Vec<Vec<f64>>,
    /// Inner samples for each direction and sensor.
    tangents: Vec<Vec<Vec<f64>>>,
    /// For each direction what it has become at the end of the period: the disturbed components
    /// over their scales, and what the mode remembers.
    ends: Vec<Vec<f64>>,
    steps: u64,
}

impl Orbit<'_> {
    /// Follows the orbit on which `run` stands at a whole revolution for one period.
    pub fn carried(&self, mut run: Run<f64>) -> Result<Carried, Error> {
        let span = Span::of_period(&run, self.period, self.sensors, self.settings)?;
        run.advance(span.instants.first)?;
        let stretch = self.stretch(&mut run, span.instants)?;
        let (values, tangents, steps) = self.along(&stretch)?;
        let whole = |inner: Vec<f64>| span.whole(inner);
        let all = |of: Vec<Vec<f64>>| of.into_iter().map(whole).collect::<Vec<_>>();
        Ok(Carried {
            values: all(values),
            tangents: tangents.into_iter().map(all).collect(),
            recorder: Recorder {
                sampling: span.sampling,
                start: span.start,
            },
            steps: run.steps() + steps,
        })
    }

    fn stretch(&self, run: &mut Run<f64>, instants: Instants) -> Result<Stretch, Error> {
        let from = run.standing();
        let crank = run.crank();
        let scales = run.scales().into_iter().enumerate();
        let disturbed = scales.filter(|(i, _)| Some(*i) != crank).collect();
        let remembered = run.memory().len();
        // When a free crank has turned by a period follows from its motion alone.
        let end = match run.is_free() {
            true => {
                run.turn(self.period)?;
                run.time()
            }
            false => from.time + f64::from(self.period) * run.revolution(),
        };
        Ok(Stretch {
            from,
            disturbed,
            remembered,
            crank,
            end,
            instants,
        })
    }

    /// What the sensors measure, its derivatives by the parameters, and the steps that it took.
    fn along(&self, stretch: &Stretch) -> Result<Along, Error> {
        let parameters = self.moved.len();
        if parameters == 0 {
            let from = &stretch.from;
            let machine = lift::constants(self.machine);
            let mut run = Run::resume(machine, from, &from.state, self.settings.tolerance, false);
            run.hurry();
            let (values, ()) = self.followed(&mut run, stretch, |_| ())?;
            return Ok((values, Vec::new(), run.steps()));
        }
        let states = stretch.disturbed.len() + stretch.remembered;
        let count = parameters + states;
        let firsts = (0..count).into_par_iter().step_by(TOGETHER);
        let parts = firsts.map(|first| match count - first {
            1 => self.part::<1>(stretch, first),
            _ => self.part::<TOGETHER>(stretch, first),
        });
        let mut parts = parts.collect::<Result<Vec<_>, _>>()?;
        let values = std::mem::take(&mut parts[0].values);
        let steps = parts.iter().map(|part| part.steps).sum();
        let mut ends: Vec<Vec<f64>> = Vec::new();
        let mut tangents = Vec::new();
        for part in parts {
            ends.extend(part.ends);
            tangents.extend(part.tangents);
        }
        let changes = changes(&ends[..count], parameters, stretch.disturbed.len());
        let (toward, of_state) = tangents.split_at_mut(parameters);
        for (j, toward) in toward.iter_mut().enumerate() {
            for (k, of_state) in of_state[..states].iter().enumerate() {
                let share = changes[(k, j)];
                if share == 0.0 {
                    continue;
                }
                for (toward, of_state) in toward.iter_mut().zip(of_state) {
                    for (x, y) in toward.iter_mut().zip(of_state) {
                        *x += share * y;
                    }
                }
            }
        }
        tangents.truncate(parameters);
        Ok((values, tangents, steps))
    }

    /// The directions from `first` on: those of the parameters, then those of the disturbed
    /// components and of what the mode remembers.
    fn part<const N: usize>(&self, stretch: &Stretch, first: usize) -> Result<Part, Error> {
        let towards = std::array::from_fn(|i| {
            let moved = self.moved.get(first + i);
            moved.map_or(self.machine, |moved| &moved.machine)
        });
        let lifted = lift::gradient::<N, Machine>(self.machine, towards);
        let direction = |component: usize| -> Option<usize> {
            (self.moved.len() + component)
                .checked_sub(first)
                .filter(|direction| *direction < N)
        };
        let from = &stretch.from;
        let plain = from.state.iter().copied();
        let mut state: Vec<Dual<f64, N>> = plain.map(Dual::constant).collect();
        for (component, (i, scale)) in stretch.disturbed.iter().enumerate() {
            if let Some(direction) = direction(component) {
                state[*i].tangent[direction] = *scale;
            }
        }
        let mut run = Run::resume(lifted, from, &state, self.settings.tolerance, false);
        run.hurry();
        for (i, memory) in run.memory().into_iter().enumerate() {
            if let Some(direction) = direction(stretch.disturbed.len() + i) {
                memory.tangent[direction] = 1.0;
            }
        }
        let (inner, ends) = self.followed(&mut run, stretch, |run| ends(run, stretch))?;
        let (values, tangents) = apart(&inner);
        Ok(Part {
            values,
            tangents,
            ends,
            steps: run.steps(),
        })
    }

    /// What the sensors measure along `run`, and what `at_end` finds at the end of the period.
    fn followed<S: Real, E>(
        &self,
        run: &mut Run<S>,
        stretch: &Stretch,
        at_end: impl FnOnce(&mut Run<S>) -> E,
    ) -> Result<(Vec<Vec<S>>, E), Error> {
        let mut inner = vec![Vec::new(); self.sensors.len()];
        let mut look = |at: &Evaluation<S>| {
            for (sensor, inner) in self.sensors.iter().zip(&mut inner) {
                inner.push(sensor.measured.value(at));
            }
        };
        let [within, beyond] = stretch.instants.split_at(stretch.end);
        run.show(within, &mut look)?;
        run.advance(stretch.end)?;
        let end = at_end(run);
        if beyond.count > 0 {
            run.show(beyond, &mut look)?;
        }
        Ok((inner, end))
    }
}

/// What each direction has become, at the crank angle at which the plain motion stands.
fn ends<const N: usize>(run: &mut Run<Dual<f64, N>>, stretch: &Stretch) -> Vec<Vec<f64>> {
    let rates: Vec<f64> = run.rates().iter().map(|rate| rate.value).collect();
    let state = run.state().to_vec();
    let reference = TAU / run.revolution();
    // The crank is ahead where it has turned further: by so much less time.
    let ahead = |direction: usize| {
        let delay = |i: usize| state[i].tangent[direction] / (reference + rates[i]);
        stretch.crank.map_or(0.0, delay)
    };
    let memory = run.memory();
    let column = |direction: usize| {
        let of_state = stretch.disturbed.iter().map(|(i, scale)| {
            (state[*i].tangent[direction] - rates[*i] * ahead(direction)) / scale
        });
        let remembered = memory.iter().map(|x| x.tangent[direction]);
        // What a contact that closed in between remembers is of no use to the next period.
        let mut column: Vec<f64> = of_state.chain(remembered).collect();
        column.resize(stretch.disturbed.len() + stretch.remembered, 0.0);
        column
    };
    (0..N).map(column).collect()
}

/// The change of each component of the state with each parameter, from what the directions of
/// parameters and components have become. What a contact that never opens remembers stays.
fn changes(ends: &[Vec<f64>], parameters: usize, states: usize) -> DMatrix<f64> {
    let count = ends.len() - parameters;
    let of = |columns: &[Vec<f64>]| DMatrix::from_fn(count, columns.len(), |i, j| columns[j][i]);
    let (toward, monodromy) = (of(&ends[..parameters]), of(&ends[parameters..]));
    let moves = |i: &usize| *i < states || !keeps(&monodromy, *i);
    let live: Vec<usize> = (0..count).filter(moves).collect();
    let mut all = DMatrix::zeros(count, parameters);
    if live.is_empty() {
        return all;
    }
    let matrix = DMatrix::identity(live.len(), live.len())
        - monodromy.select_rows(&live).select_columns(&live);
    // Where a multiplier is 1 the orbit has no derivative; its own motion is what is left.
    if let Some(solved) = matrix.lu().solve(&toward.select_rows(&live)) {
        for (row, i) in live.into_iter().enumerate() {
            all.row_mut(i).copy_from(&solved.row(row));
        }
    }
    all
}
