//! The programs of Slurm.

use super::submitted::{JobId, Submitted};
use crate::engines::Error;
use std::path::Path;
use std::process::Command;

/// Submits a job that logs to `logs`, whose last part is a pattern of sbatch, unless the user's flags say
/// another place.
pub(super) fn sbatch(
    submitted: &Submitted,
    logs: &Path,
    own: impl Iterator<Item = String>,
    script: [String; 2],
) -> Result<JobId, Error> {
    let folder = logs.parent().map(|folder| folder.display().to_string());
    let name = logs.file_name().unwrap_or_default().to_string_lossy();
    // A percent sign begins a pattern, twice it is itself.
    let folder = folder.unwrap_or_default().replace('%', "%%");
    let arguments = ["--parsable".to_owned(), format!("--output={folder}/{name}")].into_iter();
    let arguments = arguments.chain(submitted.flags.iter().cloned()).chain(own);
    let answer = run("sbatch", arguments.chain(script))?;
    // The number, and on a federation of clusters a name after a semicolon.
    let job = answer.trim().split(';').next().unwrap_or_default();
    JobId::try_from(job.to_owned()).map_err(|message| Error::Refused {
        program: "sbatch",
        message,
    })
}

/// What a program of Slurm prints.
pub(super) fn run(
    program: &'static str,
    arguments: impl Iterator<Item = String>,
) -> Result<String, Error> {
    let output = Command::new(program).args(arguments).output();
    let output = output.map_err(|error| Error::Run { program, error })?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    let message = String::from_utf8_lossy(&output.stderr).trim().to_owned();
    Err(Error::Refused { program, message })
}
