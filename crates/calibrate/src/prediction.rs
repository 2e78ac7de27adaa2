//! What a machine shows in place of a recording: the same lines, and their derivatives.

use crate::error::Error;
use crate::observation::{self, Observation, POINTS};
use crate::problem::{Problem, throw};
use crate::sectors::scatter;
use input::Resolved;
use signal::Complex64;
use signal::angle_resampling::AngleGrid;
use signal::crank_angle::CrankAngle;
use signal::high_pass::HighPass;
use signal::order_lines::{OrderLines, deviations};
use simulate::{
    Asked, Sensitivities, Sensor, Settings, Structure, Transient, WarmStart, sensitivities, settle,
    settled_together,
};
use std::f64::consts::TAU;

/// Relative local error of the integration; far below the noise of any sensor.
const TOLERANCE: f64 = 1e-6;
/// Change from revolution to revolution at which a motion counts as settled, and revolutions that
/// it is given.
const SETTLED: f64 = 1e-5;
const AT_MOST: u32 = 30;
/// The same in a rough prediction: what has not settled then counts as a motion that does not repeat itself.
const AT_MOST_ROUGH: u32 = 8;
/// Revolutions that are predicted of a motion that does not repeat itself.
const CHAOTIC: u32 = 24;
/// The same where the recorded motion repeats itself: their scatter is not compared then.
const WRONG: u32 = 4;

/// Machines that fill the widest registers.
const REGISTER: usize = 8;

/// How many of `count` runs a thread simulates side by side. Up to two fillings, so that a lane that is done early has
/// something to go on with; but one, where there is a thread for each.
pub(crate) fn to_a_thread(count: usize) -> usize {
    match count.div_ceil(rayon::current_num_threads()) {
        0 | 1 => 1,
        share => share.clamp(REGISTER, 2 * REGISTER),
    }
}

/// How accurate a prediction is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Accuracy {
    /// Far below the noise of any sensor.
    Fine,
    /// To a few thousandths, with derivatives of throws that do not feel each other.
    Coarse,
    /// To a few hundredths: for energies, which are not compared any closer.
    Rough,
}

impl Accuracy {
    /// The transient, with the revolutions that are recorded of a motion that repeats itself as the recorded one does, or
    /// does not.
    fn lasting(self, repeats: bool) -> (Transient, u32) {
        let (looser, at_most) = match self {
            Self::Fine => (1.0, AT_MOST),
            Self::Coarse => (10.0, AT_MOST),
            Self::Rough => (1000.0, AT_MOST_ROUGH),
        };
        let change = SETTLED * looser;
        let revolutions = match (repeats, self) {
            (true, _) => WRONG,
            (false, Self::Rough) => CHAOTIC / 2,
            (false, _) => CHAOTIC,
        };
        let transient = Transient::Settled { change, at_most };
        (transient, revolutions)
    }

    /// Relative local error of the integration.
    fn tolerance(self) -> f64 {
        match self {
            Self::Fine => TOLERANCE,
            Self::Coarse | Self::Rough => 10.0 * TOLERANCE,
        }
    }
}

/// The lines of a run as the model has them.
#[derive(Clone, Debug)]
pub struct Prediction {
    /// One per channel of the observation.
    pub lines: Vec<OrderLines>,
    /// For each parameter and channel the derivative of the amplitudes by the coordinate.
    pub derivatives: Vec<Vec<Vec<Complex64>>>,
    /// True where the motion repeats itself.
    pub periodic: bool,
    /// For each channel the energies by band and sector that its revolutions have beside the mean of every other one, where energies
    /// are asked for and there are several.
    pub scatter: Vec<Vec<f64>>,
}

impl Prediction {
    /// Lines without derivatives.
    pub fn new(lines: Vec<OrderLines>, periodic: bool) -> Self {
        Self {
            lines,
            derivatives: Vec::new(),
            periodic,
            scatter: Vec::new(),
        }
    }
}

