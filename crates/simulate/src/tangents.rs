//! A trajectory with tangents: directions in which it is disturbed, carried along by dual numbers.
//!
//! The tangents are the dual parts of the one right-hand side. Where the mode switches, the integrator
//! carries the derivative of the switch's time, so that jumps of force and state count in full. Many tangents go in chunks of `N`: each chunk follows the trajectory on its own, bit
//! for bit the same. Everything here is in the integration's own scales (clearances for offsets).

use crate::error::Error;
use crate::flow::{Cycle, Flow};
use crate::run::LONGEST_STEP;
use integrate::{Integrator, Real, Step, System};
use nalgebra::{DMatrix, DVector};
use scalar::Dual;

/// A tangent is rounding where less than this share of its length is left without its parts along the
/// others. A rigid impact swallowed its direction, or the contact is too stiff to resolve.
const LOST: f64 = 1e-12;

/// A trajectory and its tangents.
pub(crate) struct Tangents<F: Flow, const N: usize> {
    chunks: Vec<Chunk<F, N>>,
    count: usize,
    scales: Vec<f64>,
    cycle: Cycle,
    tolerance: f64,
}

/// The trajectory with `N` of the tangents.
struct Chunk<F: Flow, const N: usize> {
    system: F::System<Dual<f64, N>>,
    integrator: Integrator<Dual<f64, N>>,
}

impl<F: Flow, const N: usize> Tangents<F, N> {
    /// Room for `count` tangents at the start of `flow`; at most as many as it has states.
    pub fn start(flow: &F, count: usize, tolerance: f64) -> Self {
        let cycle = flow.cycle();
        let (system, state) = flow.start::<Dual<f64, N>>();
        let scales: Vec<f64> = system.scales().iter().map(|s| s.value()).collect();
        let count = count.min(scales.len());
        Self {
            chunks: chunks(&system, 0.0, &state, count, tolerance, cycle),
            count,
            scales,
            cycle,
            tolerance,
        }
    }

    /// Gives the tangents their first directions. Not at the very start: a centred journal has no
    /// direction that could be disturbed.
    pub fn spread(&mut self) {
        // Any will do that are not special: the first has all components alike.
        let mut directions = DMatrix::identity(self.scales.len(), self.count);
        directions.column_mut(0).fill(1.0);
        self.set(&directions.qr().q());
    }

    /// Undisturbs what the mode remembers. What is remembered afresh is disturbed again; what a
    /// contact that never opens remembers for ever is a parameter, and no part of the motion.
    pub fn undisturb_memory(&mut self) {
        let states = self.matrix().rows(0, self.scales.len()).into_owned();
        self.set(&states);
    }

    /// The same system and time at another point, disturbed in every direction.
    pub fn everywhere(&self, point: &DVector<f64>) -> Self {
        let mut system = self.chunks[0].system.clone();
        let (state, memory) = point.as_slice().split_at(self.scales.len());
        for (slot, value) in F::memory(&mut system).into_iter().zip(memory) {
            slot.value = *value;
        }
        let constant = |(x, scale): (&f64, &f64)| scalar::Scalar::constant(x * scale);
        let state: Vec<_> = state.iter().zip(&self.scales).map(constant).collect();
        let count = point.len();
        let mut tangents = Self {
            chunks: chunks(
                &system,
                self.time(),
                &state,
                count,
                self.tolerance,
                self.cycle,
            ),
            count,
            scales: self.scales.clone(),
            ..*self
        };
        tangents.set(&DMatrix::identity(count, count));
        tangents
    }

    pub fn time(&self) -> f64 {
        self.chunks[0].integrator.time()
    }

    pub fn cycle(&self) -> Cycle {
        self.cycle
    }

    /// Goes on to `end`; `observe` is shown every step, which it may extend.
    pub fn advance(
        &mut self,
        end: f64,
        mut observe: impl FnMut(&mut F::System<Dual<f64, N>>, &mut Step<Dual<f64, N>>),
    ) -> Result<(), Error> {
        for (i, chunk) in self.chunks.iter_mut().enumerate() {
            let (system, integrator) = (&mut chunk.system, &mut chunk.integrator);
            integrator.watch(system, end, |system, step| {
                if i == 0 {
                    observe(system, step);
                }
            })?;
        }
        Ok(())
    }

