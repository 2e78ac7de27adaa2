//! The table of cases: a row per joint.

use super::case::{Case, WORN_FROM};
use calibrate::wear::Verdict;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const HEADER: &str = "case,channels,runs,repeats,joint,true_mm,worn,verdict,estimate_mm,low_mm,high_mm,interval,contact,\
                      misfit,evaluations,cpu_s,command,date,version,machine";

/// A table that grows case by case.
pub struct Table {
    path: PathBuf,
    rows: Vec<Row>,
    end: String,
}

/// A line of the table: what the summary needs of it, and all of it.
struct Row {
    case: String,
    channels: String,
    repeats: bool,
    joint: String,
    true_mm: f64,
    worn: bool,
    verdict: String,
    estimate_mm: Option<f64>,
    ends_mm: Option<[f64; 2]>,
    cpu: f64,
    line: String,
}

impl Row {
    fn read(line: &str) -> Option<Self> {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |i: usize| cells.get(i)?.parse::<f64>().ok();
        Some(Self {
            case: (*cells.first()?).to_owned(),
            channels: (*cells.get(1)?).to_owned(),
            repeats: *cells.get(3)? == "true",
            joint: (*cells.get(4)?).to_owned(),
            true_mm: number(5)?,
            worn: *cells.get(6)? == "true",
            verdict: (*cells.get(7)?).to_owned(),
            estimate_mm: number(8),
            ends_mm: number(9).zip(number(10)).map(|(low, high)| [low, high]),
            cpu: number(15)?,
            line: line.to_owned(),
        })
    }

    fn is_right(&self) -> bool {
        let expected = match self.worn {
            true => Verdict::Worn,
            false => Verdict::Healthy,
        };
        self.verdict == expected.name()
    }

    /// Whether the verdict is the opposite of what is true. Neither unclear nor not identifiable is.
    fn is_wrong(&self) -> bool {
        let opposite = match self.worn {
            true => Verdict::Healthy,
            false => Verdict::Worn,
        };
        self.verdict == opposite.name()
    }
}

impl Table {
    /// The table in this file, or a new one.
    pub fn open(path: &Path, command: String) -> Result<Self, Box<dyn Error>> {
        let text = fs::read_to_string(path).unwrap_or_else(|_| HEADER.to_owned());
        let mut lines = text.lines();
        if lines.next() != Some(HEADER) {
            return Err(format!("{}: another header than '{HEADER}'", path.display()).into());
        }
        let row = |(i, line): (usize, &str)| {
            Row::read(line).ok_or_else(|| format!("{}:{}: no row", path.display(), i + 2))
        };
        let date = Command::new("date").arg("+%F").output()?.stdout;
        let date = String::from_utf8(date)?;
        let version = env!("CARGO_PKG_VERSION");
        Ok(Self {
            path: path.to_owned(),
            rows: lines.enumerate().map(row).collect::<Result<_, _>>()?,
            end: format!("{command},{},{version},\"{}\"", date.trim(), machine()),
        })
    }

    /// Whether the case of this name is there.
    pub fn has(&self, case: &str) -> bool {
        self.rows.iter().any(|row| row.case == case)
    }

    /// Adds a case, and prints its rows.
    pub fn add(&mut self, case: &Case) -> Result<(), Box<dyn Error>> {
        let results = &case.results;
        for (path, joint) in results.joints.iter() {
            let truth = case.truth.get(path).copied().unwrap_or(0.0);
            let millimetres =
                |x: Option<f64>| x.map_or(String::new(), |x| format!("{:.5}", 1e3 * x));
            let cells = [
                case.name.clone(),
                results.channels.join("+"),
                case.runs.to_string(),
                case.repeats.to_string(),
                path.to_owned(),
                millimetres(Some(truth)),
                (truth > joint.worn_from_m).to_string(),
                joint.verdict.name().to_owned(),
                millimetres(joint.clearance_m),
                millimetres(joint.low_m),
                millimetres(joint.high_m),
                format!("{:?}", results.interval).to_lowercase(),
                format!("{:?}", results.contact).to_lowercase(),
                format!("{:.3}", results.fit.estimated),
                results.evaluations.to_string(),
                format!("{:.0}", case.cpu_seconds),
            ]
            .join(",");
            println!("{cells}");
            let line = format!("{cells},{}", self.end);
            self.rows
                .push(Row::read(&line).ok_or("a cell has a comma")?);
        }
        let lines = self.rows.iter().map(|row| row.line.as_str());
        let lines: Vec<&str> = [HEADER].into_iter().chain(lines).collect();
        fs::write(&self.path, lines.join("\n") + "\n")?;
        Ok(())
    }

