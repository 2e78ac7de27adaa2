//! The systems: laws, and the exponent from two trajectories (Benettin, Galgani and Strelcyn 1976).

pub type State = [f64; 4];

/// A map, or the derivative of a flow.
pub enum Law {
    Map(fn(State) -> State),
    Flow(fn(State) -> State),
}

pub struct Case {
    pub name: &'static str,
    pub law: Law,
    pub start: State,
    pub observed: fn(State) -> f64,
    /// Time between samples: 1 for a map, a twentieth of the mean period of a flow.
    pub interval: f64,
}

/// Samples left out at the start.
const TRANSIENT: usize = 2000;
/// Distance of the two trajectories.
const APART: f64 = 1e-8;
/// Steps of Runge and Kutta in a sample.
const STEPS: usize = 20;

impl Case {
    fn step(&self, y: State) -> State {
        match self.law {
            Law::Map(f) => f(y),
            Law::Flow(f) => {
                (0..STEPS).fold(y, |y, _| runge_kutta(f, y, self.interval / STEPS as f64))
            }
        }
    }

    fn settled(&self, seed: u64) -> State {
        let mut start = self.start;
        start[0] += 1e-3 * seed as f64;
        (0..TRANSIENT).fold(start, |y, _| self.step(y))
    }

    /// `length` samples; another `seed`, another stretch.
    pub fn samples(&self, length: usize, seed: u64) -> Vec<f64> {
        let mut y = self.settled(seed);
        (0..length)
            .map(|_| {
                y = self.step(y);
                (self.observed)(y)
            })
            .collect()
    }

    /// Largest exponent, nats per sample, over so many samples.
    pub fn truth(&self, samples: usize) -> f64 {
        let mut y = self.settled(0);
        let mut other = y;
        other[0] += APART;
        let mut growth = 0.0;
        for _ in 0..samples {
            (y, other) = (self.step(y), self.step(other));
            let apart: State = std::array::from_fn(|i| other[i] - y[i]);
            let length = apart.iter().map(|d| d * d).sum::<f64>().sqrt();
            growth += (length / APART).ln();
            other = std::array::from_fn(|i| y[i] + apart[i] * APART / length);
        }
        growth / samples as f64
    }
}

fn runge_kutta(f: fn(State) -> State, y: State, h: f64) -> State {
    let moved = |k: State, by: f64| std::array::from_fn(|i| y[i] + by * k[i]);
    let k1 = f(y);
    let k2 = f(moved(k1, h / 2.0));
    let k3 = f(moved(k2, h / 2.0));
    let k4 = f(moved(k3, h));
    std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]))
}

/// Samples of a mean period of a flow, and time for which it is followed to find that period.
const PER_PERIOD: f64 = 20.0;
const FINE: f64 = 0.002;
const FINE_STEPS: usize = 200_000;

pub fn map(name: &'static str, f: fn(State) -> State, start: State) -> Case {
    Case {
        name,
        law: Law::Map(f),
        start,
        observed: |y| y[0],
        interval: 1.0,
    }
}

pub fn flow(name: &'static str, f: fn(State) -> State, start: State) -> Case {
    let mut y = (0..FINE_STEPS / 4).fold(start, |y, _| runge_kutta(f, y, FINE));
    let path: Vec<f64> = (0..FINE_STEPS)
        .map(|_| {
            y = runge_kutta(f, y, FINE);
            y[0]
        })
        .collect();
    let mean = path.iter().sum::<f64>() / FINE_STEPS as f64;
    let upward = path.windows(2).filter(|w| w[0] < mean && w[1] >= mean);
    let period = FINE_STEPS as f64 * FINE / upward.count().max(1) as f64;
    Case {
        name,
        law: Law::Flow(f),
        start,
        observed: |y| y[0],
        interval: period / PER_PERIOD,
    }
}

