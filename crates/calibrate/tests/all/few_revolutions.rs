//! The noise of pressures of few revolutions does not depend on where the zero of the crank angle is, nor on a sample more or less.

use calibrate::{Channel, Observation, Run};
use std::f64::consts::TAU;

const COLUMN: &str = "cylinder_pressure_pa";
const PER_REVOLUTION: usize = 720;
/// Orders whose noise is compared.
const ORDERS: usize = 60;
/// By what factor the estimate may change: white noise is read from as many bins, resampled a little differently.
const MOST: f64 = 1.1;

/// White noise: uniform from −1/2 to 1/2, by a linear congruential generator (Knuth's MMIX).
fn white(state: &mut u64) -> f64 {
    *state = state
        .wrapping_mul(6364136223846793005)
        .wrapping_add(1442695040888963407);
    (*state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
}

/// So many samples of a compressor's pressure with noise of 1 kPa, the zero of whose crank angle is moved by `zero`, deg.
fn run(samples: usize, zero: f64) -> Run {
    let mut state = 7;
    let step = TAU / PER_REVOLUTION as f64;
    let pressure = |i: usize| {
        let angle = i as f64 * step;
        let closed = 105e3 * (1.1 / (0.1 + 0.5 * (1.0 - angle.cos()))).powf(1.3);
        closed.clamp(105e3, 393e3)
    };
    let angle = |i: usize| (i as f64 * step + zero.to_radians()).rem_euclid(TAU);
    Run {
        id: "a".into(),
        settings: Vec::new(),
        speed_rpm: 500.0,
        sample_rate: 6000.0,
        is_timed: false,
        crank_angle: Some((0..samples).map(angle).collect()),
        channels: vec![Channel {
            column: COLUMN.into(),
            samples: (0..samples)
                .map(|i| pressure(i) + 1e3 * 12_f64.sqrt() * white(&mut state))
                .collect(),
        }],
    }
}

/// Mean variance of the lines, over that of white noise of 1 kPa in the whole revolutions of so many samples.
fn noise(samples: usize, zero: f64) -> f64 {
    let seen = Observation::from_run(&run(samples, zero), &[COLUMN.into()]).unwrap();
    let lines = &seen.channels[0].lines;
    let mean = lines.variance[1..=ORDERS].iter().sum::<f64>() / ORDERS as f64;
    mean / (4.0 * 1e6 / (lines.revolutions * PER_REVOLUTION) as f64)
}

#[test]
fn the_noise_stays_where_the_zero_moves() {
    for revolutions in [1, 2, 3, 4, 6] {
        let samples = revolutions * PER_REVOLUTION;
        let still = noise(samples, 0.0);
        assert!((0.5..2.0).contains(&still), "{revolutions}: {still}");
        for quarter in -4..=4 {
            let moved = noise(samples, 0.25 * f64::from(quarter)) / still;
            assert!(
                (1.0 / MOST..MOST).contains(&moved),
                "{revolutions} revolutions, {quarter} quarters of a degree: {moved}"
            );
        }
    }
}

/// Three revolutions less a few samples are no three whole ones, and have a noise all the same.
#[test]
fn the_noise_stays_where_samples_are_missing() {
    for revolutions in [2, 3, 4] {
        for missing in 0..12 {
            let found = noise(revolutions * PER_REVOLUTION - missing, 0.0);
            assert!(
                (0.5..2.0).contains(&found),
                "{revolutions}, {missing}: {found}"
            );
        }
    }
}
