//! Continuation on systems whose bifurcations are known.

use integrate::{Integrator, System};
use simulate::bifurcation::{Chunk, Continuation, Direction, LEAD, Walk, WalkSettings};
use std::f64::consts::TAU;

/// x'' + δ x' + x + β x³ = γ cos ω t.
struct Duffing {
    frequency: f64,
}

const DAMPING: f64 = 0.1;
const CUBIC: f64 = 1.0;
const FORCE: f64 = 0.1;

impl System<f64> for Duffing {
    fn dimension(&self) -> usize {
        2
    }
    fn derivative(&mut self, t: f64, y: &[f64], dy: &mut [f64]) {
        let [x, v] = [y[0], y[1]];
        dy[0] = v;
        dy[1] = FORCE * (self.frequency * t).cos() - DAMPING * v - x - CUBIC * x.powi(3);
    }
    fn scales(&self) -> &[f64] {
        &[1.0, 1.0]
    }
}

/// Duffing's oscillator at a list of frequencies, strobed once a period of the force. The point is
/// the amplitude.
struct JumpResonance(Vec<f64>);

impl JumpResonance {
    fn at(&self, value: usize, state: &[f64]) -> (Duffing, Integrator<f64>) {
        let frequency = self.0[value];
        let mut system = Duffing { frequency };
        let integrator = Integrator::new(&mut system, 0.0, state, 1e-9, 1.0);
        (system, integrator)
    }
}

impl Continuation for JumpResonance {
    type State = (Duffing, Integrator<f64>, u32);
    type Point = f64;
    type Error = integrate::Error;

    fn start(&self, value: usize) -> Result<Self::State, Self::Error> {
        let (system, integrator) = self.at(value, &[0.0, 0.0]);
        Ok((system, integrator, 0))
    }

    fn carry(&self, state: Self::State, value: usize) -> Result<Self::State, Self::Error> {
        let (system, integrator) = self.at(value, state.1.state());
        Ok((system, integrator, 0))
    }

    fn revolve(&self, state: &mut Self::State, _: bool) -> Result<f64, Self::Error> {
        let (system, integrator, periods) = state;
        *periods += 1;
        let end = f64::from(*periods) * TAU / system.frequency;
        integrator.advance(system, end, |_, _| ())?;
        let y = integrator.state();
        Ok(y[0].hypot(y[1] / system.frequency))
    }
}

fn walk<C: Continuation>(
    system: &C,
    direction: Direction,
    count: usize,
    chunk: usize,
    settings: WalkSettings,
) -> Vec<Result<Vec<C::Point>, C::Error>> {
    let chunks = Chunk::cut(direction, count, chunk);
    let mut found: Vec<_> = chunks
        .into_iter()
        .flat_map(|chunk| Walk::new(system, chunk, settings))
        .collect();
    found.sort_by_key(|(value, _)| *value);
    assert!(found.iter().map(|(value, _)| *value).eq(0..count));
    found.into_iter().map(|(_, points)| points).collect()
}

/// ω² of harmonic balance at amplitude A, on the right flank of the resonance (Nayfeh and Mook
/// 1979, section 4.1): ((1 + ¾ β A² − ω²)² + δ² ω²) A² = γ².
fn right_flank(amplitude: f64) -> Option<f64> {
    let k = 1.0 + 0.75 * CUBIC * amplitude.powi(2);
    let half = k - 0.5 * DAMPING.powi(2);
    let root = half.powi(2) - k.powi(2) + (FORCE / amplitude).powi(2);
    (root >= 0.0).then(|| (half + root.sqrt()).sqrt())
}

/// Frequencies between which the response has two stable amplitudes: the extrema of the flank.
fn folds() -> [f64; 2] {
    let amplitudes = (1..20_000).map(|i| 1.0 - f64::from(i) * 5e-5);
    let flank: Vec<f64> = amplitudes.filter_map(right_flank).collect();
    let turn = |rising: bool| {
        let three = flank.windows(3);
        let mut turns = three.filter(|w| (w[1] > w[0]) == rising && (w[2] > w[1]) != rising);
        turns.next().unwrap()[1]
    };
    [turn(false), turn(true)]
}

