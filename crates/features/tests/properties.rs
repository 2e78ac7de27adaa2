//! What must hold for the features of any window.

use features::{CrankAngles, Definition, Reason, Remedy, Window, definitions, features};
use proptest::prelude::*;
use signal::channel::Channel;
use signal::decimate::Decimator;
use std::f64::consts::TAU;

fn channel(name: &str, unit: &str, samples: Vec<f32>) -> Channel {
    Channel {
        name: name.to_owned(),
        unit: unit.to_owned(),
        samples,
    }
}

fn acceleration(samples: Vec<f32>) -> [Channel; 1] {
    [channel("crosshead_acceleration_m_s2", "m/s^2", samples)]
}

fn defined(channels: &[Channel]) -> Vec<Definition> {
    definitions(channels.iter().map(|c| (c.name.as_str(), c.unit.as_str())))
}

/// `per_revolution` samples per revolution at 10 kHz, without a crank angle.
fn window(channels: &[Channel], per_revolution: f64) -> Window<'_> {
    Window {
        sample_rate: 10_000.0,
        speed_rpm: Some(60.0 * 10_000.0 / per_revolution),
        crank_angle: None,
        channels,
        chambers: &[],
    }
}

fn from_top(angles: &[f32]) -> CrankAngles<'_> {
    CrankAngles {
        angles,
        from_top_dead_centre: true,
    }
}

/// A revolution with some orders and one sharp knock.
fn knocking(amplitudes: [f64; 4], angle: f64) -> f64 {
    let orders = amplitudes.iter().zip(1..);
    let smooth: f64 = orders
        .map(|(a, k)| a * (f64::from(k) * angle + a).cos())
        .sum();
    smooth + 8.0 * (-200.0 * (1.0 - (angle - 2.0).cos())).exp()
}

fn wave() -> impl Strategy<Value = [f64; 4]> {
    prop::array::uniform4(0.1..5.0)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// The unit says how a feature grows with the signal.
    #[test]
    fn features_scale_as_their_unit_says(
        amplitudes in wave(),
        noise in prop::collection::vec(-1.0..1.0, 1300),
        power in -20i32..20,
    ) {
        let scale = 2.0f64.powi(power);
        let x = |scale: f64| -> Vec<f32> {
            let angle = |i: usize| TAU * i as f64 / 400.0;
            let values = noise.iter().enumerate().map(|(i, n)| n + knocking(amplitudes, angle(i)));
            values.map(|v| (v as f32) * scale as f32).collect()
        };
        let angles: Vec<f32> = (0..1300).map(|i| (TAU * f64::from(i % 400) / 400.0) as f32).collect();
        let row = |channels: &[Channel]| {
            features(&Window { crank_angle: Some(from_top(&angles)), ..window(channels, 400.0) })
        };
        let one = acceleration(x(1.0));
        let scaled = acceleration(x(scale));
        for ((definition, a), b) in defined(&one).iter().zip(row(&one)).zip(row(&scaled)) {
            let factor = match definition.unit.as_str() {
                "1" | "Hz" => 1.0,
                "m/s^2" | "m/s" | "m" => scale,
                "m^2/s^4" | "m^2/s^3" => scale * scale,
                unit => panic!("{unit}"),
            };
            let (a, b) = (a.unwrap(), b.unwrap());
            prop_assert!((a * factor - b).abs() <= 1e-9 * b.abs(), "{}: {a} {b}", definition.name);
        }
    }

    /// A periodic motion gives the same features whenever the window starts, as long as it holds
    /// the same revolutions of it.
    #[test]
    fn features_do_not_depend_on_the_start_of_a_periodic_motion(
        amplitudes in wave(),
        start in 0usize..1024,
    ) {
        let x = |start: usize| -> (Vec<f32>, Vec<f32>) {
            let angle = |i: usize| TAU * ((i + start) % 1024) as f64 / 1024.0;
            (0..4096).map(|i| (knocking(amplitudes, angle(i)) as f32, angle(i) as f32)).unzip()
        };
        let row = |start: usize| {
            let (samples, angle) = x(start);
            let channels = acceleration(samples);
            let window = Window { crank_angle: Some(from_top(&angle)), ..window(&channels, 1024.0) };
            (features(&window), defined(&channels))
        };
        let ((a, definitions), (b, _)) = (row(0), row(start));
        let rms = a[1].clone().unwrap();
        for ((definition, a), b) in definitions.iter().zip(a).zip(b) {
            // Nothing is left of a motion that repeats itself, and in which band its impacts
            // stand out most may hang on the ends of the record.
            let others = ["residual_kurtosis", "envelope"];
            if others.iter().any(|other| definition.name.contains(other)) {
                continue;
            }
            let (a, b) = (a.unwrap(), b.unwrap());
            // Sums of all samples agree to rounding. At the ends of the record resampling sees
            // its reflection, which the start of the window moves.
            let tolerance = if definition.name.contains(".spectral") {
                1e-6 * a
            } else if definition.name.contains(".portrait_area") {
                1e-4 * a
            } else if ["m/s", "m"].contains(&definition.unit.as_str()) {
                1e-3 * a
            } else {
                1e-3 * rms
            };
            prop_assert!((a - b).abs() <= tolerance, "{}: {a} {b}", definition.name);
        }
    }

    /// Bands add up to the variance, which mean and RMS tell too.
    #[test]
    fn bands_add_up_to_the_variance(x in prop::collection::vec(-100.0f32..100.0, 2..600)) {
        let channels = acceleration(x);
        let named = |part: &str| -> f64 {
            let row = features(&window(&channels, 400.0));
            let columns = defined(&channels);
            let found = columns.iter().zip(row).filter(|(d, _)| d.name.contains(part));
            found.map(|(_, value)| value.unwrap()).sum()
        };
        let variance = named(".rms_m_s2").powi(2) - named(".mean_m_s2").powi(2);
        prop_assert!((named(".band_") - variance).abs() <= 1e-9 * variance.max(1.0));
    }

    /// Whatever the samples and angles: a value per column, finite, or a reason.
    #[test]
    fn rows_are_whole_and_finite(
        x in prop::collection::vec(prop_oneof![
            20 => -1e3f32..1e3,
            1 => Just(f32::NAN),
            1 => Just(f32::MAX),
            1 => Just(f32::MIN_POSITIVE),
        ], 0..300),
        plain in prop::collection::vec(-1e3f32..1e3, 0..300),
        angle in prop::option::of(prop::collection::vec(0.0f32..7.0, 0..300)),
        per_revolution in prop_oneof![-10.0..500.0, Just(0.0), Just(f64::NAN)],
    ) {
        let channels = [
            channel("crosshead_acceleration_m_s2", "m/s^2", x),
            channel("crank_angle_rad", "rad", vec![]),
            channel("cylinder_pressure_pa", "Pa", plain),
        ];
        let window = Window { crank_angle: angle.as_deref().map(from_top), ..window(&channels, per_revolution) };
        let row = features(&window);
        prop_assert_eq!(row.len(), defined(&channels).len());
        for value in row.into_iter().flatten() {
            prop_assert!(value.is_finite());
        }
    }
}

