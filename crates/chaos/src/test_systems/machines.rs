//! Machines that a drive repeats, up to a load, timing or amplitude that is drawn anew in every cycle.
//! None is chaotic: what they do follows from numbers that chance gives, not from what they did.

use super::with_noise;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use scalar::random::Stream;
use std::f64::consts::{PI, TAU};

/// Kinds of machines with something random in each cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Machine {
    /// A wave whose height is the load's.
    Load,
    /// A wave on a mean wave, of another shape for each of two loads.
    TwoLoads,
    /// A knock whose time is drawn.
    KnockTime,
    /// A knock whose strength is drawn.
    KnockStrength,
    /// A knock that stays out now and then.
    MissingKnock,
    /// Up to three knocks at any time.
    Rattle,
    /// A valve that opens when the pressure reaches that of the pipe.
    Valve,
    /// Combustion whose start and heat differ (Wiebe 1970).
    Combustion,
    /// Tooth mesh whose amplitude and phase follow the load.
    Gears,
    /// A burst of noise at the same phase.
    Cavitation,
    /// A lightly damped resonance that the load strikes: it rings through several cycles.
    Resonance,
    /// A mass between a spring and a stop, in its periodic motion, driven with the load.
    ImpactOscillator,
    /// Duffing's oscillator in its periodic motion, driven with the load.
    Duffing,
    /// A wave that alternates from cycle to cycle, with the load's height.
    EverySecondCycle,
}

/// How the numbers of successive cycles follow each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Memory {
    /// Independent.
    None,
    /// Each 0.9 of the last, and chance.
    Ninety,
    /// Each 0.5 of the last, and chance.
    Half,
}

impl Memory {
    /// Every kind.
    pub const ALL: [Self; 3] = [Self::None, Self::Ninety, Self::Half];

    fn numbers(self, count: usize, generator: &mut Stream) -> Vec<f64> {
        let kept: f64 = match self {
            Self::None => 0.0,
            Self::Half => 0.5,
            Self::Ninety => 0.9,
        };
        let mut x: f64 = generator.sample(StandardNormal);
        (0..count)
            .map(|_| {
                let shock: f64 = generator.sample(StandardNormal);
                x = kept * x + (1.0 - kept * kept).sqrt() * shock;
                x
            })
            .collect()
    }
}

/// Noise of the sensor, as a share of the signal.
const SENSOR: f64 = 0.01;

/// Standard normal number below which a knock stays out: one cycle in five.
const MISSING: f64 = -0.84;

/// What is drawn for a cycle.
struct Drawn {
    load: f64,
    time: f64,
    missing: bool,
    odd: bool,
}

impl Machine {
    /// Every kind.
    pub const ALL: [Self; 14] = [
        Self::Load,
        Self::TwoLoads,
        Self::KnockTime,
        Self::KnockStrength,
        Self::MissingKnock,
        Self::Rattle,
        Self::Valve,
        Self::Combustion,
        Self::Gears,
        Self::Cavitation,
        Self::Resonance,
        Self::ImpactOscillator,
        Self::Duffing,
        Self::EverySecondCycle,
    ];

    /// `cycles` of `per_cycle` samples; `spread` is the standard deviation of what is drawn, as a share
    /// of its mean (of the cycle, for times). The sensor adds 1 % of noise.
    pub fn samples(
        self,
        cycles: usize,
        per_cycle: usize,
        spread: f64,
        memory: Memory,
        seed: u64,
    ) -> Vec<f64> {
        let mut generator = Stream::seed_from_u64(seed);
        let load = memory.numbers(cycles, &mut generator);
        let time = memory.numbers(cycles, &mut generator);
        let loads: Vec<f64> = load.iter().map(|z| 1.0 + spread * z).collect();
        let clean = match self {
            Self::ImpactOscillator => oscillator(&loads, per_cycle, Law::Stop),
            Self::Duffing => oscillator(&loads, per_cycle, Law::Hardening),
            Self::Resonance => oscillator(&loads, per_cycle, Law::Linear),
            _ => {
                let mut signal = vec![0.0; cycles * per_cycle];
                for cycle in 0..cycles {
                    let drawn = Drawn {
                        load: spread * load[cycle],
                        time: spread * time[cycle],
                        missing: load[cycle] < MISSING,
                        odd: cycle % 2 == 1,
                    };
                    let start = cycle * per_cycle;
                    self.add_cycle(&drawn, &mut signal[start..], per_cycle, &mut generator);
                }
                signal
            }
        };
        with_noise(&clean, SENSOR, seed)
    }

