//! The ideal slider crank: rigid, without clearance.

use mechanism::Throw;

/// Crank and connecting rod of a throw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SliderCrank {
    /// Crank radius R, m.
    pub(crate) radius: f64,
    /// Length L of the rod, m.
    pub(crate) rod: f64,
}

impl SliderCrank {
    pub(crate) fn from_throw(throw: &Throw<f64>) -> Self {
        Self {
            radius: throw.crank_radius,
            rod: throw.rod.length,
        }
    }

    /// Distance of the crosshead pin from the shaft at the angle α after top dead centre, m:
    /// x = R cos α + √(L² − R² sin² α).
    pub(crate) fn position(&self, angle: f64) -> f64 {
        let (sine, cosine) = angle.sin_cos();
        self.radius * cosine + self.reach(sine)
    }

    /// Acceleration of the crosshead pin away from the shaft, m/s²: x″ α̇² + x′ α̈, with
    /// x′ = −R sin α − R² sin α cos α / s and x″ = −R cos α − R² cos 2α / s − R⁴ sin² α cos² α / s³,
    /// s = √(L² − R² sin² α).
    pub(crate) fn acceleration(&self, angle: f64, speed: f64, angular: f64) -> f64 {
        let (sine, cosine) = angle.sin_cos();
        let along = self.reach(sine);
        let square = self.radius * self.radius;
        let product = square * sine * cosine;
        let first = -self.radius * sine - product / along;
        let double = square * (cosine * cosine - sine * sine);
        let second = -self.radius * cosine - double / along - product * product / along.powi(3);
        second * speed * speed + first * angular
    }

    fn reach(&self, sine: f64) -> f64 {
        (self.rod * self.rod - (self.radius * sine).powi(2)).sqrt()
    }
}
