//! Amplitudes at multiples of the shaft's rotation.

use crate::angle_resampling::Revolutions;
use crate::error::Error;
use fourier::Complex64;

/// Amplitudes at orders 1, 2, ... of the shaft; index `k - 1` holds order `k`.
#[derive(Clone, Debug, PartialEq)]
pub struct OrderSpectrum {
    /// c_k of the crank-angle synchronous mean, x̄(θ) = x̄₀ + Re Σ c_k e^(ikθ), θ being the crank
    /// angle. Its magnitude is the amplitude of the order.
    pub of_mean: Vec<Complex64>,
    /// RMS over the revolutions of each revolution's amplitude. It exceeds |c_k| by what
    /// varies from one revolution to the next.
    pub rms: Vec<f64>,
}

/// Orders 1 to `highest`, from the discrete Fourier transform of each revolution.
///
/// # Errors
/// `highest` not below half the points per revolution.
pub fn order_spectrum(x: &Revolutions, highest: usize) -> Result<OrderSpectrum, Error> {
    let n = x.points_per_revolution();
    if 2 * highest >= n {
        return Err(Error::OutOfRange {
            what: "highest order",
            value: highest as f64,
            allowed: "below half the points per revolution",
        });
    }
    let mut sums = vec![Complex64::ZERO; highest];
    let mut squares = vec![0.0; highest];
    let mut work = vec![0.0; n];
    for revolution in x.iter() {
        work.copy_from_slice(revolution);
        let spectrum = fourier::forward(&mut work);
        for ((sum, square), c) in sums.iter_mut().zip(&mut squares).zip(&spectrum[1..]) {
            *sum += c;
            *square += c.norm_sqr();
        }
    }
    let scale = 2.0 / n as f64;
    let count = x.count() as f64;
    let turned = sums
        .iter()
        .zip(1..)
        .map(|(c, k)| c * x.phase(k) * (scale / count));
    Ok(OrderSpectrum {
        of_mean: turned.collect(),
        rms: squares.iter().map(|s| scale * (s / count).sqrt()).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::angle_resampling::AngleGrid;
    use crate::crank_angle::CrankAngle;
    use std::f64::consts::TAU;

    fn orders(n: usize, start: f64, wave: impl Fn(f64) -> f64) -> OrderSpectrum {
        let even = |i: usize| TAU * i as f64 / 900.0 + start;
        let shaft = |i: usize| even(i) + 0.02 * (2.0 * even(i)).sin();
        let x: Vec<f64> = (0..n).map(|i| wave(shaft(i))).collect();
        let wrapped: Vec<f64> = (0..n).map(|i| shaft(i).rem_euclid(TAU)).collect();
        let grid = AngleGrid::new(&CrankAngle::from_encoder(&wrapped).unwrap(), 1024).unwrap();
        order_spectrum(&grid.resample(&x).unwrap(), 20).unwrap()
    }

    /// Amplitudes and phases of a sum of orders come back for any speed and any start of the recording.
    #[test]
    fn sum_of_orders_comes_back() {
        let wave = |a: f64| {
            2.0 + 3.0 * (a + 0.7).cos() + 0.4 * (7.0 * a - 1.1).cos() + 0.05 * (20.0 * a).sin()
        };
        for start in [0.0, 2.5, 6.1] {
            let orders = orders(4000, start, wave);
            let mut expected = [Complex64::ZERO; 20];
            expected[0] = Complex64::from_polar(3.0, 0.7);
            expected[6] = Complex64::from_polar(0.4, -1.1);
            expected[19] = Complex64::from_polar(0.05, -TAU / 4.0);
            for ((c, rms), expected) in orders.of_mean.iter().zip(&orders.rms).zip(expected) {
                assert!((c - expected).norm() < 5e-6, "from {start}: {c}");
                assert!((rms - expected.norm()).abs() < 5e-6);
            }
        }
    }

    /// A wave of two revolutions' period, of amplitude b at order 1 apart from its sign, averages
    /// out of the mean but not out of the RMS.
    #[test]
    fn rms_over_revolutions_keeps_what_the_mean_loses() {
        let wave = |a: f64| {
            let sign = if (a / TAU).floor() as i64 % 2 == 0 {
                1.0
            } else {
                -1.0
            };
            3.0 * (4.0 * a).cos() + sign * 0.5 * (1.0 - (5.0 * a).cos())
        };
        // Starts and ends at 0, where neighbouring revolutions join smoothly.
        let orders = orders(3600, 0.0, wave);
        assert!((orders.of_mean[3].norm() - 3.0).abs() < 1e-4);
        assert!(orders.of_mean[4].norm() < 1e-4);
        assert!((orders.rms[4] - 0.5).abs() < 1e-4);
    }

    #[test]
    fn orders_above_the_points_are_refused() {
        let angle = CrankAngle::from_speed(100, 50.0, 60.0).unwrap();
        let x = AngleGrid::new(&angle, 64)
            .unwrap()
            .resample(&[1.0; 100])
            .unwrap();
        assert!(order_spectrum(&x, 32).is_err());
        assert!(
            order_spectrum(&x, 31)
                .unwrap()
                .rms
                .iter()
                .all(|a| *a < 1e-14)
        );
    }
}
