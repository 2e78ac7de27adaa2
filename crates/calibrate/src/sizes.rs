//! Coordinates in which an effect that is small acts in proportion to them.
//!
//! A parameter's own coordinate is the logarithm of an amplitude, or a phase. Near 0 neither changes anything, so that a
//! descent that begins there does not leave. Here an amplitude counts in usual sizes, and a wave a cos(kα + φ) by its two
//! quadratures, a cos φ and a sin φ.

use crate::optimiser::LeastSquares;
use crate::parameter::Parameter;
use input::effects;
use nalgebra::DMatrix;
use std::f64::consts::TAU;

/// A problem in these coordinates.
pub struct Sizes<'a, P> {
    problem: &'a P,
    parameters: &'a [Parameter],
    coordinates: Vec<Coordinate>,
}

/// The least amplitude of a wave, in usual sizes: one of 0 has no phase, and no derivative by it.
const LEAST_WAVE: f64 = 1e-3;

/// What stands for a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Coordinate {
    /// Its own coordinate.
    Own,
    /// An amplitude less its value without effect, in usual sizes.
    Size { absent: f64, usual: f64 },
    /// The part of a wave in phase, in usual sizes; the phase has this period. The next one is the other part.
    InPhase { usual: f64, period: f64 },
    /// The part of a wave a quarter of a period later.
    Quadrature,
}

fn coordinates(parameters: &[Parameter]) -> Vec<Coordinate> {
    let of = |parameter: &Parameter| effects::of_path(&parameter.path);
    let follows = |i: usize| {
        let [(entry, amplitude), (next, phase)] =
            [of(&parameters[i])?, of(parameters.get(i + 1)?)?];
        let wave = entry.waves().any(|wave| wave == [amplitude, phase]);
        (wave && entry.name == next.name).then_some((entry, amplitude, phase))
    };
    let mut coordinates: Vec<Coordinate> = Vec::with_capacity(parameters.len());
    for (i, parameter) in parameters.iter().enumerate() {
        let coordinate = if let Some(Coordinate::InPhase { .. }) = coordinates.last() {
            Coordinate::Quadrature
        } else if let Some((entry, amplitude, phase)) = follows(i) {
            let [from, to] = entry.parameters[phase].bounds;
            Coordinate::InPhase {
                usual: entry.usual_wave(amplitude),
                period: to - from,
            }
        } else {
            let size = of(parameter).and_then(|(entry, index)| {
                let declared = &entry.parameters[index];
                let absent = declared.absent?;
                let usual = (declared.start - absent).abs();
                Some(Coordinate::Size { absent, usual })
            });
            size.unwrap_or(Coordinate::Own)
        };
        coordinates.push(coordinate);
    }
    coordinates
}

impl<'a, P: LeastSquares> Sizes<'a, P> {
    /// Of a problem with these parameters.
    pub fn new(problem: &'a P, parameters: &'a [Parameter]) -> Self {
        Self {
            problem,
            parameters,
            coordinates: coordinates(parameters),
        }
    }

    /// The coordinates here of the parameters' own ones.
    pub fn from_own(&self, x: &[f64]) -> Vec<f64> {
        let values: Vec<f64> = self
            .parameters
            .iter()
            .zip(x)
            .map(|(p, x)| p.value(*x))
            .collect();
        let mut z = x.to_vec();
        for (i, coordinate) in self.coordinates.iter().enumerate() {
            match *coordinate {
                Coordinate::Own | Coordinate::Quadrature => {}
                Coordinate::Size { absent, usual } => z[i] = (values[i] - absent) / usual,
                Coordinate::InPhase { usual, period } => {
                    let (sine, cosine) = (TAU * values[i + 1] / period).sin_cos();
                    z[i] = values[i] / usual * cosine;
                    z[i + 1] = values[i] / usual * sine;
                }
            }
        }
        z
    }

    /// The parameters' own coordinates.
    pub fn to_own(&self, z: &[f64]) -> Vec<f64> {
        let mut x = z.to_vec();
        for (i, coordinate) in self.coordinates.iter().enumerate() {
            let parameter = &self.parameters[i];
            let [low, high] = parameter.bounds;
            match *coordinate {
                Coordinate::Own | Coordinate::Quadrature => {}
                Coordinate::Size { absent, usual } => {
                    x[i] = parameter.coordinate((absent + usual * z[i]).clamp(low, high));
                }
                Coordinate::InPhase { usual, period } => {
                    let amplitude = usual * z[i].hypot(z[i + 1]).max(LEAST_WAVE);
                    x[i] = parameter.coordinate(amplitude.clamp(low, high));
                    let (next, phase) = (&self.parameters[i + 1], z[i + 1].atan2(z[i]) / TAU);
                    // The turn that is nearest to the middle of its bounds.
                    let turns = (next.nominal / period - phase).round();
                    x[i + 1] = next.coordinate(period * (phase + turns));
                }
            }
        }
        x
    }
}