/// Systems on which the method may be developed.
pub fn development() -> Vec<Case> {
    vec![
        map("two-band logistic", |y| logistic(3.6, y), [0.3; 4]),
        map("intermittent logistic", |y| logistic(3.8282, y), [0.3; 4]),
        map("Ikeda", ikeda, [0.1; 4]),
        map("tinkerbell", tinkerbell, [-0.72, -0.64, 0.0, 0.0]),
        map("Lozi", lozi, [0.1; 4]),
        map("delayed logistic", delayed, [0.5, 0.4, 0.0, 0.0]),
        map("coupled logistic", coupled, [0.3, 0.41, 0.0, 0.0]),
        map("coupled map lattice", lattice, [0.3, 0.41, 0.52, 0.17]),
        map(
            "rigid impact oscillator",
            rigid_impacts,
            [0.1, 0.2, 0.0, 0.0],
        ),
        flow("Roessler c = 14", roessler14, [1.0, 1.0, 0.0, 0.0]),
        flow("Sprott B", sprott_b, [0.1, 0.2, -0.1, 0.0]),
        Case {
            observed: |y| y[1],
            ..flow_of("driven pendulum", pendulum, 0.35)
        },
        flow("Halvorsen", halvorsen, [-1.5, -1.5, -1.0, 0.0]),
        flow("Chen", chen, [-3.0, 2.0, 20.0, 0.0]),
    ]
}

/// A flow whose first coordinate runs on, with its interval.
fn flow_of(name: &'static str, f: fn(State) -> State, interval: f64) -> Case {
    Case {
        name,
        law: Law::Flow(f),
        start: [0.1, 0.2, 0.0, 0.0],
        observed: |y| y[0],
        interval,
    }
}

/// Systems on which the intervals are counted, written down before any was run and used for nothing
/// else. Most are in Sprott's "Chaos and Time-Series Analysis" (2003), appendix A.
pub fn held_out() -> Vec<Case> {
    vec![
        // Closed forms: ln 3, ln 1.9, ln((3 + sqrt 5) / 2).
        map(
            "Chebyshev cubic",
            |[x, ..]| [4.0 * x * x * x - 3.0 * x, 0.0, 0.0, 0.0],
            [0.3; 4],
        ),
        map(
            "tent",
            |[x, ..]| [1.9 * x.min(1.0 - x), 0.0, 0.0, 0.0],
            [0.3; 4],
        ),
        Case {
            observed: |y| (std::f64::consts::TAU * y[0]).cos(),
            ..map("Arnold's cat", cat, [0.3, 0.4, 0.0, 0.0])
        },
        map(
            "Ricker",
            |[x, ..]| [x * (2.9 * (1.0 - x)).exp(), 0.0, 0.0, 0.0],
            [0.3; 4],
        ),
        map(
            "Gauss",
            |[x, ..]| [(-6.2 * x * x).exp() - 0.5, 0.0, 0.0, 0.0],
            [0.1; 4],
        ),
        map(
            "sine",
            |[x, ..]| [0.97 * (std::f64::consts::PI * x).sin(), 0.0, 0.0, 0.0],
            [0.3; 4],
        ),
        map("Burgers", burgers, [-0.1, 0.1, 0.0, 0.0]),
        map(
            "Holmes cubic",
            |[x, y, ..]| [y, -0.2 * x + 2.77 * y - y * y * y, 0.0, 0.0],
            [0.1, 0.2, 0.0, 0.0],
        ),
        map(
            "Henon with three coordinates",
            |[x, y, z, _]| [1.76 - y * y - 0.1 * z, x, y, 0.0],
            [0.1, 0.2, 0.0, 0.0],
        ),
        Case {
            observed: |y| y[1],
            ..map("ball on a shaking table", ball, [0.1, 0.2, 0.0, 0.0])
        },
        Case {
            observed: |y| y[0].sin(),
            ..map("standard, K = 7", standard, [0.3, 0.4, 0.0, 0.0])
        },
        map("rigid impacts, two walls", two_walls, [0.1, 0.2, 0.0, 0.0]),
        flow("Rucklidge", rucklidge, [1.0, 0.0, 4.5, 0.0]),
        flow("Thomas", thomas, [0.1, 0.2, -0.3, 0.0]),
        flow("Rabinovich-Fabrikant", rabinovich, [-1.0, 0.0, 0.5, 0.0]),
        flow("Chua", chua, [0.1, 0.0, 0.0, 0.0]),
        flow("Shimizu-Morioka", shimizu, [0.1, 0.2, 0.5, 0.0]),
        flow("Lu", lu, [1.0, 1.0, 20.0, 0.0]),
        flow("Moore-Spiegel", moore, [0.1, 0.2, 0.0, 0.0]),
        flow("driven van der Pol", van_der_pol, [-1.9, 0.0, 0.0, 0.0]),
        flow("Ueda", ueda, [2.5, 0.0, 0.0, 0.0]),
        flow(
            "simplest jerk",
            |[x, v, a, _]| [v, a, -2.017 * a + v * v - x, 0.0],
            [0.0, 0.0, 1.0, 0.0],
        ),
        flow("Lorenz 1984", lorenz84, [1.0, 0.5, 0.5, 0.0]),
        flow(
            "Roessler, hyperchaotic",
            hyperchaos,
            [-20.0, 0.0, 0.0, 15.0],
        ),
        flow("Rikitake", rikitake, [1.0, 0.5, 0.6, 0.0]),
        flow(
            "Sprott D",
            |[x, y, z, _]| [-y, x + z, x * z + 3.0 * y * y, 0.0],
            [0.1, 0.2, 0.0, 0.0],
        ),
        flow(
            "Windmi",
            |[x, v, a, _]| [v, a, -0.7 * a - v + 2.5 - x.exp(), 0.0],
            [0.0, 0.8, 0.0, 0.0],
        ),
        flow(
            "Arneodo",
            |[x, v, a, _]| [v, a, 5.5 * x - 3.5 * v - a - x * x * x, 0.0],
            [0.2, 0.2, -0.5, 0.0],
        ),
    ]
}