    /// Adds what one cycle contributes from its start on.
    fn add_cycle(self, drawn: &Drawn, out: &mut [f64], per_cycle: usize, chance: &mut Stream) {
        let &Drawn {
            load,
            time,
            missing,
            odd,
        } = drawn;
        let cycle = |out: &mut [f64], wave: &dyn Fn(f64) -> f64| {
            for (i, x) in out.iter_mut().take(per_cycle).enumerate() {
                *x += wave(i as f64 / per_cycle as f64);
            }
        };
        let mean = |t: f64| (TAU * t).sin() + 0.4 * (2.0 * TAU * t + 1.0).cos();
        // A ring of an eighth of the samples' rate that fades within a tenth of a cycle.
        let knock = |out: &mut [f64], at: f64, height: f64| {
            for (i, x) in out.iter_mut().take(2 * per_cycle).enumerate() {
                let since = i as f64 / per_cycle as f64 - at;
                if since >= 0.0 {
                    let tone = (TAU * since * per_cycle as f64 / 8.0).sin();
                    *x += height * (-since / 0.05).exp() * tone;
                }
            }
        };
        match self {
            Self::Load => cycle(out, &|t| mean(t) + load * (3.0 * TAU * t).cos()),
            Self::TwoLoads => {
                let high = if load > 0.0 { 0.3 } else { -0.3 };
                cycle(out, &|t| mean(t) + high * (2.0 * TAU * t).sin().powi(3));
            }
            Self::KnockTime => knock(out, 0.3 + time, 1.0),
            Self::KnockStrength => knock(out, 0.3, load.exp()),
            Self::MissingKnock => {
                cycle(out, &|t| 0.1 * mean(t));
                if !missing {
                    knock(out, 0.3, 1.0 + load);
                }
            }
            Self::Rattle => {
                cycle(out, &|t| 0.1 * mean(t));
                for _ in 0..chance.random_range(0..=3) {
                    knock(
                        out,
                        chance.random_range(0.0..1.0),
                        chance.random_range(0.3..1.0),
                    );
                }
            }
            Self::Valve => {
                // Adiabatic compression to the pipe's pressure, which the load changes; the valve
                // strikes its stop as it opens.
                let pipe = 4.0 * (1.0 + load);
                let volume = |t: f64| 0.1 + 0.5 * (1.0 + (TAU * t).cos());
                let pressure = |t: f64| (volume(0.0) / volume(t)).powf(1.3);
                let opens = (0..=1000).map(|i| 0.0005 * f64::from(i));
                let at = opens
                    .into_iter()
                    .find(|t| pressure(*t) >= pipe)
                    .unwrap_or(0.5);
                cycle(out, &|t| {
                    if t < at {
                        pressure(t)
                    } else if t < 0.5 {
                        pipe
                    } else {
                        1.0
                    }
                });
                knock(out, at, 1.0 + load);
            }
            Self::Combustion => {
                let (start, heat) = (0.45 + 0.3 * time, 1.0 + load);
                cycle(out, &|t| {
                    let burnt = ((t - start) / 0.15).max(0.0);
                    let rate = burnt.powi(2) * (-6.9 * burnt.powi(3)).exp();
                    (-(t - 0.5).powi(2) / 0.01).exp() + 3.0 * heat * rate
                });
            }
            Self::Gears => cycle(out, &|t| {
                mean(t) + (0.5 + load) * (17.0 * TAU * t + 3.0 * time).sin()
            }),
            Self::Cavitation => {
                cycle(out, &mean);
                let burst = &mut out[per_cycle / 3..per_cycle / 2];
                for x in burst {
                    *x += 0.5 * (1.0 + load) * chance.sample::<f64, _>(StandardNormal);
                }
            }
            Self::EverySecondCycle => {
                let sign = if odd { -1.0 } else { 1.0 };
                cycle(out, &|t| mean(t) + sign * (0.3 + load) * (PI * t).sin());
            }
            Self::ImpactOscillator | Self::Duffing | Self::Resonance => {}
        }
    }
}

/// What holds the mass of an oscillator.
#[derive(Clone, Copy)]
enum Law {
    /// A spring, and one twenty times as stiff on one side.
    Stop,
    /// A cubic spring.
    Hardening,
    /// A stiff linear spring, struck at the start of every cycle.
    Linear,
}

/// Acceleration of a driven oscillator, the drive's height in each cycle being given.
fn oscillator(loads: &[f64], per_cycle: usize, law: Law) -> Vec<f64> {
    const SUBSTEPS: usize = 4;
    const SETTLING: usize = 30;
    let h = TAU / (per_cycle * SUBSTEPS) as f64;
    let acceleration = |phase: f64, load: f64, [x, v]: [f64; 2]| match law {
        Law::Stop => load * phase.cos() - 0.5 * v - 2.0 * x - 40.0 * (x - 0.2).max(0.0),
        Law::Hardening => load * phase.cos() - 0.4 * v - x - x.powi(3),
        Law::Linear => {
            let strike = if phase < 0.3 { 10.0 * load } else { 0.0 };
            strike - 0.4 * v - 28.0 * x
        }
    };
    let mut y = [0.0; 2];
    let mut signal = Vec::with_capacity(loads.len() * per_cycle);
    let settling = std::iter::repeat_n(&1.0, SETTLING);
    for (cycle, load) in settling.chain(loads).enumerate() {
        for i in 0..per_cycle {
            let phase = TAU * i as f64 / per_cycle as f64;
            if cycle >= SETTLING {
                signal.push(acceleration(phase, *load, y));
            }
            for step in 0..SUBSTEPS {
                // The midpoint rule.
                let at = phase + step as f64 * h;
                let a = acceleration(at, *load, y);
                let middle = [y[0] + 0.5 * h * y[1], y[1] + 0.5 * h * a];
                let a = acceleration(at + 0.5 * h, *load, middle);
                y = [y[0] + h * middle[1], y[1] + h * a];
            }
        }
    }
    signal
}
