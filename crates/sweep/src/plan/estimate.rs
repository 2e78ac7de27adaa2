//! How large a dataset will be.

use super::Plan;
use std::fmt::{self, Display, Formatter};

/// What a sweep amounts to, judged from a few of its cases.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Cases, repeats included.
    pub cases: u64,
    /// Rows of the tables.
    pub rows: u64,
    /// Shards.
    pub shards: u64,
    /// Revolutions to simulate, without a transient that ends when the motion settles.
    pub revolutions: f64,
    /// Bytes of all recordings before compression.
    pub bytes: f64,
}

/// What the bifurcation diagrams amount to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiagramEstimate {
    /// Diagrams.
    pub diagrams: usize,
    /// Their values, both directions counted.
    pub values: u64,
    /// Revolutions to simulate.
    pub revolutions: u64,
    /// Bytes of all points before compression.
    pub bytes: f64,
}

impl Display for Estimate {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        let (cases, rows, shards) = (self.cases, self.rows, self.shards);
        let (revolutions, megabytes) = (self.revolutions, self.bytes / 1e6);
        write!(
            f,
            "{cases} cases, {rows} rows, {shards} shards, {revolutions:.0} revolutions to simulate\n\
             recordings before compression: {megabytes:.1} MB"
        )
    }
}

impl Display for DiagramEstimate {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        let (diagrams, values, revolutions) = (self.diagrams, self.values, self.revolutions);
        let megabytes = self.bytes / 1e6;
        write!(
            f,
            "bifurcation diagrams: {diagrams}, {values} values, {revolutions} revolutions to simulate, \
             {megabytes:.1} MB before compression"
        )
    }
}

impl Plan {
    /// The size of the bifurcation diagrams.
    pub fn estimate_diagrams(&self) -> DiagramEstimate {
        let mut estimate = DiagramEstimate {
            diagrams: self.diagrams.len(),
            values: 0,
            revolutions: 0,
            bytes: 0.0,
        };
        for diagram in &self.diagrams {
            let lists = 2 * diagram.joints.len() + 3 * self.throws.len();
            let points = f64::from(diagram.settings.revolutions) * lists as f64;
            let values = (diagram.count() * diagram.directions.len()) as u64;
            estimate.values += values;
            estimate.revolutions += diagram.revolutions();
            estimate.bytes += values as f64 * points * 4.0;
        }
        estimate
    }

    /// The size of the dataset, from up to 16 cases spread over the sweep.
    pub fn estimate(&self) -> Estimate {
        let cases = self.cases();
        let looked_at = cases.min(16);
        let samples: Vec<f64> = (0..looked_at)
            .filter_map(|i| {
                self.case((u128::from(cases) * u128::from(i) / u128::from(looked_at)) as u64)
                    .ok()
            })
            .map(|case| {
                let samples = self.samples_per_revolution(case.resolved.speed);
                self.recorded_revolutions() * samples * case.resolved.sensors.len() as f64
            })
            .collect();
        let mean = samples.iter().sum::<f64>() / samples.len().max(1) as f64;
        let transient = match self.settings.transient {
            simulate::Transient::Revolutions(n) => f64::from(n),
            simulate::Transient::Settled { .. } => 0.0,
        };
        let recorded = self.settings_at(self.base.speed);
        let recorded = recorded.map_or(self.settings.revolutions, |s| s.revolutions);
        Estimate {
            cases,
            rows: cases.saturating_mul(self.windows.map_or(1, |w| w.count.get().into())),
            shards: self.shards(),
            revolutions: cases as f64 * (transient + f64::from(recorded)),
            bytes: cases as f64 * mean * 4.0,
        }
    }

    /// Revolutions of one recording that are kept.
    fn recorded_revolutions(&self) -> f64 {
        let windows = self.windows.map(|w| w.count.get() * w.revolutions.get());
        windows.unwrap_or(self.settings.revolutions).into()
    }
}
