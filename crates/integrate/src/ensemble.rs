//! Several integrations side by side: each in a lane, with its own time, step, mode and end.
//!
//! What all of them do at every step is done for all at once: the stages, the error, the evaluation of the
//! guards, and the continuous extension. Step control, the search for switches and
//! the switches themselves are those of each lane's own [`Integrator`]. So every lane makes the very steps
//! that it would make alone, with the same bits.

use crate::dop853::Step;
use crate::glance::Glances;
use crate::integrator::{Course, Error, Integrator, Sight, Trial};
use crate::system::System;
use scalar::{Lanes, Scalar, inlined};

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
pub struct Traveller<'a, T> {
    /// Its own integrator, whose time and step length are up to date; its state is where the course
    /// ends.
    pub integrator: &'a mut Integrator<f64>,
    /// Its own system, in its mode.
    pub system: &'a mut T,
    /// Where it is going.
    pub course: &'a Course,
    /// The step that it wants to try.
    pub trial: Trial,
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
    /// their modes. Still in these modes `observe`, if there is one, is shown the steps, which it may
    /// extend, and in which lanes they stand. What became of each lane: where it fails, its integrator is of no
    /// use any more.
    pub fn advance<T: System<f64>, Wide: System<L>>(
        &mut self,
        wide: &mut Wide,
        mut lanes: [Option<Traveller<T>>; W],
        observe: Option<impl FnOnce(&mut Wide, &mut Step<L>, [bool; W])>,
    ) -> [Result<(), Error>; W] {
        let mut lengths = L::zero();
        for (lane, traveller) in lanes.iter().enumerate() {
            if let Some(traveller) = traveller {
                self.step.start.set(lane, traveller.integrator.time());
                lengths.set(lane, traveller.trial.length);
            }
        }
        let look = inlined(
            #[inline(always)]
            |stage, system: &mut _| self.glances.stage(stage, system),
        );
        self.step.take(wide, lengths, look);
        let squares = self.squared_errors(wide.scales());
        let quiet = self.glances.quiet().map_or([false; W], L::truths);

        let (mut stands, mut looked_into) = ([false; W], [false; W]);
        for (lane, traveller) in lanes.iter_mut().enumerate() {
            let Some(Traveller {
                integrator, trial, ..
            }) = traveller
            else {
                continue;
            };
            let squares = [squares[0].get(lane), squares[1].get(lane)];
            if integrator.judge(*trial, squares, self.counted) {
                looked_into[lane] = integrator.looks_into(quiet[lane]);
                stands[lane] = true;
            }
        }
        if looked_into.contains(&true) {
            self.step.extend(wide);
        }
        let mut results = [const { Ok(()) }; W];
        let mut switching = [None; W];
        for (lane, traveller) in lanes.iter_mut().enumerate() {
            if let Some(Traveller {
                integrator, system, ..
            }) = traveller
                && looked_into[lane]
            {
                self.give(lane, true, integrator);
                let sight = integrator.sight(*system);
                stands[lane] = matches!(sight, Ok(Sight::Clear));
                if let Ok(Sight::Here(guard)) = sight {
                    switching[lane] = Some(guard);
                }
                results[lane] = sight.map(|_| ());
            }
        }
        if let Some(observe) = observe
            && stands.contains(&true)
        {
            observe(wide, &mut self.step, stands);
        }
        self.step.shift_where(L::mask(stands));
        self.glances.shift_where(L::mask(stands));
        for (lane, traveller) in lanes.into_iter().enumerate() {
            let Some(Traveller {
                integrator,
                system,
                course,
                ..
            }) = traveller
            else {
                continue;
            };
            if stands[lane] {
                switching[lane] = integrator.pass(lengths.get(lane), course);
            }
            // Whoever looks at an integrator at the end of its course finds its state.
            if switching[lane].is_some() || integrator.time() >= course.end() {
                self.give(lane, false, integrator);
            }
            if let Some(guard) = switching[lane] {
                integrator.switch(system, guard);
                self.place(lane, integrator);
            }
        }
        results
    }

    /// Makes an integrator's state that of a lane; with its last step, if asked for.
    pub fn give(&self, lane: usize, step: bool, integrator: &mut Integrator<f64>) {
        self.step.lane(lane, step, &mut integrator.step);
        self.glances.give(lane, &mut integrator.glances);
    }

    fn squared_errors(&self, scales: &[L]) -> [L; 2] {
        let step = &self.step;
        let n = scales.len();
        let (from, to) = (&step.from[..n], &step.to[..n]);
        step.squared_errors(
            #[inline(always)]
            |j| {
                let size = from[j].abs().max(to[j].abs()).max(scales[j]);
                self.tolerances * size
            },
        )
    }
}
