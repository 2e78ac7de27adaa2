//! Prints how long a revolution of the single-stage machine takes, both joints 0.3 mm clear;
//! `tests/peers/run` compares it with other programs.
//!
//! ```sh
//! cargo run --release -p crosshead-simulate --features bench --example time_revolutions -- \
//!     --tolerance 1e-6 --revolutions 20 --out acceleration.f64
//! ```
//!
//! The line printed is the CPU time of one revolution (ms) without reading the machine. The file
//! holds the crosshead's acceleration at 10 kHz from the centred start, as plain samples without a
//! measuring chain: little-endian f64, m/s². `--width 0`, or none, runs one machine by itself,
//! `--width 8` several side by side in registers of so many numbers, where the processor has them
//! (`CROSSHEAD_LANES=4` holds them down); the time is then that of one. `--of motion` is one machine without
//! samples, `--of exponent` the same with the tangent of its largest Lyapunov exponent. The run is repeated
//! for `--seconds 0.2`.

use input::{MachineFile, Resolved};
use integrate::{Ensemble, Integrator, Step, Traveller};
use mechanism::joints::revolute::Revolute;
use mechanism::mode::Mode;
use mechanism::{Dynamics, Machine, SideBySide};
use scalar::lanes::{self, InLanes, Lanes, in_lanes};
use simulate::lookout::{self, Lookout};
use simulate::{Chain, ExponentSettings, Flow, Measured, Sensor};
use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Samples per second.
const RATE: f64 = 10_000.0;
/// Radial clearance of both joints.
const CLEARANCE: &str = "0.3 mm";
/// Longest step, as a share of a revolution: that of `simulate`.
const LONGEST_STEP: f64 = 0.05;
/// CPU time for which the run is repeated, s, unless the command line has another.
const SECONDS: f64 = 0.2;

/// What the command line asks for.
struct Task {
    tolerance: f64,
    revolutions: u32,
    width: usize,
    seconds: f64,
    of: String,
    out: Option<PathBuf>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let task = Task::read(std::env::args().skip(1))?;
    let machine = machine()?.machine;
    let run = match task.width {
        0 => match task.of.as_str() {
            "samples" => alone,
            "motion" => motion,
            "exponent" => exponent,
            of => return Err(format!("--of {of} is not samples, motion or exponent").into()),
        },
        width if width == lanes::width() => together,
        width => {
            let has = lanes::width();
            return Err(
                format!("the registers hold {has} numbers; {width} is neither that nor 0").into(),
            );
        }
    };
    let (milliseconds, Done { samples, machines }) =
        measure(task.seconds, || run(&machine, &task))?;
    if let Some(path) = &task.out {
        let bytes: Vec<u8> = samples.iter().flat_map(|x| x.to_le_bytes()).collect();
        std::fs::write(path, bytes)?;
    }
    let each = milliseconds / f64::from(task.revolutions) / machines as f64;
    writeln!(std::io::stdout(), "{each:.6}")?;
    Ok(())
}

/// What was run: the samples of the first machine, and how many machines there were.
struct Done {
    samples: Vec<f64>,
    machines: usize,
}

impl Task {
    /// Where the run ends, s.
    fn end(&self, machine: &Machine) -> f64 {
        f64::from(self.revolutions) * machine.cycle().length()
    }

    fn read(mut words: impl Iterator<Item = String>) -> Result<Self, Box<dyn Error>> {
        let mut task = Self {
            tolerance: 1e-6,
            revolutions: 20,
            width: 0,
            seconds: SECONDS,
            of: "samples".into(),
            out: None,
        };
        while let Some(flag) = words.next() {
            let value = words.next().ok_or(format!("{flag} needs a value"))?;
            match flag.as_str() {
                "--tolerance" => task.tolerance = value.parse()?,
                "--revolutions" => task.revolutions = value.parse()?,
                "--width" => task.width = value.parse()?,
                "--seconds" => task.seconds = value.parse()?,
                "--of" => task.of = value,
                "--out" => task.out = Some(value.into()),
                _ => return Err(format!("{flag} is not known").into()),
            }
        }
        Ok(task)
    }
}

/// The shipped machine with both ends of the rod clear.
fn machine() -> Result<Resolved, Box<dyn Error>> {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../data/machines/single-stage.yaml"
    );
    let mut tree = input::machine_file::read(Path::new(path))?
        .to_tree()
        .clone();
    for joint in ["big_end", "small_end"] {
        let path = format!("joints.{joint}.clearance");
        input::paths::set(&mut tree, &path, CLEARANCE.into())?;
    }
    Ok(MachineFile::from_tree(&tree)?.resolve()?)
}