/// The lines of a run with the parameters at these coordinates.
///
/// # Errors
/// An invalid machine, or one that cannot be integrated.
pub fn predict(problem: &Problem, run: &Observation, x: &[f64]) -> Result<Prediction, Error> {
    let mut all = predictions(problem, &[(run, x)], Accuracy::Fine);
    all.swap_remove(0)
}

/// The same with the derivatives by the coordinates. On a motion that does not repeat itself they
/// do not exist, and are left empty.
///
/// # Errors
/// As [`predict`].
pub fn predict_with_derivatives(
    problem: &Problem,
    run: &Observation,
    x: &[f64],
) -> Result<Prediction, Error> {
    with_derivatives(problem, run, x, Accuracy::Fine)
}

/// A run, and the coordinates at which it is predicted.
pub(crate) type Wanted<'a> = (&'a Observation, &'a [f64]);

/// The predictions of this accuracy, without derivatives. All are simulated side by side, and do not depend on each other.
///
/// # Errors
/// As [`predict`], each its own.
pub(crate) fn predictions(
    problem: &Problem,
    wanted: &[Wanted],
    accuracy: Accuracy,
) -> Vec<Result<Prediction, Error>> {
    let wanted: Vec<_> = wanted.iter().map(|wanted| (problem, *wanted)).collect();
    predictions_of_machines(&wanted, accuracy)
}

/// The same of several machines.
///
/// # Errors
/// As [`predict`], each its own.
pub(crate) fn predictions_of_machines(
    wanted: &[(&Problem, Wanted)],
    accuracy: Accuracy,
) -> Vec<Result<Prediction, Error>> {
    let all = wanted.iter();
    let all = all.map(|(problem, (run, x))| At::new(problem, run, x, accuracy));
    let all: Vec<Result<At, Error>> = all.collect();
    let asked: Vec<Asked> = all.iter().flatten().map(At::asked).collect();
    let mut records = settled_together(&asked).into_iter();
    let of = |(at, (problem, _)): (Result<At, Error>, &(&Problem, Wanted))| {
        let at = at?;
        let record = records.next();
        let record = at.recorded(record.ok_or(Error::Nothing("nothing was simulated"))?)?;
        problem.meter.add(record.steps);
        let shown = at.shown(&record)?;
        let lines = at.lines_of_all(&shown.grid, shown.series)?;
        Ok(Prediction {
            scatter: match accuracy {
                Accuracy::Rough => at.scatter(&shown)?,
                _ => Vec::new(),
            },
            ..Prediction::new(lines, record.settled)
        })
    };
    all.into_iter().zip(wanted).map(of).collect()
}

/// The motion that a run settles on from where its simulations begin, with the parameters at these coordinates; none where it
/// does not settle.
///
/// # Errors
/// As [`predict`].
pub(crate) fn settled(
    problem: &Problem,
    run: &Observation,
    x: &[f64],
) -> Result<Option<WarmStart>, Error> {
    let at = At::new(problem, run, x, Accuracy::Fine)?;
    at.recorded(settle(&at.asked()))
}