impl<P: LeastSquares> LeastSquares for Sizes<'_, P> {
    fn bounds(&self) -> Vec<[f64; 2]> {
        let mut bounds = self.problem.bounds();
        for (i, coordinate) in self.coordinates.iter().enumerate() {
            let [low, high] = self.parameters[i].bounds;
            match *coordinate {
                Coordinate::Own | Coordinate::Quadrature => {}
                Coordinate::Size { absent, usual } => {
                    bounds[i] = [low, high].map(|value| (value - absent) / usual);
                }
                Coordinate::InPhase { usual, .. } => {
                    bounds[i] = [-high / usual, high / usual];
                    bounds[i + 1] = bounds[i];
                }
            }
        }
        bounds
    }

    fn count(&self) -> usize {
        self.problem.count()
    }

    fn residuals(&self, z: &[f64]) -> Vec<f64> {
        self.problem.residuals(&self.to_own(z))
    }

    fn jacobian(&self, z: &[f64]) -> DMatrix<f64> {
        let x = self.to_own(z);
        let mut jacobian = self.problem.jacobian(&x);
        for (i, coordinate) in self.coordinates.iter().enumerate() {
            let parameter = &self.parameters[i];
            let value = parameter.value(x[i]);
            match *coordinate {
                Coordinate::Own | Coordinate::Quadrature => {}
                Coordinate::Size { usual, .. } => {
                    jacobian
                        .column_mut(i)
                        .scale_mut(parameter.slope(value) * usual);
                }
                Coordinate::InPhase { usual, period } => {
                    let next = &self.parameters[i + 1];
                    let phase = next.value(x[i + 1]);
                    let (sine, cosine) = (TAU * phase / period).sin_cos();
                    // An amplitude a changes by du cos φ + dv sin φ, its phase by (dv cos φ − du sin φ)/a.
                    let along = jacobian.column(i) * (parameter.slope(value) * usual);
                    let turn = next.slope(phase) * period / TAU * usual / value;
                    let across = jacobian.column(i + 1) * turn;
                    jacobian.set_column(i, &(&along * cosine - &across * sine));
                    jacobian.set_column(i + 1, &(&along * sine + &across * cosine));
                }
            }
        }
        jacobian
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// The two parts of a wave and the size of an effect, seen as they are.
    struct Seen<'a>(&'a [Parameter]);

    impl LeastSquares for Seen<'_> {
        fn bounds(&self) -> Vec<[f64; 2]> {
            self.0.iter().map(Parameter::box_bounds).collect()
        }

        fn count(&self) -> usize {
            3
        }

        fn residuals(&self, x: &[f64]) -> Vec<f64> {
            let values: Vec<f64> = self.0.iter().zip(x).map(|(p, x)| p.value(*x)).collect();
            let (sine, cosine) = values[1].sin_cos();
            vec![values[0] * cosine, values[0] * sine, values[2] * values[2]]
        }

        fn jacobian(&self, x: &[f64]) -> DMatrix<f64> {
            let step = 1e-6;
            let column = |i: usize| {
                let at = |by: f64| {
                    let mut x = x.to_vec();
                    x[i] += by;
                    self.residuals(&x)
                };
                let pairs = at(step).into_iter().zip(at(-step));
                pairs
                    .map(|(a, b)| (a - b) / (2.0 * step))
                    .collect::<Vec<f64>>()
            };
            DMatrix::from_vec(3, 3, (0..3).flat_map(column).collect())
        }
    }

    fn parameters() -> Vec<Parameter> {
        let tree = json!({"effects": [
            {"misalignment": {"first": "2 N", "first_phase": "40 deg"}},
            {"sensor_gain": {"measure": "crosshead_acceleration", "error": "-3 %"}},
        ]});
        let paths = [
            ("effects.0.misalignment.first", [1.0, 5000.0]),
            ("effects.0.misalignment.first_phase", [0.7 - TAU, 0.7 + TAU]),
            ("effects.1.sensor_gain.error", [-0.5, 0.5]),
        ];
        let paths = paths.into_iter();
        paths
            .map(|(path, bounds)| Parameter::within(&tree, path, bounds).unwrap())
            .collect()
    }

    #[test]
    fn a_small_wave_is_linear_in_its_coordinates() {
        let parameters = parameters();
        let seen = Seen(&parameters);
        let sizes = Sizes::new(&seen, &parameters);
        // A usual misalignment has 200 N; a usual error of a gain is 5 %.
        let z = sizes.from_own(&[0.0; 3]);
        let (sine, cosine) = 40.0_f64.to_radians().sin_cos();
        for (z, expected) in z.iter().zip([0.01 * cosine, 0.01 * sine, -0.6]) {
            assert!((z - expected).abs() < 1e-12, "{z} {expected}");
        }
        let jacobian = sizes.jacobian(&[-0.3, 0.4, 2.0]);
        let expected = [200.0, 0.0, 0.0, 0.0, 200.0, 0.0, 0.0, 0.0, 2.0 * 0.1 * 0.05];
        for (found, expected) in jacobian.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-5, "{jacobian}");
        }
    }

    #[test]
    fn there_and_back_is_the_same_point() {
        let parameters = parameters();
        let seen = Seen(&parameters);
        let sizes = Sizes::new(&seen, &parameters);
        for z in [[0.5, 0.0, 1.0], [-0.3, 0.4, 2.0], [-0.01, -0.02, -6.0]] {
            let x = sizes.to_own(&z);
            for (x, [low, high]) in x.iter().zip(seen.bounds()) {
                assert!((low..=high).contains(x));
            }
            for (back, z) in sizes.from_own(&x).iter().zip(z) {
                assert!((back - z).abs() < 1e-12, "{back} {z}");
            }
        }
        // What is smaller than the bound allows is as small as it allows, in the same direction.
        let least = sizes.from_own(&sizes.to_own(&[1e-5, 1e-5, 0.0]));
        assert!((least[0].hypot(least[1]) - 0.005).abs() < 1e-12);
        assert!((least[0] - least[1]).abs() < 1e-12);
    }
}
