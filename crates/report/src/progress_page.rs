//! The HTML page of a sweep under way: how far it is, and the cases that failed.

use crate::Error;
use crate::refreshed::{self, Row, Shown};
use askama::Template;
use recordings::shell;
use serde::Serialize;
use std::path::Path;
use sweep::dataset::{Output, cases_per_second, status};

/// Failed cases on the page: the first ones.
const MOST_FAILED: usize = 200;

/// The content of the page.
#[derive(Clone, Debug, Serialize)]
pub struct ProgressPage {
    /// Name of the dataset.
    pub name: String,
    /// Version of the program that makes the page.
    pub version: String,
    /// All cases.
    pub cases: u64,
    /// Cases in finished shards, failed ones included.
    pub cases_done: u64,
    /// Those that failed.
    pub cases_failed: u64,
    /// Cases in one shard.
    pub shard_size: u64,
    /// Shards, and bifurcation diagrams after them.
    pub shards: u64,
    /// Those that are finished.
    pub shards_done: u64,
    /// Processes at work.
    pub at_work: u64,
    /// Cases a second over the last shards; none before the second is finished.
    pub cases_per_second: Option<f64>,
    /// Seconds until all cases are done at that rate; none without a rate or a process at work.
    pub seconds_left: Option<f64>,
    /// Whether the dataset is complete.
    pub is_complete: bool,
    /// The first of the cases that failed.
    pub failed: Vec<FailedLine>,
    /// What is wrong with records and files, which count as not made.
    pub warnings: Vec<String>,
    /// The command that continues the sweep, or completes it.
    pub next: String,
}

/// A case that failed.
#[derive(Clone, Debug, Serialize)]
pub struct FailedLine {
    /// The case.
    pub case_id: String,
    /// Why it failed.
    pub reason: String,
    /// The command that runs it alone.
    pub again: String,
}

#[derive(Template)]
#[template(path = "progress_page.html")]
struct View<'a> {
    page: &'a ProgressPage,
    facts: [(&'static str, &'static str); 6],
    shown: Shown,
}

impl View<'_> {
    /// What the script makes new rows of.
    fn blank() -> Row {
        Row::default()
    }
}

