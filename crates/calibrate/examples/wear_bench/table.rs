//! The table of cases: a row per joint.

use super::case::{Case, WORN_FROM};
use calibrate::wear::Verdict;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const HEADER: &str = "case,channels,runs,joint,true_mm,worn,verdict,estimate_mm,low_mm,high_mm,interval,contact,misfit,\
                      evaluations,seconds,command,date,version,machine";

/// A table that grows case by case.
pub struct Table {
    path: PathBuf,
    lines: Vec<String>,
    end: String,
}

impl Table {
    /// The table in this file, or a new one.
    pub fn open(path: &Path, command: String) -> Result<Self, Box<dyn Error>> {
        let text = fs::read_to_string(path).unwrap_or_else(|_| HEADER.to_owned());
        let date = Command::new("date").arg("+%F").output()?.stdout;
        let date = String::from_utf8(date)?;
        let version = env!("CARGO_PKG_VERSION");
        Ok(Self {
            path: path.to_owned(),
            lines: text.lines().map(str::to_owned).collect(),
            end: format!("{command},{},{version},\"{}\"", date.trim(), machine()),
        })
    }

    /// Adds a case, and prints its rows.
    pub fn add(&mut self, case: &Case) -> Result<(), Box<dyn Error>> {
        let results = &case.results;
        for (path, joint) in results.joints.iter() {
            let truth = case.truth.get(path).copied().unwrap_or(0.0);
            let millimetres =
                |x: Option<f64>| x.map_or(String::new(), |x| format!("{:.5}", 1e3 * x));
            let row = [
                case.name.clone(),
                results.channels.join("+"),
                case.runs.to_string(),
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
                format!("{:.0}", case.seconds),
                self.end.clone(),
            ];
            println!("{}", row[..15].join(","));
            self.lines.push(row.join(","));
        }
        fs::write(&self.path, self.lines.join("\n") + "\n")?;
        Ok(())
    }

    /// Prints the counts over all cases.
    pub fn summary(&self) {
        let rows: Vec<Vec<&str>> = self.lines[1..]
            .iter()
            .map(|l| l.split(',').collect())
            .collect();
        let worn = |row: &Vec<&str>| row[5] == "true";
        let right = |row: &Vec<&str>| {
            let expected = if worn(row) {
                Verdict::Worn
            } else {
                Verdict::Healthy
            };
            row[6] == expected.name()
        };
        let mut cases: Vec<&str> = rows.iter().map(|row| row[0]).collect();
        cases.dedup();
        let whole = |case: &&&str| rows.iter().filter(|row| row[0] == **case).all(right);
        let number = |text: &str| text.parse::<f64>().ok();
        let of_worn: Vec<_> = rows.iter().filter(|row| worn(row)).collect();
        let mut errors: Vec<f64> = of_worn
            .iter()
            .map(|row| match (number(row[4]), number(row[7])) {
                (Some(truth), Some(found)) => (found / truth - 1.0).abs(),
                _ => 1.0,
            })
            .collect();
        errors.sort_by(f64::total_cmp);
        let bounded: Vec<_> = rows
            .iter()
            .filter_map(|row| Some([number(row[4])?, number(row[8])?, number(row[9])?]))
            .filter(|[truth, ..]| *truth > 0.0)
            .collect();
        let inside = bounded
            .iter()
            .filter(|[truth, low, high]| low <= truth && truth <= high);
        println!(
            "{} cases (a joint is worn from {WORN_FROM} times its normal clearance): all joints right in {}; {} of {} joints \
             right; worn joints: {}, median error of the clearance {:.2} %; {} of {} intervals hold the truth",
            cases.len(),
            cases.iter().filter(whole).count(),
            rows.iter().filter(|row| right(row)).count(),
            rows.len(),
            of_worn.len(),
            100.0 * errors.get(errors.len() / 2).copied().unwrap_or(f64::NAN),
            inside.count(),
            bounded.len(),
        );
    }
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