/// A machine on its way, and what was seen of it.
struct Lane {
    dynamics: Dynamics<f64>,
    integrator: Integrator<f64>,
    samples: Samples,
}

/// Samples under way, up to so many.
struct Samples {
    count: usize,
    /// How many have been asked for.
    asked: usize,
    lookout: Box<dyn Lookout>,
    mode: Mode,
    times: Vec<f64>,
    seen: Vec<f64>,
}

impl Lane {
    fn start(machine: &Machine, task: &Task) -> Self {
        let (mut dynamics, state) = machine.start::<f64>();
        let longest = LONGEST_STEP * machine.cycle().length();
        let count = (task.end(machine) * RATE).round() as usize;
        Self {
            integrator: Integrator::new(&mut dynamics, 0.0, &state, task.tolerance, longest),
            samples: Samples {
                count,
                asked: 0,
                lookout: lookout::at(machine, false),
                mode: Mode::clone(dynamics.mode()),
                times: Vec::new(),
                seen: Vec::with_capacity(count),
            },
            dynamics,
        }
    }
}

impl Samples {
    /// Asks for the instants up to `stop`.
    fn ask(&mut self, stop: f64) {
        let instants = (self.asked..self.count).map(|i| i as f64 / RATE);
        self.times.clear();
        self.times.extend(instants.take_while(|time| *time <= stop));
    }

    fn observe(&mut self, dynamics: &mut Dynamics<f64>, step: &Step<f64>) {
        self.ask(step.start + step.length);
        if self.times.is_empty() {
            return;
        }
        self.asked += self.times.len();
        if *dynamics.mode() != self.mode {
            self.finish();
            self.mode.clone_from(dynamics.mode());
            self.lookout.set_mode(&self.mode);
        }
        let seen = &mut self.seen;
        let mut show = |_, values: &[f64]| seen.extend(values);
        self.lookout
            .observe(step, &self.times, &[sensor()], &mut show);
    }

    fn finish(&mut self) {
        let seen = &mut self.seen;
        let mut show = |_, values: &[f64]| seen.extend(values);
        self.lookout.finish(&[sensor()], &mut show);
    }

    /// All of them.
    fn end(mut self) -> Vec<f64> {
        self.finish();
        self.seen
    }
}

/// An accelerometer without a measuring chain.
fn sensor() -> Sensor {
    let measured = Measured::CrossheadAcceleration { throw: 0 };
    Sensor {
        measured,
        chain: Chain::default(),
    }
}

/// One machine by itself, step by step.
fn alone(machine: &Machine, task: &Task) -> Result<Done, Box<dyn Error>> {
    let Lane {
        mut dynamics,
        mut integrator,
        mut samples,
    } = Lane::start(machine, task);
    integrator.advance(&mut dynamics, task.end(machine), |dynamics, step| {
        samples.observe(dynamics, step);
    })?;
    Ok(Done {
        samples: samples.end(),
        machines: 1,
    })
}

/// One machine by itself, at which nobody looks.
fn motion(machine: &Machine, task: &Task) -> Result<Done, Box<dyn Error>> {
    let Lane {
        mut dynamics,
        mut integrator,
        ..
    } = Lane::start(machine, task);
    integrator.reach(&mut dynamics, task.end(machine))?;
    Ok(Done {
        samples: integrator.state().to_vec(),
        machines: 1,
    })
}

/// Its largest Lyapunov exponent, 1/s.
fn exponent(machine: &Machine, task: &Task) -> Result<Done, Box<dyn Error>> {
    let settings = ExponentSettings {
        transient: 0,
        revolutions: task.revolutions,
        tolerance: task.tolerance,
    };
    let found = simulate::exponents(machine, &settings, 1)?;
    Ok(Done {
        samples: found.iter().map(|e| e.per_second).collect(),
        machines: 1,
    })
}

/// The machine in the first of several lanes; in the others the same with wider and wider joints.
fn together(machine: &Machine, task: &Task) -> Result<Done, Box<dyn Error>> {
    in_lanes(Together { machine, task })
}

struct Together<'a> {
    machine: &'a Machine,
    task: &'a Task,
}

impl InLanes for Together<'_> {
    type Output = Result<Done, Box<dyn Error>>;
    fn run<L: Lanes<W>, const W: usize>(self) -> Self::Output {
        travel::<L, W>(self.machine, self.task)
    }
}