impl ProgressPage {
    /// The progress of the sweep in `folder`, by its records and the lengths of its files. Nothing is written.
    ///
    /// # Errors
    /// A folder in which no sweep was planned, or records that cannot be read.
    pub fn read(folder: &Path) -> Result<Self, Error> {
        let failed = |error: sweep::Error| Error::Progress(Box::new(error));
        let (output, plan) = Output::open_read_only(folder).map_err(failed)?;
        let found = status(&output, &plan, false).map_err(failed)?;
        let rate = cases_per_second(&output, &plan).map_err(failed)?;
        let at_work = found.attempts.iter().map(|(_, at)| at.at_work).sum();
        let left = plan.cases() - found.cases;
        let lines = found
            .failed
            .iter()
            .take(MOST_FAILED)
            .map(|case| FailedLine {
                case_id: case.case_id.clone(),
                reason: case.reason.clone(),
                again: case.command_in(folder),
            });
        let shown = shell::word(&folder.display().to_string());
        let sweep = shell::word(&folder.join("sweep.yaml").display().to_string());
        Ok(Self {
            name: plan.name.clone(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            cases: plan.cases(),
            cases_done: found.cases,
            cases_failed: found.failed.len() as u64,
            shard_size: plan.shard_size,
            shards: plan.parts(),
            shards_done: plan.parts() - found.missing.len() as u64,
            at_work,
            cases_per_second: rate,
            seconds_left: rate.filter(|_| at_work > 0).map(|rate| left as f64 / rate),
            is_complete: found.complete,
            failed: lines.collect(),
            warnings: output.take_warnings(),
            next: match (found.complete, found.missing.is_empty(), at_work) {
                (true, _, _) => format!("crosshead report {shown}"),
                (false, true, _) => format!("crosshead sweep finalize {shown}"),
                (false, false, 0) => {
                    format!("crosshead gen-dataset {sweep} --out {shown} --resume")
                }
                (false, false, _) => String::new(),
            },
        })
    }

    /// The page as one HTML file, which asks for `progress.json` beside it every few seconds.
    ///
    /// # Errors
    /// [`Error::Template`] if the template cannot be filled in.
    pub fn render(&self) -> Result<String, Error> {
        let view = View {
            page: self,
            facts: FACTS,
            shown: self.shown(),
        };
        Ok(view.render()?)
    }

    /// The content as JSON, with the texts of the page in `shown`.
    ///
    /// # Errors
    /// None in practice.
    pub fn json(&self) -> Result<String, Error> {
        refreshed::json(self, self.shown())
    }

    fn shown(&self) -> Shown {
        let count = |n: u64| text::count(n as usize);
        let unless = |is_left_out: bool, words: String| match is_left_out {
            true => String::new(),
            false => words,
        };
        let more = self.cases_failed - self.failed.len() as u64;
        let texts = [
            (
                "cases",
                format!("{} of {}", count(self.cases_done), count(self.cases)),
            ),
            ("failed", count(self.cases_failed)),
            (
                "shards",
                format!("{} of {}", count(self.shards_done), count(self.shards)),
            ),
            ("at_work", count(self.at_work)),
            (
                "rate",
                match self.cases_per_second {
                    Some(rate) => format!("{} cases/s", text::number(rate, 3)),
                    None => "not known before the second shard".to_owned(),
                },
            ),
            (
                "left",
                match self.seconds_left {
                    Some(seconds) => duration(seconds),
                    None => "–".to_owned(),
                },
            ),
            ("state", self.state()),
            ("next", self.next.clone()),
            (
                "report",
                unless(
                    !self.is_complete,
                    "The dataset is complete: its page".to_owned(),
                ),
            ),
            ("warnings", self.warnings.join("\n")),
            (
                "none_failed",
                unless(self.cases_failed > 0, "No case has failed.".to_owned()),
            ),
            (
                "more_failed",
                unless(more == 0, format!("and {} more", count(more))),
            ),
        ];
        let row = |line: &FailedLine| Row {
            id: line.case_id.clone(),
            href: String::new(),
            texts: [
                ("case", line.case_id.clone()),
                ("reason", line.reason.clone()),
                ("again", line.again.clone()),
            ]
            .into(),
        };
        Shown {
            texts: texts.into(),
            rows: self.failed.iter().map(row).collect(),
        }
    }

    fn state(&self) -> String {
        let state = match (
            self.is_complete,
            self.shards_done == self.shards,
            self.at_work,
        ) {
            (true, _, _) => "Complete.",
            (false, true, _) => "All shards are finished; the dataset is not finalized.",
            (false, false, 0) => "No process is at work.",
            (false, false, _) => "Under way.",
        };
        state.to_owned()
    }
}

/// The facts of the page: key and name.
const FACTS: [(&str, &str); 6] = [
    ("cases", "Cases done"),
    ("failed", "Failed"),
    ("rate", "Rate over the last shards"),
    ("left", "Time left"),
    ("shards", "Shards finished"),
    ("at_work", "Processes at work"),
];

/// A time in the two units that suit it.
fn duration(seconds: f64) -> String {
    let seconds = seconds.round().max(0.0) as u64;
    match (
        seconds / 86_400,
        seconds / 3600 % 24,
        seconds / 60 % 60,
        seconds % 60,
    ) {
        (0, 0, 0, s) => format!("{s} s"),
        (0, 0, m, s) => format!("{m} min {s} s"),
        (0, h, m, _) => format!("{h} h {m} min"),
        (d, h, _, _) => format!("{d} d {h} h"),
    }
}

#[cfg(test)]
mod tests {
    use super::duration;

    #[test]
    fn times_have_two_units() {
        for (seconds, expected) in [
            (0.4, "0 s"),
            (59.6, "1 min 0 s"),
            (3_725.0, "1 h 2 min"),
            (200_000.0, "2 d 7 h"),
        ] {
            assert_eq!(duration(seconds), expected);
        }
    }
}
