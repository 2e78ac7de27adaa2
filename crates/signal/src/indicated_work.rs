//! Work of the gas in a cylinder: the area of its p-V card.

use crate::angle_resampling::Revolutions;
use std::f64::consts::TAU;

/// Work that the piston does on the gas of a chamber per revolution, J: W = −∮ p dV, the mean over the
/// whole revolutions of `pressure`, Pa. It is positive for a compressor.
///
/// `volume` gives the volume of the chamber at a crank angle in rad, m³; it repeats every revolution.
/// Between two points the pressure is a straight line over the volume, so that the error falls with the
/// square of the points per revolution.
pub fn indicated_work(pressure: &Revolutions, volume: impl Fn(f64) -> f64) -> f64 {
    let points = pressure.points_per_revolution();
    let step = TAU / points as f64;
    let start = pressure.start_angle();
    let volumes: Vec<f64> = (0..points)
        .map(|j| volume(start + j as f64 * step))
        .collect();
    let p = pressure.samples();
    let after = p.iter().cycle().skip(1);
    let changes = (0..points).map(|j| volumes[(j + 1) % points] - volumes[j]);
    let work = p.iter().zip(after).zip(changes.cycle());
    let work = work.map(|((p, next), change)| -0.5 * (p + next) * change);
    work.sum::<f64>() / pressure.count() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::angle_resampling::AngleGrid;
    use crate::crank_angle::CrankAngle;

    const SUCTION: f64 = 1e5;
    const DISCHARGE: f64 = 4e5;
    const EXPONENT: f64 = 1.3;
    const STROKE_VOLUME: f64 = 2e-3;
    const CLEARANCE_VOLUME: f64 = 2e-4;

    fn volume(angle: f64) -> f64 {
        CLEARANCE_VOLUME + STROKE_VOLUME * 0.5 * (1.0 - angle.cos())
    }

    /// Ideal cycle with clearance: p Vⁿ is constant while both valves are shut.
    fn pressure(angle: f64) -> f64 {
        let full = CLEARANCE_VOLUME + STROKE_VOLUME;
        match angle.sin() > 0.0 {
            true => (DISCHARGE * (CLEARANCE_VOLUME / volume(angle)).powf(EXPONENT)).max(SUCTION),
            false => (SUCTION * (full / volume(angle)).powf(EXPONENT)).min(DISCHARGE),
        }
    }

    /// n/(n − 1) p₁ (V₁ − V₄) ((p₂/p₁)^((n − 1)/n) − 1), V₄ where the clearance gas has expanded to p₁.
    fn closed_form() -> f64 {
        let ratio = DISCHARGE / SUCTION;
        let expanded = CLEARANCE_VOLUME * ratio.powf(1.0 / EXPONENT);
        let drawn_in = STROKE_VOLUME + CLEARANCE_VOLUME - expanded;
        let share = (EXPONENT - 1.0) / EXPONENT;
        SUCTION * drawn_in / share * (ratio.powf(share) - 1.0)
    }

    #[test]
    fn an_ideal_cycle_takes_its_closed_form_from_any_start() {
        for (samples, first) in [(6000, 0.0), (6000, 1.234), (6600, 4.0)] {
            let angle = |i: usize| (first + i as f64 * TAU / 2000.0) % TAU;
            let readings: Vec<f64> = (0..samples).map(angle).collect();
            let p: Vec<f64> = readings.iter().map(|angle| pressure(*angle)).collect();
            let crank = CrankAngle::from_encoder(&readings).unwrap();
            let grid = AngleGrid::new(&crank, 2048).unwrap();
            let work = indicated_work(&grid.resample(&p).unwrap(), volume);
            assert!(
                (work / closed_form() - 1.0).abs() < 2e-4,
                "{work} for {}",
                closed_form()
            );
        }
    }

    #[test]
    fn a_constant_pressure_does_no_work() {
        let crank = CrankAngle::from_speed(5000, 1000.0, 60.0).unwrap();
        let grid = AngleGrid::new(&crank, 1024).unwrap();
        let work = indicated_work(&grid.resample(&[3e5; 5000]).unwrap(), volume);
        assert!(work.abs() < 1e-9 * 3e5 * STROKE_VOLUME, "{work}");
    }
}
