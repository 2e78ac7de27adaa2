//! Many records at once: machines of one build run in lanes, and whoever is done makes room for the
//! next.

use crate::asked::Asked;
use crate::error::Error;
use crate::record::Record;
use crate::recorder::Sensitivities;
use crate::sampler::Sampler;
use crate::task::{Kept, Task};
use integrate::{Ensemble, Step, System, Traveller, Trial};
use mechanism::{Dynamics, SideBySide, lift};
use scalar::{InLanes, Lanes, Scalar, in_lanes};
use std::ops::ControlFlow;

/// Runs and records all that is asked, as [`simulate`](crate::simulate()) does one by one, bit-identical.
/// A record whose energy does not balance over the revolution after it is an error. `keep` receives each
/// record as soon as it is made, with its index in `asked`, so that full records do not pile up.
pub fn simulate_together<T>(
    asked: &[Asked],
    mut keep: impl FnMut(usize, Result<Record, Error>) -> T,
) -> Vec<T> {
    let mut kept: Vec<_> = asked.iter().map(|_| None).collect();
    run_groups(asked, Kept::CheckedSeries, &mut |index, record| {
        kept[index] = Some(keep(index, record));
    });
    kept.into_iter().flatten().collect()
}

/// What the sensors see of each machine once it has settled, for a fit that tries many: of a motion that repeats itself one
/// period is integrated, and a machine is given up as [`sensitivities`](crate::sensitivities) does. There are no
/// derivatives. What is found of a machine does not depend on the others.
///
/// # Errors
/// As [`sensitivities`](crate::sensitivities).
pub fn settled_together(asked: &[Asked]) -> Vec<Result<Sensitivities, Error>> {
    let mut all: Vec<_> = asked.iter().map(|_| None).collect();
    run_groups(asked, Kept::Period, &mut |index, record| {
        let throws = asked[index].machine.throws.len() as u64;
        all[index] = Some(record.map(|record| Sensitivities {
            series: record.series,
            derivatives: Vec::new(),
            settled: record.settled,
            steps: throws * record.work.tried(),
        }));
    });
    all.into_iter().flatten().collect()
}

/// Independent of what is kept, so that the equations are compiled once, in this crate, by its profile.
fn run_groups(asked: &[Asked], kept: Kept, file: &mut File) {
    for alike in of_one_build(asked) {
        in_lanes(Group {
            asked,
            kept,
            alike: &alike,
            file,
        });
    }
}

/// Which machines can share lanes: those that differ in numbers alone, and of which the same is recorded.
fn of_one_build(asked: &[Asked]) -> Vec<Vec<usize>> {
    let mut groups: Vec<(_, Vec<usize>)> = Vec::new();
    for (i, asked) in asked.iter().enumerate() {
        let measured = asked.sensors.iter().map(|sensor| sensor.measured);
        let build = (lift::build(asked.machine), measured.collect::<Vec<_>>());
        match groups.iter_mut().find(|(of, _)| *of == build) {
            Some((_, group)) => group.push(i),
            None => groups.push((build, vec![i])),
        }
    }
    groups.into_iter().map(|(_, group)| group).collect()
}

/// Takes the record of who has arrived, or why it failed.
type File<'f> = dyn FnMut(usize, Result<Record, Error>) + 'f;

/// A record in a lane.
struct Passenger<'a> {
    index: usize,
    task: Task<'a>,
    trial: Trial,
    /// Switches that the lanes know of.
    switches: u64,
}

impl<'a> Passenger<'a> {
    /// A task up to its next step; its record where there is none.
    fn board(index: usize, mut task: Task<'a>) -> Result<Result<Self, Record>, Error> {
        loop {
            if let Some(trial) = task.propose()? {
                return Ok(Ok(Self {
                    index,
                    trial,
                    switches: task.run.work().switches,
                    task,
                }));
            }
            match task.arrive()? {
                Ok(record) => return Ok(Err(record)),
                Err(next) => task = next,
            }
        }
    }

    /// At the end of a course; none where that was the last.
    fn go_on(self, file: &mut File) -> Option<Self> {
        settle(self.index, Self::board(self.index, self.task), file)
    }
}

/// Cases that can share a coach.
struct Group<'a, 'b, 'f> {
    asked: &'b [Asked<'a>],
    kept: Kept,
    alike: &'b [usize],
    file: &'b mut File<'f>,
}

impl InLanes for Group<'_, '_, '_> {
    type Output = ();
    fn run<L: Lanes<W>, const W: usize>(self) {
        travel::<L, W>(self);
    }
}

/// The lanes of a group.
struct Coach<'a, L: Scalar, const W: usize> {
    passengers: [Option<Passenger<'a>>; W],
    ensemble: Ensemble<L, W>,
    wide: SideBySide<L>,
    /// A step of one lane, to be looked at.
    step: Step<f64>,
}