#[test]
fn duffing_jumps_at_the_folds() {
    let step = 0.01;
    let frequencies: Vec<f64> = (0..90).map(|i| 0.75 + step * f64::from(i)).collect();
    let system = JumpResonance(frequencies.clone());
    let settings = WalkSettings {
        transient: 200,
        revolutions: 1,
    };
    let count = frequencies.len();
    let [up, down] = [Direction::Up, Direction::Down].map(|direction| {
        let points = walk(&system, direction, count, count, settings);
        points
            .into_iter()
            .map(|p| p.unwrap()[0])
            .collect::<Vec<_>>()
    });
    let [low, high] = folds();
    let split: Vec<f64> = (0..count)
        .filter(|&i| up[i] > 1.5 * down[i])
        .map(|i| frequencies[i])
        .collect();
    eprintln!(
        "folds {low:.4} {high:.4}, two branches {:?}..{:?}",
        split[0],
        split[split.len() - 1]
    );
    // Harmonic balance leaves out the third harmonic, 1 % here; the walk has its steps.
    assert!((split[0] - low).abs() < 2.0 * step, "{} {low}", split[0]);
    let last = split[split.len() - 1];
    assert!((last - high).abs() < 2.0 * step, "{last} {high}");
    for i in 0..count {
        let frequency = frequencies[i];
        if frequency < low - 2.0 * step || frequency > high + 2.0 * step {
            assert!((up[i] / down[i] - 1.0).abs() < 1e-4, "{frequency}");
        } else if frequency > low + 2.0 * step && frequency < high - 2.0 * step {
            // Both branches obey the balance of the first harmonic.
            for amplitude in [up[i], down[i]] {
                let k = 1.0 + 0.75 * CUBIC * amplitude.powi(2) - frequency.powi(2);
                let force = amplitude * k.hypot(DAMPING * frequency);
                assert!((force / FORCE - 1.0).abs() < 0.1, "{frequency}: {force}");
            }
        }
    }

    // Cut into chunks, both directions still agree with the whole walk where one motion is stable.
    for (direction, whole) in [(Direction::Up, &up), (Direction::Down, &down)] {
        let cut = walk(&system, direction, count, 9, settings);
        for (i, points) in cut.into_iter().enumerate() {
            let (frequency, amplitude) = (frequencies[i], points.unwrap()[0]);
            if frequency < low - 2.0 * step || frequency > high + 2.0 * step {
                assert!((amplitude / whole[i] - 1.0).abs() < 1e-4, "{frequency}");
            }
        }
    }
}

/// x ← r x (1 − x).
struct Logistic(Vec<f64>);

impl Continuation for Logistic {
    type State = (f64, f64);
    type Point = f64;
    type Error = f64;

    fn start(&self, value: usize) -> Result<(f64, f64), f64> {
        self.carry((0.0, 0.3), value)
    }

    fn carry(&self, state: (f64, f64), value: usize) -> Result<(f64, f64), f64> {
        let r = self.0[value];
        if r.is_nan() { Err(r) } else { Ok((r, state.1)) }
    }

    fn revolve(&self, (r, x): &mut (f64, f64), _: bool) -> Result<f64, f64> {
        *x = *r * *x * (1.0 - *x);
        Ok(*x)
    }
}

/// The period of points, 0 where there is none up to 16.
fn period(points: &[f64]) -> usize {
    let repeats = |p: &usize| {
        points
            .iter()
            .zip(&points[*p..])
            .all(|(a, b)| (a - b).abs() < 1e-6)
    };
    (1..=16).find(repeats).unwrap_or(0)
}

#[test]
fn the_logistic_cascade_doubles_where_it_should() {
    let values: Vec<f64> = (0..700).map(|i| 2.9 + 0.001 * f64::from(i)).collect();
    let system = Logistic(values.clone());
    let settings = WalkSettings {
        transient: 3000,
        revolutions: 64,
    };
    let periods: Vec<usize> = walk(&system, Direction::Up, values.len(), 24, settings)
        .iter()
        .map(|points| period(points.as_ref().unwrap()))
        .collect();
    // 3, 1 + √6, and the third from Strogatz, Nonlinear Dynamics and Chaos, section 10.3.
    for (doubled, place) in [(2, 3.0), (4, 1.0 + 6.0_f64.sqrt()), (8, 3.54409)] {
        let first = periods.iter().position(|p| *p == doubled).unwrap();
        let found = values[first];
        assert!((found - place).abs() <= 0.003, "period {doubled}: {found}");
    }
    assert!(periods[690..].contains(&0), "chaos at 3.59");
}

#[test]
fn a_value_that_fails_is_told_and_the_next_starts_afresh() {
    let mut values = vec![2.5; 12];
    values[7] = f64::NAN;
    let settings = WalkSettings {
        transient: 20,
        revolutions: 2,
    };
    let points = walk(&Logistic(values.clone()), Direction::Down, 12, 5, settings);
    for (points, r) in points.iter().zip(&values) {
        assert_eq!(points.is_err(), r.is_nan());
        if let Ok(points) = points {
            assert!(points.iter().all(|x| (x - 0.6).abs() < 1e-6));
        }
    }
}

#[test]
fn chunks_cover_every_value_once_and_cost_their_lead() {
    let settings = WalkSettings {
        transient: 10,
        revolutions: 3,
    };
    let chunks = Chunk::cut(Direction::Up, 10, 4);
    assert_eq!(chunks.iter().map(Chunk::len).collect::<Vec<_>>(), [4, 4, 2]);
    // Three transients more for the fresh start; LEAD more where a chunk has one.
    assert_eq!(chunks[0].revolutions(&settings), 7 * 10 + 4 * 3);
    assert_eq!(
        chunks[1].revolutions(&settings),
        (7 + LEAD as u64) * 10 + 4 * 3
    );
}
