//! The machine of `machine.h`: the same equations and state; the branches follow from the state.

use crate::dual::Number;
use std::f64::consts::PI;

pub const COMPONENTS: usize = 8;
pub const REVOLUTION: f64 = 0.12;
/// Of a revolution, 10 kHz.
pub const SAMPLES: usize = 1200;
/// What counts as 1 for the tolerance: the clearance, and a thousand of it a second.
pub const SCALES: [f64; COMPONENTS] = [3e-4, 3e-4, 3e-4, 3e-4, 0.3, 0.3, 0.3, 0.3];

const SPEED: f64 = 2.0 * PI / REVOLUTION;
const R: f64 = 0.120;
const L: f64 = 0.600;
const CENTRE: f64 = 0.220;
const ROD_MASS: f64 = 12.0;
const ROD_INERTIA: f64 = 0.60;
const CROSSHEAD_MASS: f64 = 18.0;
const GRAVITY: f64 = 9.81;
const SUCTION: f64 = 0.105e6;
const DISCHARGE: f64 = 0.393e6;
const BACK: f64 = 0.0;
const EXPONENT: f64 = 1.4;
const HEAD: f64 = 0.024;
const AREA: f64 = PI * 0.050 * 0.050;
const CLEARANCE: f64 = 3e-4;
const DEPTH: f64 = 1e-5;
const DAMPING: f64 = 2e4;
const FRICTION: f64 = 0.05;
const SLIP: f64 = 0.01;
/// Of big end and small end.
const RADIUS: [f64; 2] = [0.050, 0.035];
const STIFFNESS: [f64; 2] = [2.4e10, 2.0e10];
/// Force on the journal and the normal there, 0 where there is no contact.
fn contact<S: Number>(e: &[S], de: &[S], joint: usize, turn: S) -> [[S; 2]; 2] {
    let c = S::of;
    let nothing = [[c(0.0); 2]; 2];
    let square = e[0] * e[0] + e[1] * e[1];
    if square.value() <= CLEARANCE * CLEARANCE {
        return nothing;
    }
    let r = square.sqrt();
    let (nx, ny) = (e[0] / r, e[1] / r);
    let delta = r - c(CLEARANCE);
    let approach = nx * de[0] + ny * de[1];
    let journal = if joint == 0 { SPEED * RADIUS[0] } else { 0.0 };
    let slip = nx * de[1] - ny * de[0] + c(journal) - turn * (c(RADIUS[joint]) + r);
    let s = match delta.value() < DEPTH {
        true => delta / c(DEPTH),
        false => c(1.0),
    };
    let push = c(STIFFNESS[joint]) * delta * delta.sqrt()
        + c(DAMPING) * s * s * (c(3.0) - c(2.0) * s) * approach;
    if push.value() <= 0.0 {
        return nothing;
    }
    let drag = c(FRICTION) * push * slip / (slip * slip + c(SLIP * SLIP)).sqrt();
    [[-push * nx + drag * ny, -push * ny - drag * nx], [nx, ny]]
}

/// The machine; `ratio` is by how much the gas expands between the lines' pressures.
pub struct Machine {
    ratio: f64,
}

impl Machine {
    pub fn new() -> Self {
        let ratio = (DISCHARGE / SUCTION).powf(1.0 / EXPONENT);
        Self { ratio }
    }

    fn pressure<S: Number>(&self, distance: S, toward: bool) -> S {
        let bounds = match toward {
            true => [(2.0 * R + HEAD) / self.ratio, 2.0 * R + HEAD],
            false => [HEAD, HEAD * self.ratio],
        };
        if distance.value() <= bounds[0] {
            return S::of(DISCHARGE);
        }
        if distance.value() >= bounds[1] {
            return S::of(SUCTION);
        }
        let (from, start) = match toward {
            true => (SUCTION, bounds[1]),
            false => (DISCHARGE, bounds[0]),
        };
        S::of(from) * (S::of(start) / distance).powf(EXPONENT)
    }

    /// Writes the derivative of the state and gives the crosshead's acceleration back.
    pub fn derivative<S: Number>(&self, t: f64, y: &[S], dy: &mut [S]) -> S {
        let c = S::of;
        let angle = SPEED * t;
        let (sine, cosine) = angle.sin_cos();
        let pin = [R * cosine, R * sine];
        let up = -(c(pin[1]) - y[1] + y[3]) / c(L);
        // Stages of a step that is much too long may leave every range; an error that is not a
        // number would pass for small.
        let square = c(1.0) - up * up;
        let along = match square.value() > 0.01 {
            true => square.sqrt(),
            false => c(0.1),
        };
        let turn = -(c(SPEED * pin[0]) - y[5] + y[7]) / (c(L) * along);
        let crosshead = c(pin[0]) - y[0] + c(L) * along + y[2];
        let [fb, nb] = contact(&y[0..2], &y[4..6], 0, turn);
        let [fs, ns] = contact(&y[2..4], &y[6..8], 1, turn);
        // Points of contact, from the rod's centre of mass.
        let bx = c(-CENTRE) * along + y[0] + c(RADIUS[0]) * nb[0];
        let by = c(-CENTRE) * up + y[1] + c(RADIUS[0]) * nb[1];
        let sx = c(L - CENTRE) * along + y[2] + c(RADIUS[1]) * ns[0];
        let sy = c(L - CENTRE) * up + y[3] + c(RADIUS[1]) * ns[1];
        let moment = -(bx * fb[1] - by * fb[0]) - (sx * fs[1] - sy * fs[0]);
        let turning = moment / c(ROD_INERTIA);
        let ax = -(fb[0] + fs[0]) / c(ROD_MASS);
        let ay = -(fb[1] + fs[1]) / c(ROD_MASS) - c(GRAVITY);
        let toward = angle.rem_euclid(2.0 * PI) >= PI;
        let gas = self.pressure(c(HEAD + R + L) - crosshead, toward) - c(BACK);
        let acceleration = (fs[0] - gas * c(AREA)) / c(CROSSHEAD_MASS);
        // Acceleration of a point of the rod's axis per distance from its centre of mass.
        let gx = -turning * up - turn * turn * along;
        let gy = turning * along - turn * turn * up;
        dy[..4].copy_from_slice(&y[4..8]);
        dy[4] = c(-SPEED * SPEED * pin[0]) - (ax - c(CENTRE) * gx);
        dy[5] = c(-SPEED * SPEED * pin[1]) - (ay - c(CENTRE) * gy);
        dy[6] = acceleration - (ax + c(L - CENTRE) * gx);
        dy[7] = -(ay + c(L - CENTRE) * gy);
        acceleration
    }
}