    /// Prints the counts over all cases, and over parts of them.
    pub fn summary(&self) {
        println!("a joint is worn from {WORN_FROM} times its normal clearance");
        let cases = self.cases();
        let own = |case: &[&Row]| case[0].case.starts_with("own");
        let worn = |case: &[&Row]| case.iter().filter(|row| row.worn).count();
        let at = |case: &[&Row], channel: &str| case[0].channels.contains(channel);
        let line = |name: &str, of: &dyn Fn(&[&Row]) -> bool| {
            counted(name, cases.iter().filter(|case| of(case)).collect());
        };
        line("another program", &|c| !own(c));
        line("own", &|c| own(c));
        for count in 0..=4 {
            line(&format!("own, {count} worn"), &|c| {
                own(c) && worn(c) == count
            });
        }
        line("own, crosshead", &|c| own(c) && at(c, "crosshead"));
        line("own, frame", &|c| own(c) && at(c, "frame"));
        line("own, with pressure", &|c| own(c) && at(c, "pressure"));
        line("own, without", &|c| own(c) && !at(c, "pressure"));
        let two = |c: &[&Row]| c.iter().any(|row| row.joint.starts_with("throws."));
        line("own, one throw", &|c| own(c) && !two(c));
        line("own, two throws", &|c| own(c) && two(c));
        line("not repeating", &|c| !c[0].repeats);
    }

    fn cases(&self) -> Vec<Vec<&Row>> {
        let mut cases: Vec<Vec<&Row>> = Vec::new();
        for row in &self.rows {
            match cases.last_mut() {
                Some(case) if case[0].case == row.case => case.push(row),
                _ => cases.push(vec![row]),
            }
        }
        cases
    }
}

/// Prints what was reached in these cases.
fn counted(name: &str, cases: Vec<&Vec<&Row>>) {
    if cases.is_empty() {
        return;
    }
    let all: Vec<&Row> = cases.iter().flat_map(|case| case.iter().copied()).collect();
    let right = cases
        .iter()
        .filter(|case| case.iter().all(|row| row.is_right()));
    let wrong = cases
        .iter()
        .filter(|case| case.iter().any(|row| row.is_wrong()));
    // A worn joint without an estimate counts as entirely off.
    let worn = all.iter().filter(|row| row.worn);
    let errors = worn.map(|row| {
        row.estimate_mm
            .map_or(1.0, |e| (e / row.true_mm - 1.0).abs())
    });
    let bounded = all.iter().filter(|row| row.true_mm > 0.0);
    let bounded: Vec<bool> = bounded
        .filter_map(|row| row.ends_mm.map(|[a, b]| (a..=b).contains(&row.true_mm)))
        .collect();
    println!(
        "{name}: {} cases, all joints right in {}, a wrong one in {}; {} of {} joints right; median error of worn joints {:.2} %; \
         {} of {} intervals hold the truth; median processor time {:.0} s",
        cases.len(),
        right.count(),
        wrong.count(),
        all.iter().filter(|row| row.is_right()).count(),
        all.len(),
        100.0 * median(errors.collect()),
        bounded.iter().filter(|inside| **inside).count(),
        bounded.len(),
        median(cases.iter().map(|case| case[0].cpu).collect()),
    );
}

fn median(mut of: Vec<f64>) -> f64 {
    of.sort_by(f64::total_cmp);
    of.get(of.len() / 2).copied().unwrap_or(f64::NAN)
}

/// The processor, and how many of it.
fn machine() -> String {
    let text = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let models = text.lines().filter(|line| line.starts_with("model name"));
    let names: Vec<&str> = models.filter_map(|line| line.split(": ").nth(1)).collect();
    format!(
        "{} {} CPUs",
        names.first().unwrap_or(&"unknown"),
        names.len()
    )
}