fn travel<L: Lanes<W>, const W: usize>(group: Group) {
    let Group {
        asked,
        kept,
        alike,
        file,
    } = group;
    let mut queue = alike.iter().copied();
    let mut passengers = [const { None }; W];
    let mut next = |file: &mut File| {
        queue.find_map(|index| {
            let task = Task::start(asked[index], 0.0, kept);
            let boarded = task.and_then(|task| Passenger::board(index, task));
            settle(index, boarded, file)
        })
    };
    for place in &mut passengers {
        *place = next(file);
    }
    let Some(mut coach) = Coach::<L, W>::new(passengers) else {
        return;
    };
    while coach.count() > L::FEW {
        coach.step(file);
        let mut boarded = false;
        for lane in 0..W {
            if coach.passengers[lane].is_none()
                && let Some(passenger) = next(file)
            {
                coach.ensemble.place(lane, passenger.task.run.integrator());
                coach.passengers[lane] = Some(passenger);
                boarded = true;
            }
        }
        if boarded {
            coach.widen();
        }
    }
    // The few that are left are faster one by one.
    let last = coach.passengers.iter_mut().enumerate();
    for (lane, passenger) in last {
        if let Some(Passenger {
            index, mut task, ..
        }) = passenger.take()
        {
            coach.ensemble.give(lane, false, task.run.integrator_mut());
            file(index, task.finish(&mut |_| ControlFlow::Continue(())));
        }
    }
    // Where there is one lane, so is everybody who still waits.
    while let Some(passenger) = next(file) {
        file(
            passenger.index,
            passenger.task.finish(&mut |_| ControlFlow::Continue(())),
        );
    }
}

/// Files a record or a failure; who still travels is given back.
fn settle<'a>(
    index: usize,
    boarded: Result<Result<Passenger<'a>, Record>, Error>,
    file: &mut File,
) -> Option<Passenger<'a>> {
    match boarded {
        Ok(Ok(passenger)) => return Some(passenger),
        Ok(Err(record)) => file(index, Ok(record)),
        Err(error) => file(index, Err(error)),
    }
    None
}

impl<'a, L: Lanes<W>, const W: usize> Coach<'a, L, W> {
    /// None without passengers.
    fn new(passengers: [Option<Passenger<'a>>; W]) -> Option<Self> {
        let wide = SideBySide::new(dynamics(&passengers)?);
        let mut ensemble = Ensemble::new(&wide);
        for (lane, passenger) in passengers.iter().enumerate() {
            if let Some(passenger) = passenger {
                ensemble.place(lane, passenger.task.run.integrator());
            }
        }
        Some(Self {
            passengers,
            ensemble,
            step: Step::new(wide.dimension()),
            wide,
        })
    }

    fn count(&self) -> usize {
        self.passengers.iter().flatten().count()
    }

    /// Takes over the machines that are in the lanes now.
    fn widen(&mut self) {
        if let Some(dynamics) = dynamics(&self.passengers) {
            self.wide = SideBySide::new(dynamics);
        }
    }

    /// One step of everybody. Who has arrived leaves.
    fn step(&mut self, file: &mut File) {
        let mut travellers = [const { None }; W];
        let mut samplers = [const { None }; W];
        for (lane, passenger) in self.passengers.iter_mut().enumerate() {
            if let Some(Passenger { task, trial, .. }) = passenger {
                let (run, course, sampler) = task.parts();
                let (integrator, system) = run.both();
                samplers[lane] = sampler;
                travellers[lane] = Some(Traveller {
                    integrator,
                    system,
                    course,
                    trial: *trial,
                });
            }
        }
        let records = samplers.iter().any(Option::is_some);
        let plain = &mut self.step;
        let observe = records.then_some(|wide: &mut _, step: &mut Step<L>, stands| {
            observe(&mut samplers, wide, step, stands, plain);
        });
        let results = self.ensemble.advance(&mut self.wide, travellers, observe);
        for (lane, (place, result)) in self.passengers.iter_mut().zip(results).enumerate() {
            let Some(passenger) = place else {
                continue;
            };
            let switches = passenger.task.run.work().switches;
            if switches != passenger.switches {
                let (run, _, sampler) = passenger.task.parts();
                let mode = run.dynamics().mode();
                self.wide.set_mode(lane, mode);
                if let Some(sampler) = sampler {
                    sampler.face(mode);
                }
                passenger.switches = switches;
            }
            match result.and_then(|()| passenger.task.propose()) {
                Ok(Some(trial)) => passenger.trial = trial,
                Ok(None) => *place = place.take().and_then(|p| p.go_on(file)),
                Err(error) => {
                    file(passenger.index, Err(error.into()));
                    *place = None;
                }
            }
        }
    }
}

/// Has the lanes that stand looked at, `plain` in place of the step of each.
fn observe<L: Lanes<W>, const W: usize>(
    samplers: &mut [Option<&mut Sampler>; W],
    machines: &mut SideBySide<L>,
    step: &mut Step<L>,
    stands: [bool; W],
    plain: &mut Step<f64>,
) {
    let stop = step.start + step.length;
    for (lane, sampler) in samplers.iter_mut().enumerate() {
        if let Some(sampler) = sampler
            && stands[lane]
            && sampler.pass(stop.get(lane), |i| step.to[i].get(lane))
        {
            step.extend(machines);
            step.lane(lane, true, plain);
            sampler.sample_step(plain);
        }
    }
}

/// The machines in the lanes; in an empty one that of another lane. None where all are empty.
fn dynamics<'p, const W: usize>(
    passengers: &'p [Option<Passenger>; W],
) -> Option<[&'p Dynamics<f64>; W]> {
    let any = passengers.iter().flatten().next()?;
    Some(passengers.each_ref().map(|passenger| {
        let passenger = passenger.as_ref().unwrap_or(any);
        passenger.task.run.dynamics()
    }))
}
