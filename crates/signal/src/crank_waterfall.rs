//! Where in the revolution it is loud, revolution by revolution.

use crate::angle_resampling::Revolutions;
use crate::error::Error;

/// RMS and kurtosis over sectors of the crank angle: a row per revolution, a column per sector.
/// Sector `s` of S holds the crank angles 2πs/S ≤ θ < 2π(s+1)/S. Where revolutions do not start
/// at angle 0, the sectors before the start hold the end of the row's revolution.
#[derive(Clone, Debug, PartialEq)]
pub struct CrankWaterfall {
    /// Sectors per revolution.
    pub sectors: usize,
    /// RMS of the samples as they are, in their unit, one revolution after the other.
    pub rms: Vec<f64>,
    /// Kurtosis about the sector's mean (not excess; 3 if Gaussian); none where it is constant.
    pub kurtosis: Vec<Option<f64>>,
}

impl CrankWaterfall {
    /// RMS of each sector over all revolutions.
    pub fn sector_rms(&self) -> Vec<f64> {
        let revolutions = (self.rms.len() / self.sectors) as f64;
        let mean_square = |s: usize| {
            let column = self.rms.iter().skip(s).step_by(self.sectors);
            column.map(|rms| rms * rms).sum::<f64>() / revolutions
        };
        (0..self.sectors).map(|s| mean_square(s).sqrt()).collect()
    }
}

/// The waterfall over `sectors` equal sectors.
///
/// # Errors
/// No sector, or fewer than four points in each.
pub fn crank_waterfall(x: &Revolutions, sectors: usize) -> Result<CrankWaterfall, Error> {
    let points = x.points_per_revolution();
    if sectors == 0 || sectors > points / 4 {
        return Err(Error::OutOfRange {
            what: "sectors per revolution",
            value: sectors as f64,
            allowed: "1 to a quarter of the points per revolution",
        });
    }
    // Point p lies in sector ⌊pS/N⌋, which begins at the point ⌈sN/S⌉.
    let edges: Vec<usize> = (0..=sectors)
        .map(|s| (s * points).div_ceil(sectors))
        .collect();
    let mut waterfall = CrankWaterfall {
        sectors,
        rms: Vec::with_capacity(x.count() * sectors),
        kurtosis: Vec::with_capacity(x.count() * sectors),
    };
    let mut from_zero = vec![0.0; points];
    for revolution in x.iter() {
        from_zero.copy_from_slice(revolution);
        from_zero.rotate_right(x.first_point());
        for edge in edges.windows(2) {
            let sector = &from_zero[edge[0]..edge[1]];
            waterfall.rms.push(rms(sector));
            waterfall.kurtosis.push(kurtosis(sector));
        }
    }
    Ok(waterfall)
}

fn rms(x: &[f64]) -> f64 {
    (x.iter().map(|x| x * x).sum::<f64>() / x.len() as f64).sqrt()
}

fn kurtosis(x: &[f64]) -> Option<f64> {
    let n = x.len() as f64;
    let mean = x.iter().sum::<f64>() / n;
    let moment = |power| x.iter().map(|x| (x - mean).powi(power)).sum::<f64>() / n;
    let variance = moment(2);
    let square = variance * variance;
    let constant = x.iter().all(|y| *y == x[0]);
    (!constant && square > 0.0).then(|| moment(4) / square)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::angle_resampling::AngleGrid;
    use crate::crank_angle::CrankAngle;
    use std::f64::consts::TAU;

    fn revolutions(start: f64, wave: impl Fn(f64) -> f64) -> Revolutions {
        let angle = |i: usize| TAU * (i as f64 / 480.0) + start;
        let readings: Vec<f64> = (0..1920).map(|i| angle(i).rem_euclid(TAU)).collect();
        let x: Vec<f64> = (0..1920).map(|i| wave(angle(i))).collect();
        let grid = AngleGrid::new(&CrankAngle::from_encoder(&readings).unwrap(), 480).unwrap();
        grid.resample(&x).unwrap()
    }

    /// One bump at 100°, wherever the recording starts: sector 3 of 12 holds it. The sectors'
    /// mean squares average to that of the whole.
    #[test]
    fn sectors_are_those_of_the_crank_angle() {
        for start in [0.0, 2.0, 5.5] {
            let bump = |a: f64| (400.0 * ((a - 100f64.to_radians()).cos() - 1.0)).exp();
            let x = revolutions(start, bump);
            let waterfall = crank_waterfall(&x, 12).unwrap();
            assert_eq!(waterfall.rms.len(), 12 * x.count());
            let rms = waterfall.sector_rms();
            for (s, value) in rms.iter().enumerate() {
                assert!(
                    (*value > 0.3) == (s == 3),
                    "start {start}, sector {s}: {value}"
                );
            }
            let whole = x.samples().iter().map(|x| x * x).sum::<f64>() / x.samples().len() as f64;
            let mean = rms.iter().map(|r| r * r).sum::<f64>() / 12.0;
            assert!((mean - whole).abs() < 1e-12);
        }
    }

    /// A sine over whole periods has kurtosis 3/2 and RMS 1/√2; a constant has no kurtosis.
    #[test]
    fn sine_in_every_sector_has_its_closed_form() {
        let sine = crank_waterfall(&revolutions(0.0, |a| (24.0 * a).sin()), 12).unwrap();
        let inner = 12..36;
        for (rms, kurtosis) in sine.rms[inner.clone()].iter().zip(&sine.kurtosis[inner]) {
            assert!((rms - 0.5f64.sqrt()).abs() < 1e-6);
            assert!((kurtosis.unwrap() - 1.5).abs() < 1e-6);
        }
        let still = crank_waterfall(&revolutions(0.0, |_| 0.0), 12).unwrap();
        assert!(still.kurtosis.iter().all(Option::is_none));
    }

    #[test]
    fn bad_sectors_are_refused() {
        let x = revolutions(0.0, f64::cos);
        assert!(crank_waterfall(&x, 0).is_err());
        assert!(crank_waterfall(&x, 121).is_err());
        assert!(crank_waterfall(&x, 120).is_ok());
    }
}
