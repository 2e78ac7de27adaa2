//! The record of the jobs of a dataset.

use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// How often shards are submitted in all.
pub(crate) const ROUNDS: u64 = 3;

/// What was submitted: `submitted.json`.
#[derive(Serialize, Deserialize)]
pub(super) struct Submitted {
    pub(super) name: String,
    pub(super) program: PathBuf,
    pub(super) array_size: u64,
    pub(super) flags: Vec<String>,
    pub(super) round: u64,
    pub(super) jobs: Vec<JobId>,
}

/// The number of a job as Slurm writes it: `1234`, of an array's task `1234_5`, of a part of a
/// heterogeneous job `1234+1`. The record of the jobs stands in a folder that others may write to, and nothing else
/// from there is handed to Slurm's programs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub(super) struct JobId(pub(super) String);

impl TryFrom<String> for JobId {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let is_number = |part: &str| !part.is_empty() && part.bytes().all(|b| b.is_ascii_digit());
        match text.split(['_', '+']).all(is_number) {
            true => Ok(Self(text)),
            false => Err(format!(
                "found '{text}', expected the number of a job, as 1234 or 1234_5"
            )),
        }
    }
}

impl From<JobId> for String {
    fn from(id: JobId) -> Self {
        id.0
    }
}

/// The numbers of jobs, with `between` between them.
pub(super) fn joined(jobs: &[JobId], between: &str) -> String {
    let numbers: Vec<&str> = jobs.iter().map(|job| job.0.as_str()).collect();
    numbers.join(between)
}
