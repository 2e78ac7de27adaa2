//! Slurm: job arrays make the shards, and a job that waits for their end completes the dataset.
//!
//! It waits by `afterany`: `afterok` never comes true once a task has failed, even if it was queued
//! again and succeeded. It looks itself whether all is there.

use crate::Failure;
use recordings::{WholeFile, shell};
use serde::{Deserialize, Serialize};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use sweep::ranges::ranges;

/// The files in the folder of the jobs' scripts.
const SHARD: &str = "shard.sh";
const FINALIZE: &str = "finalize.sh";
const SUBMITTED: &str = "submitted.json";
/// How often shards are submitted in all.
const ROUNDS: u64 = 3;
/// How often a task begins its shard: three times as usual, three times case by case, and once
/// without the case that ended the six before.
const BEGINNINGS: u64 = 7;

/// What was submitted: `submitted.json`.
#[derive(Serialize, Deserialize)]
struct Submitted {
    name: String,
    program: PathBuf,
    array_size: u64,
    flags: Vec<String>,
    round: u64,
    jobs: Vec<JobId>,
}

/// The number of a job as Slurm writes it: `1234`, of an array's task `1234_5`, of a part of a
/// heterogeneous job `1234+1`. The record of the jobs stands in a folder that others may write to, and nothing else
/// from there is handed to Slurm's programs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
struct JobId(String);

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
fn joined(jobs: &[JobId], between: &str) -> String {
    let numbers: Vec<&str> = jobs.iter().map(|job| job.0.as_str()).collect();
    numbers.join(between)
}

/// The jobs of a dataset.
pub(super) struct Jobs {
    /// The dataset, as the commands of the jobs name it.
    url: PathBuf,
    /// The folder of their scripts, logs and records.
    scripts: PathBuf,
}

impl Jobs {
    /// The jobs of the dataset at `url`, with their scripts in the folder that is given, or in the dataset's
    /// own.
    ///
    /// # Errors
    /// A bucket without such a folder: it can hold neither scripts nor logs.
    pub fn of(url: &Path, scripts: Option<&Path>) -> Result<Self, Failure> {
        let absolute = |path: &Path| std::path::absolute(path).map_err(Failure::work);
        if url.starts_with("s3:") {
            let Some(scripts) = scripts else {
                return Err(Failure::input(format!(
                    "{}: scripts and logs of the jobs need a folder that all machines see: give --scripts DIR",
                    url.display()
                )));
            };
            let (url, scripts) = (url.to_owned(), absolute(scripts)?);
            return Ok(Self { url, scripts });
        }
        let url = absolute(url)?;
        let scripts = match scripts {
            Some(scripts) => absolute(scripts)?,
            None => url.join("_sweep/slurm"),
        };
        Ok(Self { url, scripts })
    }

    /// Submits the shards `missing` of the dataset, which is called `name`.
    ///
    /// # Errors
    /// Jobs that are under way already, or an sbatch that refuses.
    pub fn submit(
        &self,
        name: &str,
        missing: &[u64],
        array_size: u64,
        flags: &[String],
    ) -> Result<(), Failure> {
        if let Some(job) = self.under_way().first() {
            return Err(Failure::input(format!(
                "job {job} of this dataset is still there: `crosshead sweep cancel` takes it back"
            )));
        }
        std::fs::create_dir_all(&self.scripts)
            .map_err(|error| Failure::unwritten(&self.scripts, error))?;
        let submitted = Submitted {
            name: name.to_owned(),
            program: std::env::current_exe().map_err(Failure::work)?,
            array_size,
            flags: flags.to_vec(),
            round: 1,
            jobs: Vec::new(),
        };
        self.write(SHARD, &self.shard_script(&submitted)?)?;
        self.write(FINALIZE, &self.finalize_script(&submitted)?)?;
        self.submit_round(submitted, missing)
    }

    /// Submits what is still missing, unless that has been done often enough.
    ///
    /// # Errors
    /// Nothing submitted before, or an sbatch that refuses.
    pub fn submit_again(&self, missing: &[u64]) -> Result<(), Failure> {
        let mut submitted = self.submitted()?;
        if submitted.round >= ROUNDS {
            let text = format!(
                "submitted {ROUNDS} times, and no more; still missing: {}",
                ranges(missing)
            );
            return Err(Failure::Incomplete(text));
        }
        submitted.round += 1;
        self.submit_round(submitted, missing)
    }

    /// The jobs that Slurm still has, with their states.
    pub fn under_way(&self) -> Vec<String> {
        let Ok(submitted) = self.submitted() else {
            return Vec::new();
        };
        // Slurm forgets jobs, and then says so of each; those are over.
        let state = |job: &JobId| {
            let arguments = [
                "--noheader",
                "--states=PD,R,CG,S,RQ",
                "--format=%i %T %r",
                &format!("--jobs={}", job.0),
            ];
            let lines = run("squeue", arguments.map(String::from).into_iter());
            let lines = lines.unwrap_or_default();
            lines.lines().map(str::to_owned).collect::<Vec<_>>()
        };
        submitted.jobs.iter().flat_map(state).collect()
    }

    /// Cancels all jobs.
    ///
    /// # Errors
    /// Nothing submitted, or an scancel that refuses.
    pub fn cancel(&self) -> Result<(), Failure> {
        let jobs = self.submitted()?.jobs;
        // The last one is that which would submit again.
        let numbers = jobs.iter().rev().map(|job| job.0.clone());
        run("scancel", ["--".to_owned()].into_iter().chain(numbers))?;
        println!("cancelled: {}", joined(&jobs, " "));
        Ok(())
    }

