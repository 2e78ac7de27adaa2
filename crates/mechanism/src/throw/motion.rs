//! The pose of a throw, and its rates.

use crate::machine::Throw;
use crate::plane::{Vec2, origin, turned};
use scalar::Scalar;

/// Poses and rates of one throw.
#[derive(Clone, Copy, Debug)]
pub struct Motion<S> {
    /// Crank angle α since this throw's own top dead centre, rad.
    pub angle: S,
    /// Its sine and cosine.
    pub angle_sin_cos: (S, S),
    /// Crank pin, from the shaft's centre, m.
    pub pin: Vec2<S>,
    /// Sine and cosine of the rod's angle φ.
    pub rod_sin_cos: (S, S),
    /// Rod's angular speed, rad/s.
    pub rod_rate: S,
    /// Big-end eye, m, and its velocity, m/s.
    pub big_eye: [Vec2<S>; 2],
    /// Crosshead pin along x, m.
    pub crosshead: S,
    /// Its speed, m/s.
    pub crosshead_rate: S,
    /// Stretch η of the rod: by how much it is longer than without load, over its length.
    pub stretch: S,
    /// Its rate η̇, 1/s.
    pub stretch_rate: S,
}

impl<S: Scalar> Motion<S> {
    /// Nothing yet.
    #[inline(always)]
    pub(crate) fn none() -> Self {
        let zero = S::zero();
        Self {
            angle: zero,
            angle_sin_cos: (zero, zero),
            pin: origin(),
            rod_sin_cos: (zero, zero),
            rod_rate: zero,
            big_eye: [origin(); 2],
            crosshead: zero,
            crosshead_rate: zero,
            stretch: zero,
            stretch_rate: zero,
        }
    }

    /// Finds the pose from the shaft's centre `shaft` (position and velocity), the crank's `angle` and
    /// `speed`, the joints' offsets and rates, and the rod's stretch η and its rate.
    #[allow(clippy::too_many_arguments)]
    #[inline(always)]
    pub(crate) fn find(
        &mut self,
        throw: &Throw<S>,
        shaft: [Vec2<S>; 2],
        angle: S,
        speed: S,
        big: [Vec2<S>; 2],
        small: [Vec2<S>; 2],
        guide: [Vec2<S>; 2],
        [stretch, stretch_rate]: [S; 2],
    ) {
        let (sine, cosine) = angle.sin_cos();
        let pin = Vec2::new(cosine, sine) * throw.crank_radius;
        let eye = shaft[0] + pin - big[0];
        let eye_rate = turned(pin).mul_add(speed, shaft[1] - big[1]);
        // The small-end eye's height follows from the crosshead's, and gives the rod's angle.
        let rise = guide[0].x - small[0].y - eye.y;
        let rise_rate = guide[1].x - small[1].y - eye_rate.y;
        let length = throw.rod.length * (stretch + 1.0);
        let length_rate = throw.rod.length * stretch_rate;
        let rod_sine = rise / length;
        let rod_cosine = (-rod_sine).mul_add(rod_sine, S::one()).sqrt();
        let rod_rate = (-length_rate).mul_add(rod_sine, rise_rate) / (length * rod_cosine);
        self.angle = angle;
        self.angle_sin_cos = (sine, cosine);
        self.pin = pin;
        self.rod_sin_cos = (rod_sine, rod_cosine);
        self.rod_rate = rod_rate;
        self.big_eye = [eye, eye_rate];
        self.crosshead = length.mul_add(rod_cosine, eye.x + small[0].x);
        let rate = length_rate.mul_add(rod_cosine, eye_rate.x + small[1].x);
        self.crosshead_rate = (-rise).mul_add(rod_rate, rate);
        self.stretch = stretch;
        self.stretch_rate = stretch_rate;
    }

    /// Length of the rod over that without load, 1 + η.
    #[inline(always)]
    pub(crate) fn lengthening(&self) -> S {
        self.stretch + 1.0
    }

    /// Unit vector along the rod, from big to small end.
    #[inline(always)]
    pub(crate) fn along_rod(&self) -> Vec2<S> {
        Vec2::new(self.rod_sin_cos.1, self.rod_sin_cos.0)
    }
}
