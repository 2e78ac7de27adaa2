//! The cases of a suspect shard are tried one by one, each in a process of its own whose parent lives
//! to see how it ends.
//!
//! 1. A process that ends by a signal of its own making (an abort, a wrong address, ...) or by a panic
//!    makes its case a failed one. So does `SIGKILL` three times while the parent lives, as the system
//!    sends it where memory runs out.
//! 2. A case whose process comes to an end is run as usual.
//! 3. Anything else (a signal from outside, a process that cannot be started) says nothing about the
//!    case, which is run as usual.
//!
//! `_sweep/attempts/K.CASE.tried` keeps how the trial of a case ended until shard K is made, so that a
//! process that is killed between two trials does not begin again.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread;
use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::attempts::{TRIED, shard_of};
use super::case_rows::{Dead, Death, Wanted, run_cases};
use super::layout::ATTEMPTS;
use super::options::{Options, Trial};
use super::output::Output;
use super::record::text;
use super::recording::Runner;
use crate::{Error, Plan};

/// So often is a process killed before its case is to blame.
const KILLS: u32 = 3;
/// How often it is looked whether a process has ended.
const GLANCE: Duration = Duration::from_millis(5);
/// Exit status of a Rust program that panicked.
const PANICKED: i32 = 101;
/// Signals that a process brings upon itself.
#[cfg(unix)]
const OWN: [(i32, &str); 5] = [
    (6, "SIGABRT"),
    (11, "SIGSEGV"),
    (if cfg!(target_os = "linux") { 7 } else { 10 }, "SIGBUS"),
    (4, "SIGILL"),
    (8, "SIGFPE"),
];

/// What `K.CASE.tried` says.
#[derive(Serialize, Deserialize)]
struct Outcome {
    /// How the process died, if it did.
    died: Option<String>,
}

/// How one process ended.
enum End {
    Passed,
    Died(String),
    Killed,
    Unknown(String),
}

/// Tries `cases` of shard `shard`. Returns those whose processes died, with the reason.
///
/// # Errors
/// [`Error::Cancelled`], or a record that cannot be read or written.
pub(super) fn try_cases(
    plan: &Plan,
    output: &Output,
    shard: u64,
    cases: &[u64],
    options: &Options,
    done: u64,
) -> Result<Dead, Error> {
    let Some(trial) = options.trial else {
        return Ok(Dead::new());
    };
    let known = known(output, shard)?;
    let mut dead = Dead::new();
    for &case in cases {
        options.check_cancelled(plan, done)?;
        let before = known.get(&case);
        // Who tries again does not believe in an earlier death.
        let before = before.filter(|died| died.is_none() || !options.retry_failed);
        let died = match before {
            Some(died) => died.clone(),
            None => {
                let died = try_case(plan, output, case, trial, options)?;
                options.check_cancelled(plan, done)?;
                let outcome = text(&Outcome { died: died.clone() })?;
                let path = format!("{ATTEMPTS}/{shard}.{case}{TRIED}");
                output.store.write(&path, outcome.as_bytes())?;
                died
            }
        };
        dead.extend(died.map(|reason| (case, Death(reason))));
    }
    Ok(dead)
}

/// How the trials of a shard ended that are over: a death, or none.
fn known(output: &Output, shard: u64) -> Result<BTreeMap<u64, Option<String>>, Error> {
    let mut known = BTreeMap::new();
    for name in output.store.names(ATTEMPTS)? {
        let case = name.strip_suffix(TRIED).and_then(|name| {
            let (_, case) = name.split_once('.')?;
            case.parse().ok()
        });
        let (Some(case), true) = (case, shard_of(&name) == Some(shard)) else {
            continue;
        };
        let found = output.store.read(&format!("{ATTEMPTS}/{name}"))?;
        let outcome = found.and_then(|found| serde_json::from_str::<Outcome>(&found).ok());
        known.extend(outcome.map(|outcome| (case, outcome.died)));
    }
    Ok(known)
}

/// Tries a case. Returns how its process died, if it did.
fn try_case(
    plan: &Plan,
    output: &Output,
    case: u64,
    trial: &Trial,
    options: &Options,
) -> Result<Option<String>, Error> {
    let id = plan.case_id(case);
    for kill in 1..=KILLS {
        let Some(command) = trial(&output.root, case) else {
            return Ok(None);
        };
        match end(command, options) {
            End::Passed => return Ok(None),
            End::Died(reason) => return Ok(Some(reason)),
            End::Unknown(why) => {
                output.say(format_args!("the trial of {id} was inconclusive: {why}"));
                return Ok(None);
            }
            End::Killed => output.say(format_args!(
                "the process of {id} was killed, {kill} of {KILLS} times"
            )),
        }
    }
    Ok(Some(format!(
        "its process, which ran nothing else, was killed {KILLS} times (SIGKILL, signal 9), as \
         happens where memory runs out"
    )))
}

/// Runs `command` to its end, or until everything is cancelled.
fn end(mut command: Command, options: &Options) -> End {
    let command = command.stdin(Stdio::piped()).stdout(Stdio::null());
    let waited = command.spawn().and_then(|mut child| {
        // As long as this stands, the child knows that its parent lives.
        let _parent = child.stdin.take();
        wait(&mut child, options)
    });
    match waited {
        Ok(status) => judged(status),
        Err(error) => End::Unknown(error.to_string()),
    }
}

fn wait(child: &mut Child, options: &Options) -> std::io::Result<ExitStatus> {
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(status);
        }
        if options.is_cancelled() {
            child.kill()?;
            return child.wait();
        }
        thread::sleep(GLANCE);
    }
}

fn judged(status: ExitStatus) -> End {
    #[cfg(unix)]
    if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&status) {
        let own = OWN.iter().find(|(number, _)| *number == signal);
        return match own {
            Some((number, name)) => {
                End::Died(format!("its process ended by {name} (signal {number})"))
            }
            None if signal == 9 => End::Killed,
            None => End::Unknown(format!("signal {signal}")),
        };
    }
    match status.code() {
        Some(0) => End::Passed,
        Some(PANICKED) => End::Died("its process panicked".into()),
        _ => End::Unknown(status.to_string()),
    }
}

/// Simulates case `case` of the dataset at `root` and throws the result away: what the command of a
/// [`Trial`] does.
///
/// # Errors
/// As [`Output::open_read_only`]. A case that fails with a message is no error.
pub fn try_here(root: &Path, case: u64, runner: &Runner) -> Result<(), Error> {
    let (_, plan) = Output::open_read_only(root)?;
    let sweep_yaml = input::yaml::to_string(plan.sweep())?;
    let wanted = Wanted::Dataset {
        sweep_yaml: &sweep_yaml,
    };
    run_cases(&plan, case..case + 1, &Dead::new(), runner, wanted);
    Ok(())
}
