//! Recursive filters of a measuring chain, as second-order sections.

use crate::error::{Error, positive};
use std::f64::consts::PI;

/// A recursive filter: a low-pass with gain 1 at rest, or an oscillator's response, with gain 0 there.
///
/// Made from the analogue filter by the bilinear transform, pre-warped so that the response is
/// exact at the given frequency (and at 0 Hz). Elsewhere the frequency axis is bent. The filter
/// does at f what the analogue one does at f_a with tan(πf/f_s)/tan(πf₀/f_s) = f_a/f₀, 1 % apart
/// at f = f_s/18. Run it at a rate well above the frequencies that matter.
///
/// Source: Oppenheim and Schafer 2010, "Discrete-Time Signal Processing", 7.2.2.
#[derive(Clone, Debug, PartialEq)]
pub struct Filter {
    sections: Vec<Section>,
}

impl Filter {
    /// Butterworth low-pass of `order` 1 to 8, −3 dB at `cutoff`, Hz:
    /// |H|² = 1 / (1 + (f/f_c)^(2·order)).
    ///
    /// # Errors
    /// Another order, or a frequency that is not between 0 and the Nyquist frequency.
    pub fn butterworth_low_pass(order: u32, cutoff: f64, sample_rate: f64) -> Result<Self, Error> {
        if !(1..=8).contains(&order) {
            return Err(Error::OutOfRange {
                what: "order of a Butterworth filter",
                value: f64::from(order),
                allowed: "1 to 8",
            });
        }
        let g = prewarped(cutoff, sample_rate)?;
        let pairs = (0..order / 2).map(|k| {
            let pole = PI * f64::from(2 * k + 1) / f64::from(2 * order);
            Section::second_order(g, pole.sin())
        });
        let single = (order % 2 == 1).then(|| Section::first_order(g));
        Ok(Self {
            sections: pairs.chain(single).collect(),
        })
    }

    /// A resonance H(s) = ω² / (s² + 2ζωs + ω²), as of a sensor on its mount: natural frequency
    /// in Hz, damping ratio ζ. Its response is exact at the natural frequency.
    ///
    /// # Errors
    /// A frequency that is not between 0 and the Nyquist frequency, or a damping ratio that is
    /// not positive.
    pub fn resonance(frequency: f64, damping_ratio: f64, sample_rate: f64) -> Result<Self, Error> {
        positive("damping ratio", damping_ratio)?;
        let g = prewarped(frequency, sample_rate)?;
        Ok(Self {
            sections: vec![Section::second_order(g, damping_ratio)],
        })
    }

    /// Acceleration of a damped oscillator over the force per mass on it, H(s) = s² / (s² + 2ζωs + ω²): its
    /// accelerance times its mass (ISO 7626-1). Natural frequency in Hz, damping ratio ζ.
    ///
    /// # Errors
    /// As [`Filter::resonance`].
    pub fn accelerance(
        frequency: f64,
        damping_ratio: f64,
        sample_rate: f64,
    ) -> Result<Self, Error> {
        let oscillator = Section::oscillator(frequency, damping_ratio, sample_rate)?;
        let scale = oscillator.scale;
        Ok(oscillator.shows([scale, -2.0 * scale, scale]))
    }

    /// Velocity of a damped oscillator over the force per mass on it, H(s) = s / (s² + 2ζωs + ω²), s: its mobility
    /// times its mass (ISO 7626-1).
    ///
    /// # Errors
    /// As [`Filter::resonance`].
    pub fn mobility(frequency: f64, damping_ratio: f64, sample_rate: f64) -> Result<Self, Error> {
        let oscillator = Section::oscillator(frequency, damping_ratio, sample_rate)?;
        let scale = oscillator.scale * oscillator.g / (2.0 * PI * frequency);
        Ok(oscillator.shows([scale, 0.0, -scale]))
    }

    /// Puts the filter where a constant input `x0` would have brought it, so that it starts
    /// without a transient, and returns what it shows of it. A new filter is settled at 0.
    pub fn settle(&mut self, x0: f64) -> f64 {
        (self.sections.iter_mut()).fold(x0, |x, section| section.settle(x))
    }

    /// Takes the next sample and returns the filtered one.
    pub fn run(&mut self, x: f64) -> f64 {
        self.sections
            .iter_mut()
            .fold(x, |x, section| section.run(x))
    }
}

/// tan(πf/f_s).
fn prewarped(frequency: f64, sample_rate: f64) -> Result<f64, Error> {
    positive("sample rate, Hz", sample_rate)?;
    if frequency > 0.0 && frequency < 0.5 * sample_rate {
        return Ok((PI * frequency / sample_rate).tan());
    }
    Err(Error::OutOfRange {
        what: "frequency of a filter, Hz",
        value: frequency,
        allowed: "above 0 and below half the sample rate",
    })
}

/// (b₀ + b₁z⁻¹ + b₂z⁻²) / (1 + a₁z⁻¹ + a₂z⁻²), in transposed direct form II.
#[derive(Clone, Debug, PartialEq)]
struct Section {
    b: [f64; 3],
    a: [f64; 2],
    /// Gain at rest.
    gain: f64,
    state: [f64; 2],
}

/// A damped oscillator under the bilinear transform: the denominator of its responses.
struct Oscillator {
    g: f64,
    scale: f64,
    a: [f64; 2],
}

impl Oscillator {
    /// The response with this numerator, which shows nothing of a constant.
    fn shows(self, b: [f64; 3]) -> Filter {
        Filter {
            sections: vec![Section {
                b,
                a: self.a,
                gain: 0.0,
                state: [0.0; 2],
            }],
        }
    }
}