fn logistic(r: f64, [x, ..]: State) -> State {
    [r * x * (1.0 - x), 0.0, 0.0, 0.0]
}

fn ikeda([x, y, ..]: State) -> State {
    let t = 0.4 - 6.0 / (1.0 + x * x + y * y);
    let (sin, cos) = t.sin_cos();
    [
        1.0 + 0.9 * (x * cos - y * sin),
        0.9 * (x * sin + y * cos),
        0.0,
        0.0,
    ]
}

fn tinkerbell([x, y, ..]: State) -> State {
    [
        x * x - y * y + 0.9 * x - 0.6013 * y,
        2.0 * x * y + 2.0 * x + 0.5 * y,
        0.0,
        0.0,
    ]
}

fn lozi([x, y, ..]: State) -> State {
    [1.0 - 1.7 * x.abs() + y, 0.5 * x, 0.0, 0.0]
}

fn delayed([x, y, ..]: State) -> State {
    [2.27 * x * (1.0 - y), x, 0.0, 0.0]
}

fn coupled([x, y, ..]: State) -> State {
    let f = |x: f64| 3.9 * x * (1.0 - x);
    [
        0.95 * f(x) + 0.05 * f(y),
        0.95 * f(y) + 0.05 * f(x),
        0.0,
        0.0,
    ]
}

/// Four logistic maps in a ring (Kaneko 1984).
fn lattice(y: State) -> State {
    let f = y.map(|x| 1.0 - 1.9 * x * x);
    std::array::from_fn(|i| 0.7 * f[i] + 0.15 * (f[(i + 1) % 4] + f[(i + 3) % 4]))
}

fn roessler14([x, y, z, _]: State) -> State {
    [-y - z, x + 0.1 * y, 0.1 + z * (x - 14.0), 0.0]
}

fn sprott_b([x, y, z, _]: State) -> State {
    [y * z, x - y, 1.0 - x * y, 0.0]
}

/// Angle, angular velocity, phase of the drive (Baker and Gollub 1996, q = 2, g = 1.5).
fn pendulum([a, v, p, _]: State) -> State {
    [v, -v / 2.0 - a.sin() + 1.5 * p.cos(), 2.0 / 3.0, 0.0]
}

fn halvorsen([x, y, z, _]: State) -> State {
    let f = |a: f64, b: f64, c: f64| -1.4 * a - 4.0 * b - 4.0 * c - b * b;
    [f(x, y, z), f(y, z, x), f(z, x, y), 0.0]
}

fn chen([x, y, z, _]: State) -> State {
    [
        35.0 * (y - x),
        -7.0 * x - x * z + 28.0 * y,
        x * y - 3.0 * z,
        0.0,
    ]
}

/// `x'' + 0.1 x' + x = cos 2.8 t`, thrown back with 0.8 of its velocity at x = 0 (Shaw and Holmes
/// 1983), seen once a period of the drive.
fn rigid_impacts([x, v, ..]: State) -> State {
    impacts([x, v], 2.8, 0.1, |x| x < 0.0)
}

/// The same between walls at -0.4 and 0.4, damping 0.02, drive 1.3.
fn two_walls([x, v, ..]: State) -> State {
    impacts([x, v], 1.3, 0.02, |x| x.abs() > 0.4)
}