    fn submit_round(&self, mut submitted: Submitted, missing: &[u64]) -> Result<(), Failure> {
        submitted.jobs.clear();
        let array_size = submitted.array_size.max(1);
        let script = |name: &str| self.scripts.join(name).display().to_string();
        for shards in missing.chunk_by(|a, b| a / array_size == b / array_size) {
            let offset = shards[0] / array_size * array_size;
            let tasks: Vec<u64> = shards.iter().map(|shard| shard - offset).collect();
            let array = [format!("--array={}", ranges(&tasks))];
            let script = [script(SHARD), offset.to_string()];
            let logs = self.scripts.join("%A_%a.log");
            let job = sbatch(&submitted, &logs, array.into_iter(), script)?;
            submitted.jobs.push(job);
            self.record(&submitted)?;
        }
        let after = (!submitted.jobs.is_empty()).then(|| joined(&submitted.jobs, ":"));
        let after = after.map(|jobs| format!("--dependency=afterany:{jobs}"));
        let script = [script(FINALIZE), String::new()];
        let logs = self.scripts.join("%j-finalize.log");
        let job = sbatch(&submitted, &logs, after.into_iter(), script)?;
        submitted.jobs.push(job);
        self.record(&submitted)?;
        println!(
            "{} shards submitted: jobs {}",
            missing.len(),
            joined(&submitted.jobs, " ")
        );
        Ok(())
    }

    fn shard_script(&self, submitted: &Submitted) -> Result<String, Failure> {
        let beginnings: Vec<String> = (1..=BEGINNINGS).map(|n| n.to_string()).collect();
        let (program, url) = (word(&submitted.program)?, word(&self.url)?);
        Ok(format!(
            "{}# Makes shard $1 + SLURM_ARRAY_TASK_ID. A process that a signal ended begins again here: if it dies of
# one of its cases, that case is found and left out.
for beginning in {}; do
    {program} sweep shard {url} --offset \"$1\" --threads \"${{SLURM_CPUS_PER_TASK:-1}}\"
    status=$?
    [ $status -gt 128 ] || exit $status
done
exit $status
",
            header(submitted),
            beginnings.join(" "),
        ))
    }

    fn finalize_script(&self, submitted: &Submitted) -> Result<String, Failure> {
        let (program, url) = (word(&submitted.program)?, word(&self.url)?);
        Ok(format!(
            "{}# Completes the dataset, or submits what is missing.
exec {program} sweep finalize {url} --resubmit --scripts {}
",
            header(submitted),
            word(&self.scripts)?,
        ))
    }

    fn submitted(&self) -> Result<Submitted, Failure> {
        let path = self.scripts.join(SUBMITTED);
        let failed = |error: String| {
            let path = path.display();
            Failure::input(format!("nothing was submitted from here ({path}: {error})"))
        };
        let text = files::read_text(&path, files::LONGEST_TEXT);
        let text = text.map_err(|error| failed(error.to_string()))?;
        serde_json::from_str(&text).map_err(|error| failed(error.to_string()))
    }

    fn record(&self, submitted: &Submitted) -> Result<(), Failure> {
        let text = serde_json::to_string_pretty(submitted).map_err(Failure::work)?;
        self.write(SUBMITTED, &text)
    }

    fn write(&self, name: &str, text: &str) -> Result<(), Failure> {
        let under_way = format!("{name}.{}.part", std::process::id());
        let mut file = WholeFile::create(&self.scripts.join(under_way), &self.scripts.join(name))
            .map_err(Failure::work)?;
        file.write_all(text.as_bytes()).map_err(Failure::work)?;
        file.commit().map_err(Failure::work).map(|_| ())
    }
}

/// How a batch script begins. Where it logs to is told on the command line: the lines of a script cannot carry
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

/// Submits a job that logs to `logs`, whose last part is a pattern of sbatch, unless the user's flags say
/// another place.
fn sbatch(
    submitted: &Submitted,
    logs: &Path,
    own: impl Iterator<Item = String>,
    script: [String; 2],
) -> Result<JobId, Failure> {
    let folder = logs.parent().map(|folder| folder.display().to_string());
    let name = logs.file_name().unwrap_or_default().to_string_lossy();
    // A percent sign begins a pattern, twice it is itself.
    let folder = folder.unwrap_or_default().replace('%', "%%");
    let arguments = ["--parsable".to_owned(), format!("--output={folder}/{name}")].into_iter();
    let arguments = arguments.chain(submitted.flags.iter().cloned()).chain(own);
    let answer = run("sbatch", arguments.chain(script))?;
    // The number, and on a federation of clusters a name after a semicolon.
    let job = answer.trim().split(';').next().unwrap_or_default();
    JobId::try_from(job.to_owned()).map_err(|reason| Failure::work(format!("sbatch: {reason}")))
}

/// What a program of Slurm prints.
fn run(program: &str, arguments: impl Iterator<Item = String>) -> Result<String, Failure> {
    let output = Command::new(program).args(arguments).output();
    let output = output.map_err(|error| Failure::work(format!("cannot run {program}: {error}")))?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    let message = String::from_utf8_lossy(&output.stderr);
    Err(Failure::work(format!("{program}: {}", message.trim())))
}

fn job_name(submitted: &Submitted) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
    submitted.name.chars().map(plain).collect()
}

/// A path as a word of the shell.
///
/// # Errors
/// One that is not text, or ends at a NUL character where it is written into a script.
fn word(path: &Path) -> Result<String, Failure> {
    let text = path.to_str().filter(|text| !text.contains('\0'));
    let text = text.ok_or_else(|| {
        let path = path.display();
        Failure::input(format!(
            "{path}: a path in a job's script must be text in UTF-8"
        ))
    })?;
    Ok(shell::word(text))
}
