//! What sensors see at several instants of a step, evaluated side by side.

use crate::sensor::Sensor;
use integrate::Step;
use mechanism::mode::Mode;
use mechanism::{Dynamics, Machine, lift};
use scalar::{InLanes, Lanes, in_lanes};

/// Looks at a machine at as many instants at once as the processor has lanes.
pub trait Lookout: Send {
    /// Puts the machine into a mode.
    fn set_mode(&mut self, mode: &Mode);

    /// Looks at the instants `times`, s, all of them within the step, and shows `show` what each sensor
    /// sees at some of them, in their order.
    fn look(
        &mut self,
        step: &Step<f64>,
        times: &[f64],
        sensors: &[Sensor],
        show: &mut dyn FnMut(usize, &[f64]),
    );
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
        Box::new(Wide::<L, W> {
            states: vec![L::zero(); dynamics.layout().dimension],
            dynamics,
        })
    }
}

/// The machine in all lanes, each at an instant of its own.
struct Wide<L, const W: usize> {
    dynamics: Dynamics<L>,
    states: Vec<L>,
}

impl<L: Lanes<W>, const W: usize> Lookout for Wide<L, W> {
    fn set_mode(&mut self, mode: &Mode) {
        self.dynamics.set_mode(mode);
    }

    fn look(
        &mut self,
        step: &Step<f64>,
        times: &[f64],
        sensors: &[Sensor],
        show: &mut dyn FnMut(usize, &[f64]),
    ) {
        for times in times.chunks(W) {
            // Lanes without an instant of their own look at the last one.
            let last = times.len() - 1;
            let instants = L::from_array(std::array::from_fn(|lane| times[lane.min(last)]));
            let share = L::vectorised(|| (instants - step.start) / step.length);
            step.interpolate_lanes(share, &mut self.states);
            let at = self.dynamics.evaluate_sensed(instants, &self.states);
            for (i, sensor) in sensors.iter().enumerate() {
                let seen = L::vectorised(|| sensor.measured.unwrapped(at)).to_array();
                let seen = seen.map(|x| sensor.measured.wrapped(x));
                show(i, &seen[..times.len()]);
            }
        }
    }
}
