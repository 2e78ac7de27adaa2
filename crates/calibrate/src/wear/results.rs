//! What an estimation of wear finds: the content of `wear.json`.
//!
//! Values are SI, clearances are radial unless their key says otherwise, misfits are in standard deviations of the noise:
//! 1 is noise alone. The same inputs give the same bytes.

use crate::earlier::Outcome;
use crate::error::Error;
use crate::results::{ByName, Estimate};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Decimals of a millimetre that are shown at most.
const MOST_DECIMALS: f64 = 7.0;

/// Name of the file of results.
pub const WEAR: &str = "wear.json";

/// How worn each joint is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Results {
    /// False where the search was stopped before its end.
    pub complete: bool,
    /// Digest of the inputs: the recordings, the machine, what is asked for and the version of this program.
    #[serde(default)]
    pub fingerprint: String,
    /// Evaluations of the model, all runs being one.
    pub evaluations: u64,
    /// A joint counts as worn from this many times its normal clearance.
    pub worn_from: f64,
    /// The joints, by path.
    pub joints: ByName<JointWear>,
    /// Pairs of joints whose clearances are strongly correlated.
    pub together: Vec<Together>,
    /// Whether the model explains the recordings.
    pub model_is_adequate: bool,
    /// What the intervals of the clearances include.
    pub interval: Interval,
    /// Size of the model's discrepancy as an error of timing, where the intervals include it, rad.
    pub timing_rad: Option<f64>,
    /// Where the contact parameters come from.
    pub contact: Contact,
    /// The misfits over the runs.
    pub fit: Misfits,
    /// The runs.
    pub runs: ByName<RunMisfit>,
    /// Runs that were not compared: their motion does not repeat itself, and that of others does.
    #[serde(default)]
    pub scattering_runs: Vec<String>,
    /// The crank angle at which the pulse of a tacho was found to come, by run, where its place was not known, rad.
    #[serde(default)]
    pub pulse_angles_rad: ByName<f64>,
    /// Columns of the channels that were compared.
    pub channels: Vec<String>,
    /// What was fitted beside the clearances, by path.
    pub parameters: ByName<Estimate>,
}

impl Outcome for Results {
    const FILE: &str = WEAR;
    const NAME: &str = "an estimation of wear";

    fn fingerprint(&self) -> &str {
        &self.fingerprint
    }

    fn is_complete(&self) -> bool {
        self.complete
    }
}

/// How worn a joint is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JointWear {
    /// The verdict.
    pub verdict: Verdict,
    /// Why.
    pub reason: String,
    /// The radial clearance that was found, m; none where it is ideal or not identifiable.
    pub clearance_m: Option<f64>,
    /// The lower end of its 95 % interval, where it has one.
    pub low_m: Option<f64>,
    /// The upper end.
    pub high_m: Option<f64>,
    /// Twice the radial clearance.
    pub diametral_clearance_m: Option<f64>,
    /// The clearance in the machine file; none where the joint is ideal there.
    pub healthy_m: Option<f64>,
    /// The clearance from which it counts as worn.
    pub worn_from_m: f64,
}

impl JointWear {
    /// Decimals of a millimetre in which the ends of the interval differ by two digits; four where it is wider, or there
    /// is none.
    pub fn decimals_mm(&self) -> usize {
        let width_mm = self
            .low_m
            .zip(self.high_m)
            .map(|(low, high)| 1e3 * (high - low));
        let decimals = width_mm.map_or(0.0, |width| 1.0 - width.log10().floor());
        decimals.clamp(4.0, MOST_DECIMALS) as usize
    }
}

/// The verdict on a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The clearance is below that of a worn joint.
    Healthy,
    /// It is above.
    Worn,
    /// The interval includes the clearance from which the joint counts as worn, or there is none.
    Unclear,
    /// The recordings do not determine the clearance.
    NotIdentifiable,
}

impl Verdict {
    /// The verdict in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Healthy => "healthy",
            Self::Worn => "worn",
            Self::Unclear => "unclear",
            Self::NotIdentifiable => "not identifiable",
        }
    }
}

/// What the intervals of the clearances include.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Interval {
    /// The noise of the recordings.
    Noise,
    /// Noise, and a discrepancy of the model.
    Discrepancy,
    /// Noise, and the scatter of a motion that does not repeat itself.
    Scatter,
    /// There is no interval.
    None,
}

/// Where the contact parameters come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Contact {
    /// From the machine file, by its relation between clearances.
    MachineFile,
    /// They were fitted with the clearances, or how they follow the clearance was.
    Fitted,
}

/// Two joints whose clearances are strongly correlated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Together {
    /// Their paths.
    pub joints: [String; 2],
    /// Correlation of the logarithms of their clearances.
    pub correlation: f64,
}

/// Root mean squares of the runs' misfits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Misfits {
    /// What they are in.
    pub unit: String,
    /// What noise alone leaves.
    pub noise_floor: f64,
    /// With the clearances of the machine file.
    pub healthy: f64,
    /// With those that were found.
    pub estimated: f64,
}

/// The misfits of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunMisfit {
    /// With the clearances of the machine file.
    pub healthy: f64,
    /// With those that were found.
    pub estimated: f64,
}

impl Results {
    /// Reads a file of results.
    ///
    /// # Errors
    /// A file that cannot be read, or that no estimation has written.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let wrong = |reason: String| Error::file(path, reason);
        let text = files::read_text(path, files::LONGEST_TEXT)
            .map_err(|error| wrong(error.to_string()))?;
        serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))
    }

    /// Paths of the worn joints.
    pub fn worn(&self) -> Vec<&str> {
        let joints = self.joints.iter();
        let worn = joints.filter(|(_, joint)| joint.verdict == Verdict::Worn);
        worn.map(|(path, _)| path).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_show_the_width_of_the_interval() {
        let decimals = |interval: Option<[f64; 2]>| {
            let joint = JointWear {
                verdict: Verdict::Worn,
                reason: String::new(),
                clearance_m: Some(3e-4),
                low_m: interval.map(|[low, _]| low),
                high_m: interval.map(|[_, high]| high),
                diametral_clearance_m: Some(6e-4),
                healthy_m: None,
                worn_from_m: 1.5e-4,
            };
            joint.decimals_mm()
        };
        assert_eq!(decimals(None), 4);
        assert_eq!(decimals(Some([2e-4, 4e-4])), 4);
        // 0.00008 mm wide: 0.299 96 to 0.300 04 would be its first digit.
        assert_eq!(decimals(Some([2.9996e-4, 3.0004e-4])), 6);
        assert_eq!(decimals(Some([3e-4, 3e-4])), 7);
    }
}