#[test]
fn features_without_a_value_say_why() {
    let reason = |samples: Vec<f32>, per_revolution: f64, part: &str| {
        let channels = acceleration(samples);
        let row = features(&window(&channels, per_revolution));
        let columns = defined(&channels);
        let mut found = columns
            .iter()
            .zip(row)
            .filter(|(d, _)| d.name.contains(part));
        found.next().unwrap().1.unwrap_err()
    };
    let ramp: Vec<f32> = (0..400).map(|i| i as f32).collect();
    let few = signal::Error::TooFewSamples { needed: 1, got: 0 };
    assert_eq!(reason(vec![], 100.0, "mean"), few.into());
    let nan = signal::Error::NotFinite { index: 1 };
    assert_eq!(reason(vec![1.0, f32::NAN], 100.0, "order_01"), nan.into());
    assert_eq!(reason(vec![2.5; 400], 100.0, "kurtosis"), Reason::Constant);
    assert_eq!(
        reason(vec![2.5; 400], 100.0, "portrait_scatter"),
        Reason::Constant
    );
    assert_eq!(reason(vec![0.0; 400], 100.0, "crest"), Reason::Constant);
    assert!(matches!(
        reason(ramp.clone(), 500.0, "order_01"),
        Reason::Signal(signal::Error::TooFewRevolutions { needed: 1, .. })
    ));
    assert!(matches!(
        reason(ramp.clone(), 300.0, "portrait_scatter"),
        Reason::Signal(signal::Error::TooFewRevolutions { needed: 2, .. })
    ));
    for name in ["residual_rms", "cepstrum_revolution"] {
        assert!(matches!(
            reason(ramp.clone(), 300.0, name),
            Reason::Signal(signal::Error::TooFewRevolutions { needed: 2, .. })
        ));
    }
    // Less than two samples per 40 orders; too few samples for a kurtogram.
    assert!(matches!(
        reason(ramp.clone(), 70.5, "envelope_order_1"),
        Reason::Signal(signal::Error::OutOfRange { .. })
    ));
    assert!(matches!(
        reason(ramp[..120].to_vec(), 100.0, "envelope_centre"),
        Reason::Signal(signal::Error::TooFewSamples { needed: 128, .. })
    ));
    assert_eq!(reason(vec![2.5; 400], 100.0, "sector_01"), Reason::Constant);
    let repeating: Vec<f32> = (0..4096)
        .map(|i| (TAU * f64::from(i % 1024) / 1024.0).sin() as f32)
        .collect();
    assert_eq!(
        reason(repeating, 1024.0, "residual_kurtosis"),
        signal::Error::NoFluctuation.into()
    );
    let high = Reason::OrderTooHigh {
        order: 17,
        highest: 16,
    };
    assert_eq!(reason(ramp.clone(), 40.5, "order_17"), high);

    let slow = acceleration(ramp);
    let mut window = window(&slow, 100.0);
    window.sample_rate = 4000.0;
    window.speed_rpm = Some(2400.0);
    let last_band = features(&window)[18].clone();
    let low_hz = 2560.0;
    let nyquist_hz = 2000.0;
    assert_eq!(
        last_band,
        Err(Reason::BandAboveNyquist { low_hz, nyquist_hz })
    );
}