impl Section {
    fn oscillator(
        frequency: f64,
        damping_ratio: f64,
        sample_rate: f64,
    ) -> Result<Oscillator, Error> {
        positive("damping ratio", damping_ratio)?;
        let g = prewarped(frequency, sample_rate)?;
        Ok(Oscillator {
            g,
            scale: 1.0 / (1.0 + 2.0 * damping_ratio * g + g * g),
            a: Self::second_order(g, damping_ratio).a,
        })
    }

    fn second_order(g: f64, damping_ratio: f64) -> Self {
        let scale = 1.0 / (1.0 + 2.0 * damping_ratio * g + g * g);
        let b = g * g * scale;
        Self {
            b: [b, 2.0 * b, b],
            a: [
                2.0 * (g * g - 1.0) * scale,
                (1.0 - 2.0 * damping_ratio * g + g * g) * scale,
            ],
            gain: 1.0,
            state: [0.0; 2],
        }
    }

    fn first_order(g: f64) -> Self {
        let b = g / (1.0 + g);
        Self {
            b: [b, b, 0.0],
            a: [(g - 1.0) / (g + 1.0), 0.0],
            gain: 1.0,
            state: [0.0; 2],
        }
    }

    fn settle(&mut self, x0: f64) -> f64 {
        let gain = self.gain;
        self.state = [(gain - self.b[0]) * x0, (self.b[2] - self.a[1] * gain) * x0];
        gain * x0
    }

    fn run(&mut self, x: f64) -> f64 {
        let y = self.b[0] * x + self.state[0];
        self.state[0] = self.b[1] * x - self.a[0] * y + self.state[1];
        self.state[1] = self.b[2] * x - self.a[1] * y;
        y
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fourier::Complex64;

    /// Response to e^(iωt) from the impulse response.
    fn response(filter: &Filter, frequency: f64) -> Complex64 {
        let mut filter = filter.clone();
        let turn = |i: usize| Complex64::cis(-2.0 * PI * frequency * i as f64);
        (0..20_000)
            .map(|i| turn(i) * filter.run(if i == 0 { 1.0 } else { 0.0 }))
            .sum()
    }

    /// The frequency of the analogue filter that answers for `f`, with the sample rate as unit.
    fn bent(f: f64, exact_at: f64) -> f64 {
        exact_at * (PI * f).tan() / (PI * exact_at).tan()
    }

    #[test]
    fn butterworth_has_its_closed_form() {
        for order in 1..=8 {
            let filter = Filter::butterworth_low_pass(order, 0.05, 1.0).unwrap();
            for f in [0.0, 0.01, 0.05, 0.1, 0.2] {
                let ratio = bent(f, 0.05) / 0.05;
                let expected = (1.0 + ratio.powi(2 * order as i32)).powf(-0.5);
                let got = response(&filter, f).norm();
                assert!(
                    (got - expected).abs() < 1e-12,
                    "order {order} at {f}: {got}"
                );
            }
        }
    }

    #[test]
    fn resonance_has_its_closed_form() {
        for zeta in [0.02, 0.3, 1.5] {
            let filter = Filter::resonance(0.05, zeta, 1.0).unwrap();
            for f in [0.0, 0.01, 0.05, 0.1] {
                let r = bent(f, 0.05) / 0.05;
                let expected = Complex64::new(1.0 - r * r, 2.0 * zeta * r).inv();
                assert!((response(&filter, f) - expected).norm() < 1e-10 * expected.norm());
            }
        }
    }

    #[test]
    fn an_oscillator_has_its_closed_forms() {
        let (of, omega) = (0.05, 2.0 * PI * 0.05);
        for zeta in [0.02, 0.3] {
            let [acceleration, velocity] = [
                Filter::accelerance(of, zeta, 1.0).unwrap(),
                Filter::mobility(of, zeta, 1.0).unwrap(),
            ];
            for f in [0.01, 0.05, 0.1] {
                let r = bent(f, of) / of;
                let moved = Complex64::new(1.0 - r * r, 2.0 * zeta * r).inv();
                let expected = [-r * r * moved, Complex64::I * r / omega * moved];
                for (filter, expected) in [&acceleration, &velocity].into_iter().zip(expected) {
                    let apart = (response(filter, f) - expected).norm();
                    assert!(apart < 1e-10 * moved.norm(), "{zeta} at {f}: {apart}");
                }
            }
            // A constant force moves nothing, from the first sample on.
            for mut filter in [acceleration, velocity] {
                assert_eq!(filter.settle(-178.4), 0.0);
                assert!((0..1000).all(|_| filter.run(-178.4).abs() < 1e-9));
            }
        }
    }

    /// One eighteenth of the sample rate: the bent axis is 1 % off, as the documentation says.
    #[test]
    fn bend_of_the_axis_is_as_documented() {
        let f = 1.0 / 18.0;
        assert!((bent(f, 1e-6) / f - 1.0 - 0.0103).abs() < 1e-4);
    }

    #[test]
    fn settled_filter_stays() {
        for order in 1..=8 {
            let mut filter = Filter::butterworth_low_pass(order, 1000.0, 1e6).unwrap();
            filter.settle(-178.4);
            for _ in 0..1000 {
                assert!((filter.run(-178.4) + 178.4).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn bad_parameters_are_refused() {
        assert!(Filter::butterworth_low_pass(0, 1.0, 10.0).is_err());
        assert!(Filter::butterworth_low_pass(9, 1.0, 10.0).is_err());
        assert!(Filter::butterworth_low_pass(2, 5.0, 10.0).is_err());
        assert!(Filter::butterworth_low_pass(2, f64::NAN, 10.0).is_err());
        assert!(Filter::resonance(1.0, 0.0, 10.0).is_err());
        assert!(Filter::resonance(1.0, 0.1, f64::INFINITY).is_err());
    }
}