/// The prediction of this accuracy, with derivatives.
///
/// # Errors
/// As [`predict`].
pub(crate) fn with_derivatives(
    problem: &Problem,
    run: &Observation,
    x: &[f64],
    accuracy: Accuracy,
) -> Result<Prediction, Error> {
    let at = At::new(problem, run, x, accuracy)?;
    // The frame feels all throws.
    let is_of_throw = run.channels.iter().all(|c| c.column.contains('.'));
    let mut groups = match accuracy != Accuracy::Fine && is_of_throw {
        true => problem.independent(),
        false => (0..x.len()).map(|i| vec![i]).collect(),
    };
    let moving = |i: &usize| problem.parameters[*i].moves(&run.id);
    groups.iter_mut().for_each(|group| group.retain(moving));
    groups.retain(|group| !group.is_empty());
    let mut moved = problem.moved(run, x, &groups)?;
    let moved_slow: Vec<Vec<Slow>> = moved
        .iter_mut()
        .map(|moved| Slow::taken_from(&mut moved.sensors))
        .collect();
    let At {
        slow,
        turning,
        offset_slopes,
        ..
    } = &at;
    let turning = *turning;
    let record = at.recorded(sensitivities(&at.asked(), &moved))?;
    problem.meter.add(record.steps);
    let periodic = record.settled;
    let shown = at.shown(&record)?;
    let scatter = match accuracy {
        Accuracy::Coarse => at.scatter(&shown)?,
        _ => Vec::new(),
    };
    let Shown {
        angle,
        grid,
        series,
    } = shown;
    let lines = at.lines_of_all(&grid, series)?;
    let mut derivatives = record
        .derivatives
        .iter()
        .map(|of_parameter| {
            let Some((of_angle, of_series)) = of_parameter.split_last() else {
                return Ok(Vec::new());
            };
            let channels = of_series.iter().zip(series).enumerate();
            channels
                .map(|(channel, (derivative, x))| {
                    let at_angle = at_equal_angle(derivative, x, of_angle, angle.angles());
                    let lines = at.lines(&grid, channel, &at_angle)?;
                    let per_coordinate = |c: &Complex64| c / problem.step();
                    Ok(lines.amplitude.iter().map(per_coordinate).collect())
                })
                .collect()
        })
        .collect::<Result<Vec<Vec<Vec<Complex64>>>, Error>>()?;
    if periodic {
        derivatives = apart(problem, run, &groups, derivatives, &lines);
    }
    for (parameter, of_parameter) in derivatives.iter_mut().enumerate() {
        let group = groups.iter().position(|group| group.contains(&parameter));
        for (channel, (of_channel, lines)) in of_parameter.iter_mut().zip(&lines).enumerate() {
            let slope = offset_slopes[parameter];
            for (k, (d, c)) in of_channel.iter_mut().zip(&lines.amplitude).enumerate() {
                *d -= Complex64::I * (k as f64 * slope) * c;
                if let Some(moved) = group.map(|g| &moved_slow[g][channel])
                    && *moved != slow[channel]
                {
                    let [before, after] =
                        [&slow[channel], moved].map(|slow| slow.response(k, turning));
                    // What is shut off altogether has nothing that could change.
                    if before != Complex64::ZERO {
                        *d += (after / before - 1.0) / problem.step() * c;
                    }
                }
            }
        }
    }
    Ok(Prediction {
        derivatives,
        scatter,
        ..Prediction::new(lines, periodic)
    })
}

/// A machine in one run.
struct At<'a> {
    run: &'a Observation,
    machine: Resolved,
    /// What of the measuring chains the machine does not have.
    slow: Vec<Slow>,
    settings: Settings,
    /// Speed of the crank, rad/s; negative clockwise.
    turning: f64,
    /// By how much the recorded crank angle is ahead, rad, and its derivatives.
    offset: f64,
    offset_slopes: Vec<f64>,
}

/// A record of a machine over the grid of crank angles.
struct Shown<'a> {
    angle: CrankAngle,
    grid: AngleGrid,
    /// What the channels show.
    series: &'a [Vec<f64>],
}

impl<'a> At<'a> {
    fn new(
        problem: &Problem,
        run: &'a Observation,
        x: &[f64],
        accuracy: Accuracy,
    ) -> Result<Self, Error> {
        let mut machine = problem.machine(run, x)?;
        let slow = Slow::taken_from(&mut machine.sensors);
        let turning = machine.speed;
        let (transient, revolutions) = accuracy.lasting(run.repeats());
        let (offset, offset_slopes) = problem.crank_angle_offset(run, x);
        Ok(Self {
            run,
            settings: Settings {
                transient,
                revolutions,
                // With the speed given, samples then stand at the grid's angles themselves.
                sample_rate: POINTS as f64 * turning.abs() / TAU,
                inner_rate: inner_rate(&machine),
                tolerance: accuracy.tolerance(),
            },
            machine,
            slow,
            turning,
            offset,
            offset_slopes,
        })
    }