/// Knocks at 480 rpm that ring at 1.9 and 7 kHz over two slow orders, with noise, at 20 kHz.
fn ringing() -> Vec<f64> {
    let mut state = 7_u32;
    let mut noise = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state) / f64::from(u32::MAX) - 0.5
    };
    let wave = |i: usize| {
        let since = (i % 2500) as f64 / 20_000.0;
        let slow = 20.0 * (TAU * 8.0 * since).cos() + 6.0 * (TAU * 16.0 * since + 0.7).cos();
        let ring = |hz: f64, decay: f64| (-since / decay).exp() * (TAU * hz * since).sin();
        slow + 30.0 * ring(1900.0, 2e-3) + 20.0 * ring(7000.0, 1e-3)
    };
    (0..50_000).map(|i| wave(i) + 2.0 * noise()).collect()
}

/// The shape of the spectrum of one motion does not hang on the rate at which it was sampled, whether
/// the speed is known or not.
#[test]
fn spectral_shape_does_not_hang_on_the_sample_rate() {
    let fine = ringing();
    let shape = |x: &[f64], sample_rate: f64, speed_rpm: Option<f64>| -> Vec<f64> {
        let channels = acceleration(x.iter().map(|x| *x as f32).collect());
        let window = Window {
            sample_rate,
            speed_rpm,
            crank_angle: None,
            channels: &channels,
            chambers: &[],
        };
        let row = defined(&channels).into_iter().zip(features(&window));
        let shape = row.filter(|(d, _)| d.feature.starts_with("spectral_"));
        shape.map(|(_, value)| value.unwrap()).collect()
    };
    let decimator = Decimator::new(2).unwrap();
    let half = decimator.apply(&fine);
    // The filter sees so many samples to either side: both recordings begin and end together.
    let lead = decimator.half_length();
    let fine = &fine[lead..fine.len() - lead];
    for speed_rpm in [Some(480.0), None] {
        let at_20_khz = shape(fine, 20_000.0, speed_rpm);
        let at_10_khz = shape(&half, 10_000.0, speed_rpm);
        assert_eq!(at_20_khz.len(), 3);
        for (a, b) in at_20_khz.iter().zip(&at_10_khz) {
            assert!((b / a - 1.0).abs() < 0.01, "{at_20_khz:?} {at_10_khz:?}");
        }
    }
}

/// A sector of the crank angle is one from top dead centre on: where that is not known, none is told.
#[test]
fn sectors_need_top_dead_centre() {
    let channels = acceleration(ringing().into_iter().map(|x| x as f32).collect());
    let angles: Vec<f32> = (0..50_000)
        .map(|i| (TAU * f64::from(i % 2500) / 2500.0) as f32)
        .collect();
    let sector = |crank_angle: Option<CrankAngles>| {
        let window = Window {
            crank_angle,
            ..window(&channels, 2500.0)
        };
        let row = defined(&channels).into_iter().zip(features(&window));
        let mut found = row.filter(|(d, _)| d.feature == "sector_01_rms");
        found.next().unwrap().1
    };
    let known = sector(Some(from_top(&angles)));
    assert!(known.unwrap() > 1.0);
    let unknown = CrankAngles {
        from_top_dead_centre: false,
        ..from_top(&angles)
    };
    assert_eq!(sector(Some(unknown)), Err(Reason::NoTopDeadCentre));
    // The speed alone does not tell it either: the first sample stands anywhere.
    assert_eq!(sector(None), Err(Reason::NoTopDeadCentre));
    assert_eq!(
        Reason::NoTopDeadCentre.remedy(),
        Some(Remedy::TopDeadCentre)
    );
}

/// The transforms keep state per thread; the bits must not show it.
#[test]
fn rows_do_not_depend_on_what_the_thread_did_before() {
    let samples = |n: usize| -> Vec<f32> {
        (0..n)
            .map(|i| (i as f32 * 0.7).sin() + (i % 7) as f32)
            .collect()
    };
    let row = move |n: usize| {
        let channels = acceleration(samples(n));
        features(&window(&channels, 397.0))
    };
    let fresh = std::thread::spawn(move || row(4608)).join().unwrap();
    for n in (500..5000).step_by(36) {
        row(n);
    }
    assert_eq!(row(4608), fresh);
}

