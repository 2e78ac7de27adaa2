//! What must hold for any signal.

use proptest::prelude::*;
use signal::amplitude_spectrum::{amplitude_spectrum, band_mean_squares};
use signal::angle_resampling::AngleGrid;
use signal::biquad::Filter;
use signal::cepstrum::real_cepstrum;
use signal::crank_angle::{CrankAngle, unwrap};
use signal::crank_waterfall::crank_waterfall;
use signal::decimate::Decimator;
use signal::envelope::{Band, envelope};
use signal::kurtogram::kurtogram;
use signal::noise::pink_noise;
use signal::order_spectrum::order_spectrum;
use signal::spectral_shape::spectral_shape;
use signal::synchronous_average::SynchronousAverage;
use signal::welch::welch;
use signal::windows::Window;
use std::f64::consts::{PI, TAU};

fn samples(length: std::ops::Range<usize>) -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(-1e3..1e3, length)
}

fn any_window() -> impl Strategy<Value = Window> {
    prop_oneof![
        Just(Window::Rectangular),
        Just(Window::Hann),
        Just(Window::FlatTop)
    ]
}

fn variance(x: &[f64]) -> f64 {
    let mean = x.iter().sum::<f64>() / x.len() as f64;
    x.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / x.len() as f64
}

proptest! {
    /// Parseval: bands that leave no gap add up to the variance.
    #[test]
    fn bands_add_up_to_the_variance(
        x in samples(2..400),
        window in any_window(),
        inner in prop::collection::btree_set(1u32..500, 0..6),
    ) {
        let mut edges = vec![0.0];
        edges.extend(inner.iter().map(|e| f64::from(*e)));
        edges.push(500.0);
        let bands = band_mean_squares(&x, 1000.0, window, &edges).unwrap();
        let total: f64 = bands.iter().sum();
        prop_assert!((total - variance(&x)).abs() <= 1e-12 * variance(&x));
    }

    /// Without a window the squares of the amplitudes themselves add up to the mean square.
    #[test]
    fn amplitudes_add_up_to_the_mean_square(x in samples(2..400)) {
        let amplitude = amplitude_spectrum(&x, 1.0, Window::Rectangular).unwrap().amplitude;
        let sides = |k: usize| if k == 0 || 2 * k == x.len() { 1.0 } else { 0.5 };
        let total: f64 = amplitude.iter().enumerate().map(|(k, a)| sides(k) * a * a).sum();
        let mean_square = x.iter().map(|x| x * x).sum::<f64>() / x.len() as f64;
        prop_assert!((total - mean_square).abs() <= 1e-12 * mean_square);
    }

    /// Frequencies are shares of the output's Nyquist frequency.
    #[test]
    fn decimator_keeps_the_pass_band_and_kills_the_stop_band(
        factor in 2usize..40,
        inside in 0.0..0.8,
        outside in 0.0f64..1.0,
        phase in 0.0..TAU,
    ) {
        let decimator = Decimator::new(factor).unwrap();
        let centre = decimator.half_length() as f64;
        let outside = 1.2 + outside * (factor as f64 - 1.2);
        let wave = |share: f64, i: f64| (PI * share * (i - centre) / factor as f64 + phase).cos();
        let input = |share: f64| -> Vec<f64> {
            (0..decimator.input_length(40)).map(|i| wave(share, i as f64)).collect()
        };
        let kept = decimator.apply(&input(inside));
        prop_assert_eq!(kept.len(), 40);
        for (j, y) in kept.iter().enumerate() {
            prop_assert!((y - wave(inside, centre + (j * factor) as f64)).abs() < 1e-4);
        }
        prop_assert!(decimator.apply(&input(outside)).iter().all(|y| y.abs() < 1e-4));
    }

    /// Orders, phase included, do not depend on the speed, its fluctuation, the sample rate or
    /// where the recording starts.
    #[test]
    fn orders_are_those_of_the_wave(
        per_revolution in 150.0..3000.0f64,
        revolutions in 2.5..6.0f64,
        start in 0.0..TAU,
        fluctuation in 0.0..0.02f64,
        order in 1usize..=20,
        phase in 0.0..TAU,
    ) {
        let n = (per_revolution * revolutions) as usize;
        let shaft = |i: usize| {
            let even = TAU * i as f64 / per_revolution + start;
            even + fluctuation * (2.0 * even).sin()
        };
        let readings: Vec<f64> = (0..n).map(|i| shaft(i).rem_euclid(TAU)).collect();
        let x: Vec<f64> = (0..n).map(|i| 50.0 + (order as f64 * shaft(i) + phase).cos()).collect();
        let grid = AngleGrid::new(&CrankAngle::from_encoder(&readings).unwrap(), 256).unwrap();
        let orders = order_spectrum(&grid.resample(&x).unwrap(), 20).unwrap();
        for (k, (c, rms)) in (1..).zip(orders.of_mean.iter().zip(&orders.rms)) {
            let (re, im) = if k == order { (phase.cos(), phase.sin()) } else { (0.0, 0.0) };
            prop_assert!((c.re - re).hypot(c.im - im) < 2e-3, "order {}: {}", k, c);
            prop_assert!((rms - re.hypot(im)).abs() < 2e-3, "order {}: {}", k, rms);
        }
    }

    #[test]
    fn unwrapping_undoes_wrapping(steps in prop::collection::vec(0.0..3.0, 1..200), start in 0.0..TAU) {
        let mut angle = start;
        let mut truth = Vec::new();
        for step in steps {
            truth.push(angle);
            angle += step;
        }
        let wrapped: Vec<f64> = truth.iter().map(|a| a.rem_euclid(TAU)).collect();
        for (a, b) in unwrap(&wrapped).unwrap().iter().zip(&truth) {
            prop_assert!((a - b).abs() < 1e-10);
        }
    }

    /// Arbitrary readings give an angle that increases, or an error: never a panic.
    #[test]
    fn any_angle_is_taken_or_refused(
        readings in prop::collection::vec(prop_oneof![0.0..TAU, Just(0.0), Just(f64::NAN)], 0..40),
    ) {
        if let Ok(angle) = CrankAngle::from_encoder(&readings) {
            prop_assert!(angle.angles().windows(2).all(|pair| pair[0] < pair[1]));
            if let Ok(grid) = AngleGrid::new(&angle, 64) {
                let ones = grid.resample(&vec![1.0; readings.len()]).unwrap();
                prop_assert!(ones.samples().iter().all(|y| (y - 1.0).abs() < 1e-12));
            }
        }
    }

    /// A settled filter answers a step as one at rest does, moved up: filters are linear.
    #[test]
    fn filters_are_linear_and_stable(
        order in 1u32..=8,
        cutoff in 0.001..0.49,
        offset in -1e3..1e3,
        x in samples(1..200),
    ) {
        let mut at_rest = Filter::butterworth_low_pass(order, cutoff, 1.0).unwrap();
        let mut settled = at_rest.clone();
        settled.settle(offset);
        for x in x {
            let difference = settled.run(x + offset) - at_rest.run(x) - offset;
            prop_assert!(difference.abs() < 1e-6);
        }
    }

    #[test]
    fn noise_has_no_mean_and_scales(n in 2usize..300, rms in 0.0..10.0, numbers in samples(300..301)) {
        let noise = |rms: f64| {
            let mut numbers = numbers.iter().copied();
            pink_noise(n, rms, || numbers.next().unwrap()).unwrap()
        };
        let x = noise(rms);
        prop_assert!(x.iter().sum::<f64>().abs() < 1e-9 * (1.0 + rms) * n as f64);
        for (one, many) in noise(1.0).iter().zip(&x) {
            // Up to 300 terms of up to 1e3 cancel in a sample.
            prop_assert!((one * rms - many).abs() <= 1e-12 * (1.0 + rms) * 1e3);
        }
    }

    /// A single segment without a taper: Parseval for the density, too.
    #[test]
    fn density_adds_up_to_the_variance(x in samples(2..400)) {
        let psd = welch(&x, 250.0, Window::Rectangular, x.len()).unwrap();
        let total: f64 = psd.density.iter().map(|d| d * psd.resolution).sum();
        prop_assert!((total - variance(&x)).abs() <= 1e-12 * variance(&x));
    }

    /// Centroid and spread stay on the axis, entropy between a line's and white noise's.
    #[test]
    fn spectral_shape_stays_in_range(x in samples(64..400), window in any_window()) {
        let shape = spectral_shape(&welch(&x, 100.0, window, 64).unwrap()).unwrap();
        prop_assert!((0.0..=50.0).contains(&shape.centroid));
        prop_assert!((0.0..=25.0).contains(&shape.spread));
        prop_assert!(shape.entropy >= 0.0 && shape.entropy <= 1.0 + 1e-12);
    }

    /// exp of the log spectrum: the cepstrum is even, so its cosine sum gives back ln|X|.
    #[test]
    fn cepstrum_gives_back_the_logarithms(x in samples(8..100), bin in 1usize..4) {
        let n = x.len();
        let c = real_cepstrum(&x).unwrap();
        let turn = |k: usize, q: usize| (TAU * (k * q % n) as f64 / n as f64).cos();
        let sides = |q: usize| if q == 0 || 2 * q == n { 1.0 } else { 2.0 };
        let logarithm: f64 = c.iter().enumerate().map(|(q, c)| sides(q) * c * turn(bin, q)).sum();
        let spectrum = amplitude_spectrum(&x, 1.0, Window::Rectangular).unwrap().amplitude;
        // Amplitudes are 2|X|/n inside, |X|/n at the Nyquist frequency.
        let magnitude = |k: usize| spectrum[k] * n as f64 / sides(k);
        let floor = (1..=n / 2).map(magnitude).fold(0.0, f64::max) * 1e-4;
        prop_assert!((logarithm - magnitude(bin).max(floor).ln()).abs() < 1e-9);
    }

    /// Kurtosis and the best band do not depend on the size of the signal; the envelope grows
    /// with it. A complex envelope cannot have less than −1.
    #[test]
    fn kurtogram_has_no_scale(x in samples(256..600), power in -20i32..20) {
        let factor = 2f64.powi(power);
        let scaled: Vec<f64> = x.iter().map(|x| factor * x).collect();
        let one = kurtogram(&x, 1000.0, 1.0).unwrap();
        prop_assert_eq!(&one, &kurtogram(&scaled, 1000.0, 1.0).unwrap());
        prop_assert!(one.cells.iter().all(|c| c.kurtosis.unwrap() >= -1.0 - 1e-12));
        let (band, _) = one.most_impulsive().unwrap();
        let envelopes = envelope(&x, 1000.0, band).unwrap().into_iter();
        for (a, b) in envelopes.zip(envelope(&scaled, 1000.0, band).unwrap()) {
            prop_assert!(a >= 0.0 && (a * factor - b).abs() <= 1e-12 * b);
        }
    }

    /// Any band and any samples: an envelope of the same length, or an error.
    #[test]
    fn any_band_is_taken_or_refused(
        x in prop::collection::vec(prop_oneof![9 => -1e3..1e3, 1 => Just(f64::NAN)], 0..40),
        centre in prop_oneof![-1.0..60.0, Just(f64::NAN)],
        width in prop_oneof![-1.0..60.0, Just(f64::INFINITY)],
    ) {
        if let Ok(y) = envelope(&x, 100.0, Band { centre, width }) {
            prop_assert_eq!(y.len(), x.len());
            prop_assert!(y.iter().all(|y| y.is_finite()));
        }
    }

    /// Average and residual share the variance; sectors share the mean square.
    #[test]
    fn revolutions_are_split_without_loss(x in samples(260..700), sectors in 1usize..16) {
        let angle = CrankAngle::from_speed(x.len(), 128.0, 60.0).unwrap();
        let revolutions = AngleGrid::new(&angle, 128).unwrap().resample(&x).unwrap();
        let split = SynchronousAverage::new(&revolutions).unwrap();
        let total = variance(revolutions.samples());
        let sum = variance(split.average()) + split.residual_rms().powi(2);
        prop_assert!((sum - total).abs() <= 1e-12 * total);
        let share = split.synchronous_share().unwrap();
        prop_assert!((share * total - variance(split.average())).abs() <= 1e-12 * total);

        let waterfall = crank_waterfall(&revolutions, sectors).unwrap();
        prop_assert_eq!(waterfall.rms.len(), sectors * revolutions.count());
        let edge = |s: usize| (s * 128).div_ceil(sectors);
        let of_sector = |s: usize| (edge(s + 1) - edge(s)) as f64;
        let squares = waterfall.sector_rms().into_iter().enumerate();
        let mean_square = squares.map(|(s, r)| r * r * of_sector(s)).sum::<f64>() / 128.0;
        let whole = revolutions.samples().iter().map(|x| x * x).sum::<f64>();
        let whole = whole / revolutions.samples().len() as f64;
        prop_assert!((mean_square - whole).abs() <= 1e-12 * whole);
    }
}
