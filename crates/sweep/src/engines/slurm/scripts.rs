//! The batch scripts.

use super::submitted::Submitted;
use crate::engines::Error;
use recordings::shell;
use std::path::Path;

/// How often a task begins its shard: three times as usual, three times case by case, and once
/// without the case that ended the six before.
const BEGINNINGS: u64 = 7;

/// The script of an array of shards.
pub(super) fn shard(submitted: &Submitted, url: &Path) -> Result<String, Error> {
    let beginnings: Vec<String> = (1..=BEGINNINGS).map(|n| n.to_string()).collect();
    let (program, url) = (word(&submitted.program)?, word(url)?);
    Ok(format!(
            "{}# Makes shard $1 + SLURM_ARRAY_TASK_ID. A process that a signal ended begins again here: if it dies of
# one of its cases, that case is found and left out. 130 is a process that was asked to end, and does not begin again.
for beginning in {}; do
    {program} sweep shard {url} --offset \"$1\" --threads \"${{SLURM_CPUS_PER_TASK:-1}}\"
    status=$?
    [ $status -gt 128 ] && [ $status -ne 130 ] || exit $status
done
exit $status
",
            header(submitted),
            beginnings.join(" "),
        ))
}

/// The script of the job that completes the dataset.
pub(super) fn finalize(submitted: &Submitted, url: &Path, scripts: &Path) -> Result<String, Error> {
    let (program, url) = (word(&submitted.program)?, word(url)?);
    Ok(format!(
        "{}# Completes the dataset, or submits what is missing.
exec {program} sweep finalize {url} --resubmit --scripts {}
",
        header(submitted),
        word(scripts)?,
    ))
}

/// How a batch script begins. The path of its log is on the command line: the lines of a script cannot carry
/// every path.
fn header(submitted: &Submitted) -> String {
    format!(
        "#!/bin/sh
#SBATCH --job-name={}
#SBATCH --open-mode=append
#SBATCH --requeue
",
        job_name(submitted),
    )
}

fn job_name(submitted: &Submitted) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
    submitted.name.chars().map(plain).collect()
}

/// A path as a word of the shell.
///
/// # Errors
/// One that is not text, or ends at a NUL character where it is written into a script.
fn word(path: &Path) -> Result<String, Error> {
    let text = path.to_str().filter(|text| !text.contains('\0'));
    let text = text.ok_or_else(|| Error::Path(path.to_owned()))?;
    Ok(shell::word(text))
}
