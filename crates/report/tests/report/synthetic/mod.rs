//! Signals that look like those of a compressor with clearance, made without the simulation:
//! slider-crank kinematics, plus ringing where a journal crosses its clearance.

pub mod calibration;
pub mod chaos;
pub mod datasets;

use report::case_picture::{CasePicture, ClearJoint};
use std::f64::consts::{PI, TAU};

pub const SAMPLE_RATE_HZ: f64 = 10_000.0;
pub const SPEED_RPM: f64 = 500.0;

const CRANK_M: f64 = 0.12;
const ROD_M: f64 = 0.6;

/// Uniform numbers from 0 to 1 (the multiplier is Knuth's for MMIX).
pub struct Uniform(pub u64);

impl Uniform {
    pub fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// One made-up case.
pub struct Recording {
    pub crank_angle_rad: Vec<f64>,
    pub velocity_m_s: Vec<f64>,
    pub acceleration_m_s2: Vec<f64>,
    pub joints: Vec<Joint>,
}

impl Recording {
    /// The picture of the case.
    pub fn picture(&self, title: &str) -> String {
        CasePicture {
            title,
            crank_angle_rad: &self.crank_angle_rad,
            acceleration_m_s2: &self.acceleration_m_s2,
            velocity_m_s: &self.velocity_m_s,
            joints: self.joints.iter().map(Joint::view).collect(),
        }
        .svg()
    }
}

/// One made-up joint.
pub struct Joint {
    pub name: &'static str,
    pub clearance_m: f64,
    pub x_m: Vec<f64>,
    pub y_m: Vec<f64>,
    pub contact_force_n: Vec<f64>,
}

impl Joint {
    fn view(&self) -> ClearJoint<'_> {
        ClearJoint {
            name: self.name,
            clearance_m: self.clearance_m,
            x_m: &self.x_m,
            y_m: &self.y_m,
            contact_force_n: &self.contact_force_n,
        }
    }
}

/// Crank angles in degrees at which the joint's load changes sides.
fn crossings(joint: &str) -> [f64; 2] {
    match joint {
        "big_end" => [72.0, 258.0],
        "small_end" => [96.0, 281.0],
        _ => [55.0, 236.0],
    }
}

