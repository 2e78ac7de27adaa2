//! What sensors see at several instants of a step, evaluated side by side.

use crate::sensor::Sensor;
use integrate::Step;
use mechanism::mode::Mode;
use mechanism::{Dynamics, Machine, lift};
use scalar::{InLanes, Lanes, in_lanes};

/// Looks at a machine at as many instants at once as the processor has lanes. Instants wait until they
/// are so many.
pub trait Lookout: Send {
    /// Puts the machine into a mode. No instant may be waiting.
    fn set_mode(&mut self, mode: &Mode);

    /// Looks at the instants `times`, s, all of them within the step, and shows `show` what each sensor
    /// sees at those that need not wait, in their order.
    fn observe(
        &mut self,
        step: &Step<f64>,
        times: &[f64],
        sensors: &[Sensor],
        show: &mut dyn FnMut(usize, &[f64]),
    );

    /// Shows `show` the four powers of the energy's ledger (gas, drive, friction, damping), W, at the instants `times`, s, all of
    /// them within the step. No instant may be waiting.
    fn powers(&mut self, step: &Step<f64>, times: &[f64], show: &mut dyn FnMut(usize, &[f64]));

    /// Shows `show` what each sensor sees at the instants that wait; of an angle, since the start.
    fn finish(&mut self, sensors: &[Sensor], show: &mut dyn FnMut(usize, &[f64]));
}

/// A lookout at a machine; with `ledger` its state holds the works too.
pub fn at(machine: &Machine, ledger: bool) -> Box<dyn Lookout> {
    in_lanes(Opening { machine, ledger })
}

struct Opening<'a> {
    machine: &'a Machine,
    ledger: bool,
}

impl InLanes for Opening<'_> {
    type Output = Box<dyn Lookout>;

    fn run<L: Lanes<W>, const W: usize>(self) -> Self::Output {
        let dynamics = Dynamics::<L>::new(lift::constants(self.machine), self.ledger);
        let dimension = dynamics.layout().dimension;
        Box::new(Wide::<L, W> {
            dynamics,
            waiting: 0,
            instants: L::zero(),
            states: vec![L::zero(); dimension],
            found: vec![L::zero(); dimension],
        })
    }
}

/// The machine in all lanes, each at an instant of its own.
struct Wide<L, const W: usize> {
    dynamics: Dynamics<L>,
    /// How many instants wait, in the first lanes.
    waiting: usize,
    instants: L,
    states: Vec<L>,
    /// Scratch: states at instants of one step.
    found: Vec<L>,
}

impl<L: Lanes<W>, const W: usize> Wide<L, W> {
    /// Lets these instants wait, for which there is room.
    fn wait(&mut self, step: &Step<f64>, times: &[f64]) {
        let places = self.waiting..self.waiting + times.len();
        let place = |lane: usize| lane.clamp(places.start, places.end - 1) - places.start;
        let instants = L::from_array(std::array::from_fn(|lane| times[place(lane)]));
        let new = L::mask(std::array::from_fn(|lane| places.contains(&lane)));
        L::vectorised(
            #[inline(always)]
            || {
                let share = (instants - step.start) / step.length;
                step.interpolate_lanes(share, &mut self.found);
                self.instants = L::select(new, instants, self.instants);
                for (state, found) in self.states.iter_mut().zip(&self.found) {
                    *state = L::select(new, *found, *state);
                }
            },
        );
        self.waiting = places.end;
    }
}

impl<L: Lanes<W>, const W: usize> Lookout for Wide<L, W> {
    fn set_mode(&mut self, mode: &Mode) {
        debug_assert_eq!(self.waiting, 0, "instants wait in another mode");
        self.dynamics.set_mode(mode);
    }

    fn observe(
        &mut self,
        step: &Step<f64>,
        mut times: &[f64],
        sensors: &[Sensor],
        show: &mut dyn FnMut(usize, &[f64]),
    ) {
        while !times.is_empty() {
            let (now, later) = times.split_at(times.len().min(W - self.waiting));
            self.wait(step, now);
            if self.waiting == W {
                self.finish(sensors, show);
            }
            times = later;
        }
    }

    fn powers(&mut self, step: &Step<f64>, times: &[f64], show: &mut dyn FnMut(usize, &[f64])) {
        for times in times.chunks(W) {
            self.wait(step, times);
            self.waiting = 0;
            self.dynamics.evaluate(self.instants, &self.states);
            let powers = self.dynamics.powers();
            let powers = [powers.gas, powers.drive, powers.friction, powers.damping];
            for (i, power) in powers.iter().enumerate() {
                show(i, &power.to_array()[..times.len()]);
            }
        }
    }

    fn finish(&mut self, sensors: &[Sensor], show: &mut dyn FnMut(usize, &[f64])) {
        let count = std::mem::take(&mut self.waiting);
        if count == 0 {
            return;
        }
        let at = self.dynamics.evaluate_sensed(self.instants, &self.states);
        for (i, sensor) in sensors.iter().enumerate() {
            let seen = L::vectorised(
                #[inline(always)]
                || sensor.measured.unwrapped(at),
            );
            show(i, &seen.to_array()[..count]);
        }
    }
}
