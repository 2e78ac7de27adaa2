//! Several integrations side by side: each in a lane, with its own time, step, mode and end.
//!
//! Only what all of them do at every step is done for all at once: the stages, the error, the look at
//! the guards, the continuous extension. Step control is that of each lane's own [`Integrator`], and a
//! step with a switch in it is finished there. So every lane makes the very steps that it would make
//! alone, with the same bits.

use crate::dop853::Step;
use crate::glance::Glances;
use crate::integrator::{Course, Error, Integrator, Trial};
use crate::system::System;
use scalar::{Lanes, Scalar};

/// The lanes' steps.
#[derive(Clone, Debug)]
pub struct Ensemble<L: Scalar, const W: usize> {
    step: Step<L>,
    glances: Glances<L>,
    tolerances: L,
    /// How many components steer the steps, the same in every lane.
    counted: usize,
}

/// What one lane is about.
pub struct Traveller<'a, T, F> {
    /// Its own integrator, whose time and step length are up to date; its state is where the course
    /// ends.
    pub integrator: &'a mut Integrator<f64>,
    /// Its own system, in its mode.
    pub system: &'a mut T,
    /// Where it is going.
    pub course: &'a Course,
    /// The step that it wants to try.
    pub trial: Trial,
    /// What is shown each of its steps, if anything is.
    pub observe: Option<F>,
}

impl<L: Lanes<W>, const W: usize> Ensemble<L, W> {
    /// Room for lanes of a system.
    pub fn new(system: &impl System<L>) -> Self {
        Self {
            step: Step::new(system.dimension()),
            glances: Glances::new(system.guard_count()),
            tolerances: L::one(),
            counted: system
                .scales()
                .iter()
                .filter(|s| s.get(0).is_finite())
                .count(),
        }
    }

    /// Puts an integrator into a lane.
    pub fn place(&mut self, lane: usize, integrator: &Integrator<f64>) {
        self.step.take_beginning(lane, &integrator.step);
        self.glances.take_beginning(lane, &integrator.glances);
        self.tolerances.set(lane, integrator.tolerance);
    }

    /// Tries one step in each lane in which somebody travels. `wide` are the systems of all lanes in
    /// their modes. What became of each: where it fails, the lane's integrator is of no use any more.
    pub fn advance<T: System<f64>, F: FnMut(&mut T, &Step<f64>)>(
        &mut self,
        wide: &mut impl System<L>,
        lanes: [Option<Traveller<T, F>>; W],
    ) -> [Result<(), Error>; W] {
        let mut lengths = L::zero();
        for (lane, traveller) in lanes.iter().enumerate() {
            if let Some(traveller) = traveller {
                self.step.start.set(lane, traveller.integrator.time());
                lengths.set(lane, traveller.trial.length);
            }
        }
        let look = |stage, system: &mut _| self.glances.stage(stage, system);
        self.step.take(wide, lengths, look);
        let squares = self.squared_errors(wide.scales());
        let quiet = self.glances.quiet().map_or([false; W], L::truths);

        let (mut kept, mut shown) = ([false; W], [false; W]);
        let mut lanes = lanes;
        for (lane, traveller) in lanes.iter_mut().enumerate() {
            let Some(traveller) = traveller else {
                continue;
            };
            let squares = squares.map(|s| s.get(lane));
            if traveller
                .integrator
                .judge(traveller.trial, squares, self.counted)
            {
                shown[lane] = !quiet[lane] || traveller.observe.is_some();
                kept[lane] = !shown[lane];
            }
        }
        if shown.contains(&true) {
            self.step.extend(wide);
        }
        let mut results = [const { Ok(()) }; W];
        for (lane, traveller) in lanes.iter_mut().enumerate() {
            if let Some(traveller) = traveller
                && shown[lane]
            {
                results[lane] = self.conclude(lane, traveller, quiet[lane]);
            }
        }
        self.step.shift_where(L::mask(kept));
        self.glances.shift_where(L::mask(kept));
        for (lane, traveller) in lanes.into_iter().enumerate() {
            if let Some(traveller) = traveller {
                if kept[lane] {
                    traveller
                        .integrator
                        .pass(lengths.get(lane), traveller.course);
                }
                // Whoever looks at an integrator at the end of its course finds its state.
                if traveller.integrator.time() >= traveller.course.end() {
                    self.give(lane, false, traveller.integrator);
                }
            }
        }
        results
    }

    /// Finishes a step in the lane's own integrator, and takes back where that leads.
    fn conclude<T: System<f64>, F: FnMut(&mut T, &Step<f64>)>(
        &mut self,
        lane: usize,
        traveller: &mut Traveller<T, F>,
        quiet: bool,
    ) -> Result<(), Error> {
        let Traveller {
            integrator,
            system,
            course,
            observe,
            ..
        } = traveller;
        self.give(lane, true, integrator);
        let result = integrator.conclude(*system, course, quiet, observe);
        self.place(lane, integrator);
        result
    }

    /// Makes an integrator's state that of a lane; with its last step, if asked for.
    pub fn give(&self, lane: usize, step: bool, integrator: &mut Integrator<f64>) {
        self.step.lane(lane, step, &mut integrator.step);
        self.glances.give(lane, &mut integrator.glances);
    }

    fn squared_errors(&self, scales: &[L]) -> [L; 2] {
        let step = &self.step;
        step.squared_errors(
            #[inline(always)]
            |j| {
                let size = step.from[j].abs().max(step.to[j].abs()).max(scales[j]);
                self.tolerances * size
            },
        )
    }
}
