//! Range, resolution and noise of the recorder, on series with known values.

use scalar::random::{Purpose, stream};
use signal::channel::Channel;
use simulate::sensor::{Chain, Noise, NoiseLevel, Range, Sensor};
use simulate::{Measured, Record, cut_off, measure};
use std::f64::consts::TAU;

const ACCELERATION: Measured = Measured::CrossheadAcceleration { throw: 0 };

/// What the recorder makes of `series`.
fn read(measured: Measured, chain: Chain, series: Vec<f64>) -> Vec<f32> {
    let record = Record {
        sample_rate: 1e4,
        start: 0.0,
        series: vec![series],
        trace: None,
        transient: 0,
        settled: false,
        energy_residual: None,
        mean_speed: 50.0,
        penetrations: Vec::new(),
        work: Default::default(),
    };
    let sensor = Sensor { measured, chain };
    let mut random = stream(1, 2, Purpose::Noise);
    measure(&record, &[sensor], &[""], &mut random)
        .remove(0)
        .samples
}

#[test]
fn range_and_bits_limit_and_round() {
    let chain = Chain {
        range: Some(Range::Fixed(100.0)),
        bits: Some(8),
        ..Chain::default()
    };
    let step = 200.0 / 256.0;
    assert_eq!(
        read(ACCELERATION, chain, vec![1e3, -1e3, 0.3, 0.4]),
        [100.0 - step, -100.0, 0.0, step]
    );
}

#[test]
fn a_range_that_cuts_off_is_told_with_its_share() {
    let sensor = |range, bits| Sensor {
        measured: ACCELERATION,
        chain: Chain {
            range,
            bits,
            ..Chain::default()
        },
    };
    let cut = |range, bits| {
        let chain = sensor(range, bits).chain;
        let channel = Channel {
            name: "a_m_s2".into(),
            unit: "m/s^2".into(),
            samples: read(ACCELERATION, chain, vec![150.0, -120.0, 90.0, 0.0, 30.0]),
        };
        cut_off(&[sensor(range, bits)], &[channel])
    };
    for bits in [None, Some(8), Some(16), Some(24)] {
        let found = cut(Some(Range::Fixed(100.0)), bits);
        assert_eq!(found.len(), 1, "{bits:?}");
        assert_eq!(found[0].share, 0.4, "{bits:?}");
        assert!(cut(Some(Range::Fixed(200.0)), bits).is_empty());
        assert!(cut(Some(Range::Auto), bits).is_empty());
    }
    assert!(cut(None, None).is_empty());
    // An encoder turns round.
    let chain = Chain {
        range: Some(Range::Fixed(TAU)),
        bits: Some(16),
        ..Chain::default()
    };
    let angles = Channel {
        name: "crank_angle_rad".into(),
        unit: "rad".into(),
        samples: vec![0.0, 3.0, TAU as f32],
    };
    let encoder = Sensor {
        measured: Measured::CrankAngle,
        chain,
    };
    assert!(cut_off(&[encoder], &[angles]).is_empty());
    let message = cut(Some(Range::Fixed(100.0)), Some(16))[0].to_string();
    let expected = "a_m_s2: 40.00 % of the samples are cut off at the sensor's range of 100 m/s^2: state a wider range";
    assert_eq!(message, expected);
}

#[test]
fn an_encoder_never_reads_a_whole_revolution() {
    let encoder = Chain {
        bits: Some(16),
        ..Chain::default()
    };
    assert_eq!(
        read(Measured::CrankAngle, encoder, vec![TAU * 0.999_999_9]),
        [0.0]
    );
    let plain = read(
        Measured::CrankAngle,
        Chain::default(),
        vec![TAU - 1e-12, 6.0],
    );
    assert_eq!(plain, [0.0, 6.0]);
}

#[test]
fn noise_has_the_level_asked_for() {
    let clean: Vec<f64> = (0..40_000).map(|i| (f64::from(i) * 0.1).sin()).collect();
    let chain = Chain {
        noise: Some(Noise {
            level: NoiseLevel::OfSignal(0.03),
            pink_share: 0.3,
        }),
        ..Chain::default()
    };
    let noisy = read(ACCELERATION, chain, clean.clone());
    let noise = noisy.iter().zip(&clean).map(|(a, b)| f64::from(*a) - b);
    let square = noise.map(|x| x * x).sum::<f64>() / clean.len() as f64;
    let expected = 0.03 / 2.0_f64.sqrt();
    assert!((square.sqrt() / expected - 1.0).abs() < 0.05);
}