    fn asked(&self) -> Asked<'_> {
        Asked {
            machine: &self.machine.machine,
            sensors: &self.machine.sensors,
            settings: &self.settings,
            warm_start: self.run.warm_start.as_ref(),
        }
    }

    fn recorded<T>(&self, record: Result<T, simulate::Error>) -> Result<T, Error> {
        record.map_err(|source| Error::Simulation {
            run: self.run.id.clone(),
            source,
        })
    }

    fn analysed<T>(&self, result: Result<T, signal::Error>) -> Result<T, Error> {
        result.map_err(|source| Error::Signal {
            run: self.run.id.clone(),
            channel: "simulated".into(),
            source,
        })
    }

    fn shown<'r>(&self, record: &'r Sensitivities) -> Result<Shown<'r>, Error> {
        let (angle, series) = record
            .series
            .split_last()
            .ok_or(Error::Nothing("a run without channels cannot be predicted"))?;
        let angle = self.analysed(CrankAngle::from_encoder(angle))?;
        Ok(Shown {
            grid: self.analysed(AngleGrid::new(&angle, POINTS))?,
            angle,
            series,
        })
    }

    /// The lines of what a channel shows.
    fn lines(
        &self,
        grid: &AngleGrid,
        channel: usize,
        samples: &[f64],
    ) -> Result<OrderLines, Error> {
        let lines = self.analysed(observation::lines(grid, samples))?;
        Ok(self.slow[channel].shown(later(lines, self.offset), self.turning))
    }

    /// The energies of each channel's bands and sectors that its revolutions have beside the mean of every other one.
    fn scatter(&self, shown: &Shown) -> Result<Vec<Vec<f64>>, Error> {
        let of_channel = |(channel, samples): (usize, &Vec<f64>)| {
            let revolutions = self.analysed(shown.grid.resample(samples))?;
            if revolutions.count() < 3 {
                return Ok(Vec::new());
            }
            let mut all = deviations(&revolutions, observation::highest(&shown.grid));
            for (k, c) in all
                .iter_mut()
                .flat_map(|lines| lines.iter_mut().enumerate())
            {
                *c *= self.slow[channel].response(k, self.turning) * turned(k, self.offset);
            }
            Ok(scatter(&self.run.channels[channel].orders, &all))
        };
        shown.series.iter().enumerate().map(of_channel).collect()
    }

    fn lines_of_all(
        &self,
        grid: &AngleGrid,
        series: &[Vec<f64>],
    ) -> Result<Vec<OrderLines>, Error> {
        let channels = series.iter().enumerate();
        channels
            .map(|(channel, samples)| self.lines(grid, channel, samples))
            .collect()
    }
}

/// What of a measuring chain takes longer than a period to settle, or to pass: the lines are multiplied by its response.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Slow {
    /// s.
    delay: f64,
    /// Hz.
    high_pass: Option<f64>,
    structure: Option<Structure>,
}

impl Slow {
    /// That of each sensor, which has none of it afterwards.
    fn taken_from(sensors: &mut [Sensor]) -> Vec<Self> {
        let chains = sensors.iter_mut().map(|sensor| &mut sensor.chain);
        chains
            .map(|chain| Self {
                delay: std::mem::take(&mut chain.delay),
                high_pass: chain.high_pass.take(),
                structure: chain.structure.take(),
            })
            .collect()
    }

    /// Its response at an order of a crank that turns at `speed`, rad/s.
    fn response(&self, order: usize, speed: f64) -> Complex64 {
        let frequency = order as f64 * speed;
        let coupled = |cutoff: f64| HighPass::response(frequency / (TAU * cutoff));
        let passed = self.high_pass.map_or(Complex64::ONE, coupled);
        let carried = self
            .structure
            .map_or(Complex64::ONE, |s| s.response(frequency));
        carried * passed * Complex64::cis(-frequency * self.delay)
    }