fn impacts(mut y: [f64; 2], drive: f64, damping: f64, outside: fn(f64) -> bool) -> State {
    const SUBSTEPS: usize = 400;
    const HALVINGS: usize = 45;
    let h = std::f64::consts::TAU / drive / SUBSTEPS as f64;
    let step = |t: f64, y: [f64; 2], h: f64| {
        let f = |t: f64, [x, v]: [f64; 2]| [v, -damping * v - x + (drive * t).cos()];
        let moved = |k: [f64; 2], by: f64| [y[0] + by * k[0], y[1] + by * k[1]];
        let k1 = f(t, y);
        let k2 = f(t + h / 2.0, moved(k1, h / 2.0));
        let k3 = f(t + h / 2.0, moved(k2, h / 2.0));
        let k4 = f(t + h, moved(k3, h));
        [0, 1].map(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]))
    };
    for i in 0..SUBSTEPS {
        let t = i as f64 * h;
        let next = step(t, y, h);
        y = if outside(next[0]) && !outside(y[0]) {
            let (mut low, mut high) = (0.0, h);
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                if outside(step(t, y, middle)[0]) {
                    high = middle;
                } else {
                    low = middle;
                }
            }
            let [x, v] = step(t, y, low);
            step(t + low, [x, -0.8 * v], h - low)
        } else {
            next
        };
    }
    [y[0], y[1], 0.0, 0.0]
}

fn cat([x, y, ..]: State) -> State {
    [
        (2.0 * x + y).rem_euclid(1.0),
        (x + y).rem_euclid(1.0),
        0.0,
        0.0,
    ]
}

fn burgers([x, y, ..]: State) -> State {
    [0.75 * x - y * y, (1.75 + x) * y, 0.0, 0.0]
}

/// Phase and velocity after each bounce (Holmes 1982).
fn ball([p, v, ..]: State) -> State {
    let phase = p + v;
    [phase, 0.6 * v - 10.0 * phase.cos(), 0.0, 0.0]
}

fn standard([x, p, ..]: State) -> State {
    let p = p + 7.0 * x.sin();
    [x + p, p, 0.0, 0.0].map(|y| y.rem_euclid(std::f64::consts::TAU))
}

fn rucklidge([x, y, z, _]: State) -> State {
    [-2.0 * x + 6.7 * y - y * z, x, -z + y * y, 0.0]
}

fn thomas([x, y, z, _]: State) -> State {
    [
        y.sin() - 0.18 * x,
        z.sin() - 0.18 * y,
        x.sin() - 0.18 * z,
        0.0,
    ]
}

fn rabinovich([x, y, z, _]: State) -> State {
    [
        y * (z - 1.0 + x * x) + 0.87 * x,
        x * (3.0 * z + 1.0 - x * x) + 0.87 * y,
        -2.0 * z * (1.1 + x * y),
        0.0,
    ]
}

fn chua([x, y, z, _]: State) -> State {
    let diode = -5.0 / 7.0 * x - 1.5 / 7.0 * ((x + 1.0).abs() - (x - 1.0).abs());
    [9.0 * (y - x - diode), x - y + z, -100.0 / 7.0 * y, 0.0]
}

fn shimizu([x, y, z, _]: State) -> State {
    [y, x - 0.75 * y - x * z, -0.45 * z + x * x, 0.0]
}

fn lu([x, y, z, _]: State) -> State {
    [36.0 * (y - x), -x * z + 20.0 * y, x * y - 3.0 * z, 0.0]
}

fn moore([x, v, a, _]: State) -> State {
    [v, a, -a - (6.0 - 20.0 + 20.0 * x * x) * v - 6.0 * x, 0.0]
}

fn van_der_pol([x, v, p, _]: State) -> State {
    [v, 3.0 * (1.0 - x * x) * v - x + 5.0 * p.sin(), 1.788, 0.0]
}

fn ueda([x, v, p, _]: State) -> State {
    [v, -0.05 * v - x * x * x + 7.5 * p.cos(), 1.0, 0.0]
}

fn lorenz84([x, y, z, _]: State) -> State {
    [
        -y * y - z * z - 0.25 * x + 2.0,
        x * y - 4.0 * x * z - y + 1.0,
        4.0 * x * y + x * z - z,
        0.0,
    ]
}

fn hyperchaos([x, y, z, w]: State) -> State {
    [-y - z, x + 0.25 * y + w, 3.0 + x * z, -0.5 * z + 0.05 * w]
}

fn rikitake([x, y, z, _]: State) -> State {
    [-x + z * y, -y + (z - 5.0) * x, 1.0 - x * y, 0.0]
}
