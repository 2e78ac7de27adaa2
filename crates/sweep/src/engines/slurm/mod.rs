//! Slurm: job arrays make the shards, and a job that waits for their end completes the dataset.
//!
//! It waits by `afterany`: `afterok` never comes true once a task has failed, even if it was queued
//! again and succeeded. It looks itself whether all is there.

mod programs;
mod scripts;
mod submitted;

use super::Error;
use crate::ranges::ranges;
use programs::{run, sbatch};
use recordings::WholeFile;
use std::fmt::{self, Display};
use std::io::{self, Write};
use std::path::{Path, PathBuf, absolute};
pub(super) use submitted::ROUNDS;
use submitted::{JobId, Submitted, joined};

/// The files in the folder of the jobs' scripts.
const SHARD: &str = "shard.sh";
const FINALIZE: &str = "finalize.sh";
const SUBMITTED: &str = "submitted.json";

/// What was submitted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Submission {
    /// How many shards.
    pub shards: usize,
    /// The numbers of the jobs.
    pub jobs: String,
}

impl Display for Submission {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { shards, jobs } = self;
        write!(f, "{shards} shards submitted: jobs {jobs}")
    }
}

/// The jobs of a dataset.
pub struct Jobs {
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
    pub fn new(url: &Path, scripts: Option<&Path>) -> Result<Self, Error> {
        let url = match url.starts_with("s3:") {
            true if scripts.is_none() => return Err(Error::NoScripts(url.to_owned())),
            true => url.to_owned(),
            false => absolute(url)?,
        };
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
    ) -> Result<Submission, Error> {
        if let Some(job) = self.under_way().first() {
            return Err(Error::UnderWay(job.clone()));
        }
        std::fs::create_dir_all(&self.scripts).map_err(|error| {
            let path = self.scripts.clone();
            Error::Folder { path, error }
        })?;
        let submitted = Submitted {
            name: name.to_owned(),
            program: crate::program::path()?,
            array_size,
            flags: flags.to_vec(),
            round: 1,
            jobs: Vec::new(),
        };
        self.write(SHARD, &scripts::shard(&submitted, &self.url)?)?;
        self.write(
            FINALIZE,
            &scripts::finalize(&submitted, &self.url, &self.scripts)?,
        )?;
        self.submit_round(submitted, missing)
    }

    /// Submits what is still missing, unless that has been done often enough.
    ///
    /// # Errors
    /// Nothing submitted before, or an sbatch that refuses.
    pub fn submit_again(&self, missing: &[u64]) -> Result<Submission, Error> {
        let mut submitted = self.submitted()?;
        if submitted.round >= ROUNDS {
            return Err(Error::Missing(missing.to_vec()));
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

    /// Cancels all jobs, and returns their numbers.
    ///
    /// # Errors
    /// Nothing submitted, or an scancel that refuses.
    pub fn cancel(&self) -> Result<String, Error> {
        let jobs = self.submitted()?.jobs;
        // The last one is that which would submit again.
        let numbers = jobs.iter().rev().map(|job| job.0.clone());
        run("scancel", ["--".to_owned()].into_iter().chain(numbers))?;
        Ok(joined(&jobs, " "))
    }

    fn submit_round(&self, mut submitted: Submitted, missing: &[u64]) -> Result<Submission, Error> {
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
        Ok(Submission {
            shards: missing.len(),
            jobs: joined(&submitted.jobs, " "),
        })
    }

    fn submitted(&self) -> Result<Submitted, Error> {
        let path = self.scripts.join(SUBMITTED);
        let failed = |reason: String| Error::NotSubmitted {
            path: path.clone(),
            reason,
        };
        let text = files::read_text(&path, files::LONGEST_TEXT);
        let text = text.map_err(|error| failed(error.to_string()))?;
        serde_json::from_str(&text).map_err(|error| failed(error.to_string()))
    }

    fn record(&self, submitted: &Submitted) -> Result<(), Error> {
        let text = serde_json::to_string_pretty(submitted).map_err(io::Error::from)?;
        self.write(SUBMITTED, &(text + "\n"))
    }

    fn write(&self, name: &str, text: &str) -> Result<(), Error> {
        let under_way = format!("{name}.{}.part", std::process::id());
        let mut file = WholeFile::create(&self.scripts.join(under_way), &self.scripts.join(name))?;
        file.write_all(text.as_bytes())?;
        file.commit()?;
        Ok(())
    }
}