    /// Lines behind it.
    fn shown(&self, mut lines: OrderLines, speed: f64) -> OrderLines {
        let both = lines.amplitude.iter_mut().zip(&mut lines.variance);
        for (k, (c, variance)) in both.enumerate() {
            let response = self.response(k, speed);
            *c *= response;
            *variance *= response.norm_sqr();
        }
        lines
    }
}

/// The rate at which the motion is sampled, Hz. Without filters between motion and recorder four
/// samples to each recorded one are enough. Order 3700 is the first to fold down to those that are
/// compared.
fn inner_rate(machine: &Resolved) -> f64 {
    let chains = machine.sensors.iter().map(|sensor| &sensor.chain);
    let mut filtered = chains.filter(|chain| chain.mounting.is_some() || chain.low_pass.is_some());
    match filtered.next() {
        Some(_) => Settings::default().inner_rate,
        None => 0.0,
    }
}

/// The lines over a crank angle that reads `offset` more than the crank has turned.
fn later(mut lines: OrderLines, offset: f64) -> OrderLines {
    for (k, c) in lines.amplitude.iter_mut().enumerate() {
        *c *= turned(k, offset);
    }
    lines
}

/// What an order is multiplied by over a crank angle that reads `offset` more.
fn turned(order: usize, offset: f64) -> Complex64 {
    Complex64::from_polar(1.0, -(order as f64) * offset)
}

/// The derivatives of each parameter from those of groups. A channel of a throw feels the group's parameter of
/// this throw. A parameter in no group moves nothing.
fn apart(
    problem: &Problem,
    run: &Observation,
    groups: &[Vec<usize>],
    of_groups: Vec<Vec<Vec<Complex64>>>,
    lines: &[OrderLines],
) -> Vec<Vec<Vec<Complex64>>> {
    let still = lines
        .iter()
        .map(|of| vec![Complex64::ZERO; of.amplitude.len()]);
    let still: Vec<Vec<Complex64>> = still.collect();
    let mut all = vec![still; problem.parameters.len()];
    for (group, of_group) in groups.iter().zip(of_groups) {
        for i in group {
            let own = throw(&problem.parameters[*i].path);
            let channels = run.channels.iter().zip(&of_group);
            all[*i] = channels
                .map(|(channel, lines)| {
                    let of_channel = channel.column.split_once('.').map(|(throw, _)| throw);
                    if group.len() == 1 || own == of_channel {
                        lines.clone()
                    } else {
                        vec![Complex64::ZERO; lines.len()]
                    }
                })
                .collect();
        }
    }
    all
}

/// The derivative of x at an unchanged crank angle from that at an unchanged time. Where the angle
/// itself moves (a free crank), x is seen elsewhere: dx/dp − (dx/dθ)(dθ/dp).
fn at_equal_angle(derivative: &[f64], x: &[f64], of_angle: &[f64], angle: &[f64]) -> Vec<f64> {
    (0..x.len())
        .map(|i| {
            if of_angle[i] == 0.0 {
                return derivative[i];
            }
            derivative[i] - slope(x, i) / slope(angle, i) * of_angle[i]
        })
        .collect()
}

/// Weights of a central difference of the eighth order (Fornberg 1988, table 1). They are good to 2 % at the
/// highest orders that are compared, of which a sample is a quarter of a period.
const CENTRAL: [f64; 4] = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];

/// The difference of x per sample at sample i; to the first order at the ends.
fn slope(x: &[f64], i: usize) -> f64 {
    let reach = CENTRAL.len();
    if i < reach || i + reach >= x.len() {
        let [low, high] = [i.saturating_sub(1), (i + 1).min(x.len() - 1)];
        return (x[high] - x[low]) / (high - low) as f64;
    }
    let pairs = CENTRAL.iter().enumerate();
    pairs
        .map(|(k, weight)| weight * (x[i + k + 1] - x[i - k - 1]))
        .sum()
}