    /// The state, and what its mode remembers.
    pub fn point(&mut self) -> DVector<f64> {
        let chunk = &mut self.chunks[0];
        let state = chunk.integrator.state().iter().zip(&self.scales);
        let mut values: Vec<f64> = state.map(|(y, scale)| y.value / scale).collect();
        let memory = F::memory(&mut chunk.system);
        values.extend(memory.into_iter().map(|x| x.value));
        DVector::from_vec(values)
    }

    /// The rate of [`point`](Self::point), 1/s; what is remembered stays.
    pub fn rate(&mut self) -> DVector<f64> {
        let chunk = &mut self.chunks[0];
        let (t, y) = (chunk.integrator.time(), chunk.integrator.state());
        let mut rate = y.to_vec();
        let t = scalar::Scalar::constant(t);
        chunk.system.derivative(t, y, &mut rate);
        let state = rate.iter().zip(&self.scales);
        let mut values: Vec<f64> = state.map(|(y, scale)| y.value / scale).collect();
        values.extend(F::memory(&mut chunk.system).iter().map(|_| 0.0));
        DVector::from_vec(values)
    }

    /// The scale of each component of the state.
    pub fn scales(&self) -> &[f64] {
        &self.scales
    }

    /// How many tangents there are.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The tangents as columns.
    pub fn matrix(&mut self) -> DMatrix<f64> {
        let mut columns = Vec::with_capacity(self.count);
        for chunk in &mut self.chunks {
            let state = chunk.integrator.state();
            let memory = F::memory(&mut chunk.system);
            for direction in 0..N.min(self.count - columns.len()) {
                let parts = state.iter().zip(&self.scales);
                let mut column: Vec<f64> = parts
                    .map(|(y, scale)| y.tangent[direction] / scale)
                    .collect();
                column.extend(memory.iter().map(|x| x.tangent[direction]));
                columns.push(DVector::from_vec(column));
            }
        }
        DMatrix::from_columns(&columns)
    }

    /// Replaces the tangents.
    fn set(&mut self, columns: &DMatrix<f64>) {
        for (i, chunk) in self.chunks.iter_mut().enumerate() {
            let tangent = |row: usize, scale: f64| {
                std::array::from_fn(|direction| {
                    let column = i * N + direction;
                    // What has no row yet is what a contact that just closed remembers.
                    let part = columns.get((row, column)).copied();
                    part.unwrap_or(0.0) * scale
                })
            };
            let mut state = chunk.integrator.state().to_vec();
            for (row, (y, scale)) in state.iter_mut().zip(&self.scales).enumerate() {
                y.tangent = tangent(row, *scale);
            }
            let memory = F::memory(&mut chunk.system);
            for (row, x) in memory.into_iter().enumerate() {
                x.tangent = tangent(self.scales.len() + row, 1.0);
            }
            chunk.integrator.set_state(&mut chunk.system, &state);
        }
    }

    /// Makes the tangents perpendicular and of length 1 (QR decomposition). Returns the logarithm of the
    /// growth of each, −∞ for a direction that a rigid impact swallowed: it stays swallowed.
    pub fn orthonormalise(&mut self) -> Result<Vec<f64>, Error> {
        let grown = self.matrix();
        if !grown.iter().all(|x| x.is_finite()) {
            let time = self.time();
            return Err(Error::NotFinite { time });
        }
        let lengths: Vec<f64> = grown.column_iter().map(|c| c.norm()).collect();
        let (mut directions, stretch) = grown.qr().unpack();
        let mut growth = Vec::with_capacity(self.count);
        for (i, length) in lengths.into_iter().enumerate() {
            let factor = stretch[(i, i)].abs();
            if factor > LOST * length {
                growth.push(factor.ln());
            } else {
                growth.push(f64::NEG_INFINITY);
                directions.column_mut(i).fill(0.0);
            }
        }
        self.set(&directions);
        Ok(growth)
    }
}

fn chunks<F: Flow, const N: usize>(
    system: &F::System<Dual<f64, N>>,
    time: f64,
    state: &[Dual<f64, N>],
    count: usize,
    tolerance: f64,
    cycle: Cycle,
) -> Vec<Chunk<F, N>> {
    let longest = LONGEST_STEP * cycle.length();
    let chunk = |_| {
        let mut system = system.clone();
        Chunk {
            integrator: Integrator::new(&mut system, time, state, tolerance, longest),
            system,
        }
    };
    (0..count.div_ceil(N)).map(chunk).collect()
}
