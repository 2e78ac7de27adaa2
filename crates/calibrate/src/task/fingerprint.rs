//! The digest of a calibration's inputs.

use super::Task;
use sha2::{Digest, Sha256};

/// What `calibration.json` holds beyond the fit: one without it is made anew.
const CONTENT: &str = "converters";

impl Task {
    /// The digest of the calibration's inputs: the recordings, the machine, what is fitted and how,
    /// and the version of this program. SHA-256 in hexadecimal.
    pub fn fingerprint(&self) -> String {
        let mut hash = Sha256::new();
        let mut add = |text: &str| {
            hash.update((text.len() as u64).to_le_bytes());
            hash.update(text);
        };
        add(env!("CARGO_PKG_VERSION"));
        add(CONTENT);
        add(&self.problem.tree.to_string());
        let settings = &self.settings;
        add(&format!("{:?} {:?}", settings.optimiser, settings.seed));
        add(&format!("{:?}", settings.held_out));
        for parameter in &self.problem.parameters {
            add(&format!("{parameter:?}"));
        }
        for run in &self.runs {
            add(&format!(
                "{} {:?} {} {} {}",
                run.id, run.settings, run.speed_rpm, run.sample_rate, run.is_timed
            ));
            for channel in &run.channels {
                add(&channel.column);
            }
        }
        for run in &self.runs {
            let series = run.channels.iter().map(|channel| &channel.samples);
            for samples in run.crank_angle.iter().chain(series) {
                hash.update((samples.len() as u64).to_le_bytes());
                for x in samples {
                    hash.update(x.to_bits().to_le_bytes());
                }
            }
        }
        format!("{:x}", hash.finalize())
    }
}