fn travel<L: Lanes<W>, const W: usize>(
    machine: &Machine,
    task: &Task,
) -> Result<Done, Box<dyn Error>> {
    let mut lanes: [Lane; W] = std::array::from_fn(|lane| {
        let mut machine = machine.clone();
        let throw = &mut machine.throws[0];
        for joint in [&mut throw.big_end, &mut throw.small_end] {
            if let Revolute::Clear(clear) = joint {
                clear.clearance *= 1.0 + 0.01 * lane as f64;
            }
        }
        Lane::start(&machine, task)
    });
    let mut wide = SideBySide::<L>::new(lanes.each_ref().map(|lane| &lane.dynamics));
    let mut ensemble = Ensemble::<L, W>::new(&wide);
    for (i, lane) in lanes.iter().enumerate() {
        ensemble.place(i, &lane.integrator);
    }
    let end = task.end(machine);
    let courses = lanes.each_ref().map(|lane| lane.integrator.course(end));
    loop {
        let before = lanes.each_ref().map(|lane| lane.integrator.work().switches);
        let mut trials = [None; W];
        for ((trial, lane), course) in trials.iter_mut().zip(&lanes).zip(&courses) {
            *trial = lane.integrator.propose(course)?;
        }
        if trials.iter().all(Option::is_none) {
            break;
        }
        let mut travellers = [const { None }; W];
        let mut samples = Vec::with_capacity(W);
        for (i, lane) in lanes.iter_mut().enumerate() {
            samples.push(&mut lane.samples);
            travellers[i] = trials[i].map(|trial| Traveller {
                integrator: &mut lane.integrator,
                system: &mut lane.dynamics,
                course: &courses[i],
                trial,
            });
        }
        let observe = |wide: &mut _, step: &mut Step<L>, stands| {
            observe_lanes(&mut samples, wide, step, stands);
        };
        for result in ensemble.advance(&mut wide, travellers, Some(observe)) {
            result?;
        }
        for (i, lane) in lanes.iter().enumerate() {
            if lane.integrator.work().switches != before[i] {
                wide.set_mode(i, lane.dynamics.mode());
            }
        }
    }
    let first = lanes.into_iter().next().ok_or("no lanes")?;
    Ok(Done {
        samples: first.samples.end(),
        machines: W,
    })
}

/// Looks at the instants within the steps that stand, a lane's next one at a time.
fn observe_lanes<L: Lanes<W>, const W: usize>(
    samples: &mut [&mut Samples],
    machines: &mut SideBySide<L>,
    step: &mut Step<L>,
    stands: [bool; W],
) {
    let stop = step.start + step.length;
    for (lane, samples) in samples.iter_mut().enumerate() {
        samples.times.clear();
        if stands[lane] {
            samples.ask(stop.get(lane));
        }
    }
    let most = samples.iter().map(|s| s.times.len()).max().unwrap_or(0);
    if most > 0 {
        step.extend(machines);
    }
    let mut state = vec![L::zero(); step.from.len()];
    for i in 0..most {
        let mut instants = step.start;
        for (lane, samples) in samples.iter().enumerate() {
            if let Some(time) = samples.times.get(i) {
                instants.set(lane, *time);
            }
        }
        step.interpolate((instants - step.start) / step.length, &mut state);
        let seen = machines.evaluate_sensed(instants, &state).throws[0]
            .accelerations
            .crosshead;
        for (lane, samples) in samples.iter_mut().enumerate() {
            if i < samples.times.len() {
                samples.seen.push(seen.get(lane));
                samples.asked += 1;
            }
        }
    }
}

/// CPU time of one run of `work`, ms, and what it found: one run to warm the caches up, then as many
/// as take so many seconds, at least one.
fn measure<T>(
    seconds: f64,
    work: impl Fn() -> Result<T, Box<dyn Error>>,
) -> Result<(f64, T), Box<dyn Error>> {
    work()?;
    let start = thread_time()?;
    for runs in 1.. {
        let found = work()?;
        let passed = thread_time()? - start;
        if passed > seconds {
            return Ok((1e3 * passed / f64::from(runs), found));
        }
    }
    unreachable!("time passes")
}

/// CPU time of this thread so far, s, as Linux counts it.
fn thread_time() -> Result<f64, Box<dyn Error>> {
    let counts = std::fs::read_to_string("/proc/thread-self/schedstat")?;
    let nanoseconds = counts.split(' ').next().ok_or("an empty schedstat")?;
    Ok(nanoseconds.parse::<f64>()? * 1e-9)
}