/// What the columns of a row hold, by name.
fn motion_of(channels: &[Channel], per_revolution: f64) -> Vec<(String, Option<features::Cell>)> {
    let names = channels.iter().map(|c| (c.name.as_str(), c.unit.as_str()));
    let columns = features::columns(names, true);
    let row = features::row(&window(channels, per_revolution), true);
    assert_eq!(columns.len(), row.len());
    let named = columns.into_iter().map(|(d, _)| d.name).zip(row);
    named.filter(|(name, _)| !name.contains('.')).collect()
}

fn cell(row: &[(String, Option<features::Cell>)], name: &str) -> Option<features::Cell> {
    row.iter().find(|(n, _)| n == name).unwrap().1.clone()
}

fn text(text: &str) -> Option<features::Cell> {
    Some(features::Cell::Text(text.to_owned()))
}

#[test]
fn a_knocking_wave_with_noise_is_periodic() {
    let mut state = 1_u32;
    let mut noise = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state) / f64::from(u32::MAX) - 0.5
    };
    let angle = |i: usize| TAU * (i % 400) as f64 / 400.0;
    let samples = (0..40 * 400).map(|i| knocking([3.0, 1.0, 0.5, 0.2], angle(i)) + 0.3 * noise());
    let row = motion_of(&acceleration(samples.map(|x| x as f32).collect()), 400.0);
    assert_eq!(cell(&row, "regime"), text("periodic"));
    assert_eq!(cell(&row, "lyapunov_per_s"), None);
    let reason = "the motion is periodic, not chaotic";
    assert_eq!(cell(&row, "lyapunov_reason"), text(reason));
    let Some(features::Cell::Text(missing)) = cell(&row, "missing") else {
        panic!("{row:?}")
    };
    assert!(
        missing.contains(&format!("lyapunov_low_per_s: {reason}; ")),
        "{missing}"
    );
}

#[test]
fn an_undecided_motion_is_not_called_not_chaotic() {
    let reason = Reason::Undecided.to_string();
    assert_eq!(reason, "the kind of motion is undecided");
}

#[test]
fn a_rounded_peak_or_a_square_wave_is_not_cut_off() {
    let turn = |i: i32| TAU * f64::from(i) / 4000.0;
    let rounded = (0..80_000).map(|i| ((300.0 * turn(i).sin() / 0.061).round() * 0.061) as f32);
    let square = (0..8000).map(|i| if i % 100 < 50 { 1.0 } else { -1.0 });
    for (samples, per_revolution) in [(rounded.collect(), 4000.0), (square.collect(), 100.0)] {
        let row = motion_of(&acceleration(samples), per_revolution);
        if let Some(features::Cell::Text(reason)) = cell(&row, "lyapunov_reason") {
            assert!(!reason.contains("cut off"), "{reason}");
        }
    }
}

#[test]
fn bad_signals_have_no_motion_and_say_why() {
    let ramp = |n: usize| (0..n).map(|i| (i % 37) as f32).collect::<Vec<f32>>();
    let mut gap = ramp(8000);
    gap[3000] = f32::NAN;
    let clipped = (0..8000).map(|i| (2.0 * (i as f32 * 0.1).sin()).clamp(-1.0, 1.0));
    for (samples, why) in [
        (vec![2.5; 8000], "the signal is constant"),
        (gap, "sample 3000 is NaN"),
        (clipped.collect(), "the range of the sensor cut off"),
        (
            ramp(99),
            "the signal has 99 samples; at least 100 are needed",
        ),
        (ramp(3000), "revolutions"),
    ] {
        let row = motion_of(&acceleration(samples), 400.0);
        assert_eq!(cell(&row, "regime"), None);
        let Some(features::Cell::Text(reason)) = cell(&row, "lyapunov_reason") else {
            panic!("{row:?}")
        };
        assert!(reason.contains(why), "{reason}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Whatever the samples: finite numbers or nothing, and no panic.
    #[test]
    fn motions_are_whole_and_finite(
        x in prop::collection::vec(prop_oneof![
            30 => -1e3f32..1e3,
            10 => Just(0.0f32),
            1 => Just(1e30f32),
        ], 0..1200),
        repeats in 1usize..5,
        per_revolution in prop_oneof![10.0..100.0, Just(f64::NAN)],
    ) {
        let channels = acceleration(x.repeat(repeats));
        for (name, cell) in motion_of(&channels, per_revolution) {
            if let Some(features::Cell::Number(number)) = cell {
                prop_assert!(number.is_finite(), "{name}");
            }
        }
    }
}
