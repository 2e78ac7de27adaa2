//! Against SciPy and NumPy: `data/reference/signal/make.py` made the numbers.

use signal::amplitude_spectrum::amplitude_spectrum;
use signal::angle_resampling::AngleGrid;
use signal::biquad::Filter;
use signal::cepstrum::real_cepstrum;
use signal::crank_angle::CrankAngle;
use signal::decimate::Decimator;
use signal::envelope::{Band, envelope, envelope_spectrum};
use signal::kurtogram::kurtogram;
use signal::order_spectrum::order_spectrum;
use signal::spectral_kurtosis::spectral_kurtosis;
use signal::spectral_shape::spectral_shape;
use signal::welch::welch;
use signal::windows::Window;
use std::f64::consts::TAU;

fn reference(name: &str) -> Vec<f64> {
    let text = include_str!("../../../../data/reference/signal/reference.csv");
    let line = text
        .lines()
        .find_map(|line| line.strip_prefix(name)?.strip_prefix(','));
    let numbers = line.unwrap_or_else(|| panic!("no line {name}"));
    numbers.split(',').map(|n| n.parse().unwrap()).collect()
}

/// Largest difference over the largest reference value.
fn difference(got: &[f64], name: &str) -> f64 {
    let expected = reference(name);
    assert_eq!(got.len(), expected.len(), "{name}");
    let scale = expected.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let pairs = got.iter().zip(&expected);
    pairs.fold(0.0, |m: f64, (g, e)| m.max((g - e).abs())) / scale
}

#[test]
fn input_is_the_one_of_the_formula() {
    let x = reference("input");
    let at = |i: f64| {
        2.0 + 3.0 * (0.31 * i).sin() + 0.5 * (1.7 * i + 0.2).cos() + 0.8 * (0.004 * i * i).sin()
    };
    for (i, x) in x.iter().enumerate() {
        let spike = if i == 100 { 9.0 } else { 0.0 };
        assert!((x - at(i as f64) - spike).abs() < 1e-6);
    }
}

#[test]
fn windows_and_amplitudes() {
    let x = reference("input");
    for (window, name) in [(Window::Hann, "hann"), (Window::FlatTop, "flattop")] {
        assert!(difference(&window.weights(24), &format!("window_{name}")) < 1e-15);
        let spectrum = amplitude_spectrum(&x, 1.0, window).unwrap();
        assert!(difference(&spectrum.amplitude, &format!("amplitude_{name}")) < 1e-14);
    }
}

#[test]
fn decimation() {
    let output = Decimator::new(3).unwrap().apply(&reference("input"));
    assert!(difference(&output, "decimated_by_3") < 1e-14);
}

#[test]
fn filters() {
    let x = &reference("input")[..60];
    for order in 1..=8 {
        let mut filter = Filter::butterworth_low_pass(order, 0.08, 1.0).unwrap();
        filter.settle(x[0]);
        let y: Vec<f64> = x.iter().map(|x| filter.run(*x)).collect();
        assert!(difference(&y, &format!("butterworth_{order}")) < 1e-12);
    }
    let mut filter = Filter::resonance(0.08, 0.05, 1.0).unwrap();
    let y: Vec<f64> = x.iter().map(|x| filter.run(*x)).collect();
    assert!(difference(&y, "resonance") < 1e-13);
}

#[test]
fn smoothed_encoder() {
    for rate in [900, 2000] {
        let step = TAU / 65536.0;
        let reading = |i: usize| {
            let turn = TAU * i as f64 / f64::from(rate) + 0.0123;
            (((turn + 0.02 * (2.0 * turn).sin()) / step).floor() * step).rem_euclid(TAU)
        };
        let readings: Vec<f64> = (0..rate as usize + 40).map(reading).collect();
        let angle = CrankAngle::from_encoder(&readings).unwrap();
        let thinned: Vec<f64> = angle
            .angles()
            .iter()
            .step_by(rate as usize / 30)
            .copied()
            .collect();
        assert!(difference(&thinned, &format!("angle_{rate}")) < 1e-13);
    }
}

#[test]
fn orders() {
    let theta = |i: usize| {
        let turn = TAU * i as f64 / 1000.0;
        turn + 0.02 * (2.0 * turn).sin()
    };
    let wave = |t: f64| (2.0 * (t - 0.5).cos()).exp() * (1.0 + 0.1 * (t / 3.0).cos());
    let readings: Vec<f64> = (0..3000).map(|i| theta(i).rem_euclid(TAU)).collect();
    let x: Vec<f64> = (0..3000).map(|i| wave(theta(i))).collect();
    let grid = AngleGrid::new(&CrankAngle::from_encoder(&readings).unwrap(), 1024).unwrap();
    let orders = order_spectrum(&grid.resample(&x).unwrap(), 20).unwrap();
    let re: Vec<f64> = orders.of_mean.iter().map(|c| c.re).collect();
    let im: Vec<f64> = orders.of_mean.iter().map(|c| c.im).collect();
    assert!(difference(&re, "orders_re") < 1e-6);
    assert!(difference(&im, "orders_im") < 1e-6);
    assert!(difference(&orders.rms, "orders_rms") < 1e-6);
}

#[test]
fn averaged_spectra() {
    let x = reference("input");
    for (window, name) in [(Window::Hann, "hann"), (Window::FlatTop, "flattop")] {
        let psd = welch(&x, 50.0, window, 64).unwrap();
        assert!(difference(&psd.density, &format!("welch_{name}")) < 1e-13);
    }
    let shape = spectral_shape(&welch(&x, 50.0, Window::Hann, 64).unwrap()).unwrap();
    let shape = [shape.centroid, shape.spread, shape.entropy];
    assert!(difference(&shape, "spectral_shape") < 1e-13);
    let sk = spectral_kurtosis(&x, 1.0, Window::Hann, 16).unwrap();
    let sk: Vec<f64> = sk.kurtosis.into_iter().map(Option::unwrap).collect();
    assert!(difference(&sk, "spectral_kurtosis") < 1e-12);
}

#[test]
fn cepstrum() {
    let cepstrum = real_cepstrum(&reference("input")).unwrap();
    assert!(difference(&cepstrum, "cepstrum") < 1e-13);
}

#[test]
fn envelopes() {
    let x = reference("input");
    let band = Band {
        centre: 30.0,
        width: 20.0,
    };
    assert!(difference(&envelope(&x, 100.0, band).unwrap(), "envelope") < 1e-13);
    let spectrum = envelope_spectrum(&x, 100.0, band).unwrap();
    assert!(difference(&spectrum.amplitude, "envelope_spectrum") < 1e-13);
}

#[test]
fn kurtogram_cells() {
    let x = reference("input");
    let mut long = x.clone();
    long.extend(x.iter().rev());
    long.extend(&x);
    long.extend(x.iter().map(|x| -x));
    let cells = kurtogram(&long, 1.0, 1e-3).unwrap().cells;
    let kurtosis: Vec<f64> = cells.iter().map(|c| c.kurtosis.unwrap()).collect();
    assert!(difference(&kurtosis, "kurtogram") < 1e-11);
}