/// A case with clearance in the given joints over some revolutions.
pub fn recording(joints: &[(&'static str, f64)], revolutions: usize, seed: u64) -> Recording {
    let omega = SPEED_RPM * TAU / 60.0;
    let samples = (revolutions as f64 * TAU / omega * SAMPLE_RATE_HZ) as usize;
    let angles: Vec<f64> = (0..samples)
        .map(|i| 0.3 + i as f64 / SAMPLE_RATE_HZ * omega)
        .collect();
    let (mut velocity, mut acceleration): (Vec<f64>, Vec<f64>) =
        angles.iter().map(|&a| kinematics(a, omega)).unzip();
    let mut uniform = Uniform(seed);
    let mut made = Vec::new();
    for &(name, clearance_m) in joints {
        let millimetres = clearance_m * 1e3;
        let mut x_m = Vec::new();
        let mut y_m = Vec::new();
        let mut force: Vec<f64> = angles
            .iter()
            .map(|a| 2600.0 * (a - crossings(name)[0].to_radians()).sin().abs())
            .collect();
        let mut start = vec![(-1.0, 0.0)];
        for turn in 0..=revolutions {
            for crossing in crossings(name) {
                let late = 4.0 * millimetres + uniform.next() * 40.0 * millimetres;
                let mut hit = crossing + late;
                let mut strength = (millimetres / 0.3).sqrt() * (0.7 + 0.6 * uniform.next());
                start.push((turn as f64 * 360.0 + crossing, late));
                for _ in 0..4 {
                    let at = (turn as f64 * 360.0 + hit).to_radians();
                    for (i, &angle) in angles.iter().enumerate() {
                        let seconds = (angle - at) / omega;
                        if (0.0..0.02).contains(&seconds) {
                            let ring = (-seconds / 1.6e-3).exp();
                            let phase = TAU * 870.0 * seconds;
                            acceleration[i] += 1500.0 * strength * ring * phase.sin();
                            velocity[i] -= 1500.0 * strength / (TAU * 870.0) * ring * phase.cos();
                            force[i] += 24_000.0
                                * strength
                                * (-seconds / 0.4e-3).exp()
                                * (1.0 + (phase * 1.3).cos())
                                / 2.0;
                        }
                    }
                    hit += late * 0.8 + 3.0;
                    strength *= 0.55;
                }
            }
        }
        for &angle in &angles {
            let degrees = angle.to_degrees();
            let begun = start
                .iter()
                .filter(|(begin, _)| *begin <= degrees)
                .count()
                .max(1);
            let (begin, late) = start[begun - 1];
            let across = if late > 0.0 {
                ((degrees - begin) / late).clamp(0.0, 1.0)
            } else {
                1.0
            };
            let radius = clearance_m * (1.004 - 0.002 * angle.cos());
            let at = |side: usize| {
                let lean = PI * side as f64 + 0.4 * angle.sin();
                [radius * lean.cos(), radius * lean.sin()]
            };
            let (from, to) = (at(begun - 1), at(begun));
            x_m.push(from[0] + (to[0] - from[0]) * across);
            y_m.push(from[1] + (to[1] - from[1]) * across);
        }
        made.push(Joint {
            name,
            clearance_m,
            x_m,
            y_m,
            contact_force_n: force,
        });
    }
    for a in &mut acceleration {
        *a += 6.0 * (uniform.next() - 0.5);
    }
    Recording {
        crank_angle_rad: angles,
        velocity_m_s: velocity,
        acceleration_m_s2: acceleration,
        joints: made,
    }
}

/// Velocity and acceleration of the crosshead of an ideal slider-crank.
fn kinematics(angle: f64, omega: f64) -> (f64, f64) {
    let position =
        |a: f64| CRANK_M * a.cos() + (ROD_M.powi(2) - (CRANK_M * a.sin()).powi(2)).sqrt();
    let h = 1e-4;
    let slope = (position(angle + h) - position(angle - h)) / (2.0 * h);
    let curvature = (position(angle + h) - 2.0 * position(angle) + position(angle - h)) / (h * h);
    (omega * slope, omega * omega * curvature)
}

/// Amplitude spectrum of the first power-of-two samples under a Hann window: (Hz, m/s²).
pub fn spectrum(signal: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let n = if signal.is_empty() {
        1
    } else {
        1 << signal.len().ilog2()
    };
    let mean = signal.iter().take(n).sum::<f64>() / n as f64;
    let windowed: Vec<[f64; 2]> = signal
        .iter()
        .take(n)
        .enumerate()
        .map(|(i, v)| [(v - mean) * (1.0 - (TAU * i as f64 / n as f64).cos()), 0.0])
        .collect();
    let amplitudes = fourier(&windowed)
        .iter()
        .take(n / 2)
        .map(|z| 2.0 * z[0].hypot(z[1]) / n as f64)
        .collect();
    (
        (0..n / 2)
            .map(|i| i as f64 * SAMPLE_RATE_HZ / n as f64)
            .collect(),
        amplitudes,
    )
}

fn fourier(z: &[[f64; 2]]) -> Vec<[f64; 2]> {
    if z.len() < 2 {
        return z.to_vec();
    }
    let half =
        |first: usize| fourier(&z.iter().skip(first).step_by(2).copied().collect::<Vec<_>>());
    let (even, odd) = (half(0), half(1));
    let m = even.len();
    let twiddled = |i: usize| {
        let (s, c) = (-TAU * i as f64 / z.len() as f64).sin_cos();
        [c * odd[i][0] - s * odd[i][1], c * odd[i][1] + s * odd[i][0]]
    };
    let sums = (0..m).map(|i| [even[i][0] + twiddled(i)[0], even[i][1] + twiddled(i)[1]]);
    let differences = (0..m).map(|i| [even[i][0] - twiddled(i)[0], even[i][1] - twiddled(i)[1]]);
    sums.chain(differences).collect()
}
