//! Counts how often the interval of the exponent covers the truth, and how many of its half widths
//! the estimate is off, on systems that are in no table. The truths come from two trajectories a hundred millionth apart
//! (Benettin, Galgani and Strelcyn 1976).
#![allow(clippy::print_stdout, reason = "an example prints")]
use chaos::test_systems::with_noise;
use chaos::{delay, exponent::exponent};

type State = [f64; 3];

/// A map, or the derivative of a flow with its sampling interval.
enum Law {
    Map(fn(State) -> State),
    Flow(fn(State) -> State, f64),
}

struct Case {
    name: &'static str,
    law: Law,
    start: State,
    observed: usize,
}

const CASES: [Case; 9] = [
    Case {
        name: "Ikeda",
        law: Law::Map(ikeda),
        start: [0.1, 0.1, 0.0],
        observed: 0,
    },
    Case {
        name: "tinkerbell",
        law: Law::Map(tinkerbell),
        start: [-0.72, -0.64, 0.0],
        observed: 0,
    },
    Case {
        name: "Lozi",
        law: Law::Map(lozi),
        start: [0.1, 0.1, 0.0],
        observed: 0,
    },
    Case {
        name: "delayed logistic",
        law: Law::Map(delayed),
        start: [0.5, 0.4, 0.0],
        observed: 0,
    },
    Case {
        name: "coupled logistic",
        law: Law::Map(coupled),
        start: [0.3, 0.41, 0.0],
        observed: 0,
    },
    Case {
        name: "Sprott B",
        law: Law::Flow(sprott_b, 0.3),
        start: [0.1, 0.2, -0.1],
        observed: 0,
    },
    Case {
        name: "forced pendulum",
        law: Law::Flow(pendulum, 0.35),
        start: [0.1, 0.2, 0.0],
        observed: 1,
    },
    Case {
        name: "Halvorsen",
        law: Law::Flow(halvorsen, 0.07),
        start: [-1.5, -1.5, -1.0],
        observed: 0,
    },
    Case {
        name: "Chen",
        law: Law::Flow(chen, 0.02),
        start: [-3.0, 2.0, 20.0],
        observed: 0,
    },
];

fn ikeda([x, y, _]: State) -> State {
    let t = 0.4 - 6.0 / (1.0 + x * x + y * y);
    [
        1.0 + 0.9 * (x * t.cos() - y * t.sin()),
        0.9 * (x * t.sin() + y * t.cos()),
        0.0,
    ]
}
fn tinkerbell([x, y, _]: State) -> State {
    [
        x * x - y * y + 0.9 * x - 0.6013 * y,
        2.0 * x * y + 2.0 * x + 0.5 * y,
        0.0,
    ]
}
fn lozi([x, y, _]: State) -> State {
    [1.0 - 1.7 * (x * x + 1e-3).sqrt() + y, 0.5 * x, 0.0]
}
fn delayed([x, y, _]: State) -> State {
    [2.27 * x * (1.0 - y), x, 0.0]
}
fn coupled([x, y, _]: State) -> State {
    let f = |x: f64| 3.9 * x * (1.0 - x);
    [0.95 * f(x) + 0.05 * f(y), 0.95 * f(y) + 0.05 * f(x), 0.0]
}
fn sprott_b([x, y, z]: State) -> State {
    [y * z, x - y, 1.0 - x * y]
}
/// Angle, angular velocity, phase of the drive (Baker and Gollub 1996, q = 2, g = 1.5).
fn pendulum([a, v, p]: State) -> State {
    [v, -v / 2.0 - a.sin() + 1.5 * p.cos(), 2.0 / 3.0]
}
fn halvorsen([x, y, z]: State) -> State {
    let f = |a: f64, b: f64, c: f64| -1.4 * a - 4.0 * b - 4.0 * c - b * b;
    [f(x, y, z), f(y, z, x), f(z, x, y)]
}
fn chen([x, y, z]: State) -> State {
    [35.0 * (y - x), -7.0 * x - x * z + 28.0 * y, x * y - 3.0 * z]
}

impl Law {
    fn step(&self, y: State) -> State {
        match self {
            Self::Map(f) => f(y),
            Self::Flow(f, interval) => (0..20).fold(y, |y, _| {
                let h = interval / 20.0;
                let moved = |k: State, by: f64| std::array::from_fn(|i| y[i] + by * k[i]);
                let k1 = f(y);
                let k2 = f(moved(k1, h / 2.0));
                let k3 = f(moved(k2, h / 2.0));
                let k4 = f(moved(k3, h));
                std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]))
            }),
        }
    }
}

impl Case {
    fn samples(&self, length: usize, seed: u64) -> Vec<f64> {
        let mut y = self.start;
        y[0] += 1e-3 * seed as f64;
        (0..2000).for_each(|_| y = self.law.step(y));
        (0..length)
            .map(|_| {
                y = self.law.step(y);
                y[self.observed]
            })
            .collect()
    }

    fn truth(&self, steps: usize) -> f64 {
        let mut y = self.start;
        (0..2000).for_each(|_| y = self.law.step(y));
        let mut other = y;
        other[0] += APART;
        let mut growth = 0.0;
        for _ in 0..steps {
            (y, other) = (self.law.step(y), self.law.step(other));
            let apart: State = std::array::from_fn(|i| other[i] - y[i]);
            let length = apart.iter().map(|d| d * d).sum::<f64>().sqrt();
            growth += (length / APART).ln();
            other = std::array::from_fn(|i| y[i] + apart[i] * APART / length);
        }
        growth / steps as f64
    }
}

const APART: f64 = 1e-8;

fn main() {
    let argument = |i, other| {
        std::env::args()
            .nth(i)
            .and_then(|a| a.parse().ok())
            .unwrap_or(other)
    };
    let seeds = argument(1, 2);
    let mut ratios = Vec::new();
    let (mut covered, mut refused) = (0, 0);
    for case in &CASES {
        let truth = case.truth(200_000);
        for length in [2000, 10_000] {
            for share in [0.0, 0.01, 0.05] {
                for seed in 1..=seeds {
                    let signal = with_noise(&case.samples(length, seed as u64), share, seed as u64);
                    let found = delay::times(&signal)
                        .and_then(|t| Ok((t.delay, t.mean_period, exponent(&signal, &t)?)));
                    match found {
                        Ok((delay, period, e)) => {
                            let half = (e.high - e.low) / 2.0;
                            ratios.push((e.value - truth) / half);
                            covered += u32::from(e.low <= truth && truth <= e.high);
                            println!(
                                "{:20} {length:6} {share:4} truth {truth:.4} found {:6.3} of it, from {:6.3} to {:6.3}; m {} d {} ({delay}, {period:.0}) noise {:.3} time {:.3} map {:.3} second {:.3}",
                                case.name,
                                e.value / truth,
                                e.low / truth,
                                e.high / truth,
                                e.dimension,
                                e.delay,
                                e.noise,
                                e.over_time / truth,
                                e.of_map / truth,
                                e.second / truth
                            );
                        }
                        Err(error) => {
                            refused += 1;
                            println!(
                                "{:20} {length:6} {share:4} truth {truth:.4} {error}",
                                case.name
                            );
                        }
                    }
                }
            }
        }
    }
    ratios.sort_by(|a: &f64, b| a.abs().total_cmp(&b.abs()));
    println!("covered {covered} of {}, refused {refused}", ratios.len());
    for share in [0.5, 0.9, 0.95, 0.98] {
        println!(
            "{share} of the errors are below {:.2} half widths",
            ratios[(share * ratios.len() as f64) as usize].abs()
        );
    }
}
