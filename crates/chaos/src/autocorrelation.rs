//! Autocorrelation of a signal.

/// Autocorrelation at the lags `0..count`, 1 at lag 0 (Wiener-Khinchin; padded with zeros so that
/// the ends do not meet). `signal` must vary and be longer than `count`.
pub fn autocorrelation(signal: &[f64], count: usize) -> Vec<f64> {
    let mean = signal.iter().sum::<f64>() / signal.len() as f64;
    let length = (signal.len() + count).next_power_of_two();
    let mut padded: Vec<f64> = signal.iter().map(|x| x - mean).collect();
    padded.resize(length, 0.0);
    let mut spectrum = fourier::forward(&mut padded);
    spectrum.iter_mut().for_each(|c| *c = c.norm_sqr().into());
    let mut padded = fourier::inverse(spectrum, length);
    let whole = padded[0];
    padded.truncate(count.min(signal.len()));
    padded.iter_mut().for_each(|r| *r /= whole);
    padded
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_systems::Noise;

    #[test]
    fn equals_the_sum_of_products() {
        let signal = Noise::Ar1.samples(500, 4);
        let mean = signal.iter().sum::<f64>() / 500.0;
        let product = |lag: usize| -> f64 {
            signal
                .iter()
                .zip(&signal[lag..])
                .map(|(a, b)| (a - mean) * (b - mean))
                .sum()
        };
        for (lag, r) in autocorrelation(&signal, 40).into_iter().enumerate() {
            assert!((r - product(lag) / product(0)).abs() < 1e-12);
        }
    }
}
