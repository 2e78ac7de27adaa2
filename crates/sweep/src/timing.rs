//! How long a sweep takes, measured on a part of it.

use std::time::Instant;

use crate::dataset::sample_diagram;
use crate::{Error, Plan, simulate_cases};

/// Cases that are simulated to measure the time: enough to keep the lanes full for most of it.
/// There are few if the motion of each is judged, which takes much longer.
const SAMPLE_CASES: u64 = 32;
const JUDGED_CASES: u64 = 3;

/// Time on one core.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// What was simulated to measure it: cases, or revolutions of diagrams.
    pub sampled: f64,
    /// Time that the sample took, s.
    pub sample_s: f64,
    /// Time that all of it takes, s.
    pub all_s: f64,
}

impl Plan {
    /// Simulates cases spread over the sweep.
    ///
    /// # Errors
    /// A case that is no machine, or fails.
    pub fn time_cases(&self) -> Result<Timing, Error> {
        let most = match self.judgement {
            Some(_) => JUDGED_CASES,
            None => SAMPLE_CASES,
        };
        let all = self.cases();
        let sample = all.min(most);
        let cases = (0..sample).map(|i| self.case(i * (all / sample)));
        let cases = cases.collect::<Result<Vec<_>, _>>()?;
        let started = Instant::now();
        for (case, recording) in cases.iter().zip(simulate_cases(&cases)) {
            recording.map_err(|error| Error::Sample {
                what: case.id.clone(),
                reason: error.to_string(),
            })?;
        }
        let sample_s = started.elapsed().as_secs_f64();
        Ok(Timing {
            sampled: sample as f64,
            sample_s,
            all_s: sample_s / sample as f64 * all as f64,
        })
    }

    /// Simulates a few revolutions of each bifurcation diagram.
    ///
    /// # Errors
    /// A diagram that fails.
    pub fn time_diagrams(&self) -> Result<Timing, Error> {
        let mut timing = Timing {
            sampled: 0.0,
            sample_s: 0.0,
            all_s: 0.0,
        };
        for diagram in &self.diagrams {
            let started = Instant::now();
            let sampled = sample_diagram(self, diagram).map_err(|error| Error::Sample {
                what: format!("bifurcation diagram {}", diagram.name),
                reason: error.to_string(),
            })?;
            let (sampled, sample_s) = (f64::from(sampled), started.elapsed().as_secs_f64());
            timing.sampled += sampled;
            timing.sample_s += sample_s;
            timing.all_s += sample_s / sampled * diagram.revolutions() as f64;
        }
        Ok(timing)
    }
}
