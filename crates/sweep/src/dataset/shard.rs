//! The files of one shard: a fixed range of cases, one file per table and split.

use std::collections::BTreeMap;

use recordings::formats::parquet::{PENDING_ROWS, TableWriter};
use recordings::{CaseWarning, Column, FailedCase, FileEntry, Kind, Schema, Value};

use super::case_rows::{CaseRows, Signals};
use super::check::Check;
use super::commit::{Commit, Found, Standing};
use super::layout::DIAGRAMS;
use super::output::Output;
use super::store::NewFile;
use super::tables::Tables;
use crate::split::Split;
use crate::sweep_file::Format;
use crate::{Error, Plan};

/// Bytes of a row group before compression: 4 MiB. Each table and split has one group in memory. A
/// group of a table with some hundred numbers then has some hundred rows, so the metadata of a
/// column and group (some 150 bytes) is small.
const BYTES_PER_GROUP: f64 = 4.0 * 1024.0 * 1024.0;

/// The name of the file of a table with the rows of a split and a shard.
fn table_name(folder: &str, split: Split, shard: u64, shards: u64) -> String {
    format!(
        "{folder}/{}-{shard:05}-of-{shards:05}.parquet",
        split.name()
    )
}

impl Plan {
    /// The names of the Parquet files of shard `shard`.
    pub(super) fn tables_of(&self, shard: u64) -> impl Iterator<Item = String> {
        let folders: &[&str] = match self.format {
            Format::Parquet => &["signals", "features"],
            Format::Mcap => &["features"],
        };
        let splits = Split::ALL.into_iter().zip(self.shares);
        let splits = splits.filter(|(_, share)| *share > 0.0);
        let shards = self.shards();
        splits.flat_map(move |(split, _)| {
            let names = folders.iter();
            names.map(move |folder| table_name(folder, split, shard, shards))
        })
    }

    /// Whether a shard or a diagram of this plan writes the file `path`.
    pub(super) fn names(&self, path: &str) -> bool {
        let number = |name: &str, mark: char| -> Option<u64> {
            let digits = name.split_once(mark)?.1;
            let end = digits.find(|c: char| !c.is_ascii_digit());
            digits[..end.unwrap_or(digits.len())].parse().ok()
        };
        let Some((folder, name)) = path.split_once('/') else {
            return false;
        };
        match folder {
            "signals" | "features" => number(name, '-').is_some_and(|shard| {
                shard < self.shards() && self.tables_of(shard).any(|own| own == path)
            }),
            "mcap" => number(name, '-').is_some_and(|case| {
                case < self.cases()
                    && self.format == Format::Mcap
                    && *name == format!("{}.mcap", self.case_id(case))
            }),
            DIAGRAMS => {
                let mut own = self.diagrams.iter();
                own.any(|diagram| *name == format!("{}.parquet", diagram.name))
            }
            _ => false,
        }
    }
}

/// The files of a shard while its cases come in.
pub(super) struct ShardWriter<'a> {
    output: &'a Output,
    signals: BTreeMap<Split, PartFile>,
    features: BTreeMap<Split, PartFile>,
    commit: Commit,
}

/// One file of a table.
struct PartFile {
    path: String,
    table: TableWriter<NewFile>,
}

impl<'a> ShardWriter<'a> {
    /// Starts shard `shard` of `plan`.
    pub(super) fn new(
        output: &'a Output,
        plan: &Plan,
        tables: &Tables,
        shard: u64,
    ) -> Result<Self, Error> {
        let splits = Split::ALL.into_iter().zip(plan.shares);
        let splits = || splits.clone().filter(|(_, share)| *share > 0.0);
        let part = |folder: &str, schema: &Schema, split: Split| {
            let path = table_name(folder, split, shard, plan.shards());
            let rows_per_group = rows_per_group(schema, plan.samples_per_window());
            let table = TableWriter::new(output.store.create(&path)?, schema, rows_per_group)?;
            Ok::<_, Error>((split, PartFile { path, table }))
        };
        let cases = plan.shard(shard);
        Ok(Self {
            output,
            signals: match plan.format {
                Format::Parquet => splits()
                    .map(|(split, _)| part("signals", &tables.signals, split))
                    .collect::<Result<_, _>>()?,
                Format::Mcap => BTreeMap::new(),
            },
            features: splits()
                .map(|(split, _)| part("features", &tables.features, split))
                .collect::<Result<_, _>>()?,
            commit: Commit {
                plan_id: plan.id.clone(),
                shard,
                cases: [cases.start, cases.end],
                files: Vec::new(),
                rows: BTreeMap::new(),
                failed: Vec::new(),
                warnings: Vec::new(),
            },
        })
    }

    /// Appends a case. Cases come in the order of their indices.
    pub(super) fn write(&mut self, case: Result<CaseRows, FailedCase>) -> Result<(), Error> {
        let case = match case {
            Ok(case) => case,
            Err(failed) => {
                let (command, reason) = (failed.command_in(&self.output.root), &failed.reason);
                self.output.say(format_args!(
                    "{} failed: {reason}; again: {command}",
                    failed.case_id
                ));
                self.commit.failed.push(failed);
                return Ok(());
            }
        };
        for warning in case.warnings {
            let case_id = case.case_id.clone();
            self.output.say(format_args!("{case_id}: {warning}"));
            self.commit.warnings.push(CaseWarning { case_id, warning });
        }
        let faults = self
            .commit
            .rows
            .entry(case.split.name().into())
            .or_default();
        *faults.entry(case.fault).or_default() += case.features.len() as u64;
        match case.signals {
            Signals::Rows(rows) => write_rows(&mut self.signals, case.split, rows)?,
            Signals::Mcap(bytes) => {
                let path = format!("mcap/{}.mcap", case.case_id);
                let record = self.output.store.write(&path, &bytes)?;
                self.commit.files.push(entry(path, record, None));
            }
        }
        write_rows(&mut self.features, case.split, case.features)
    }

    /// Finishes the files and says so. Where another process did so meanwhile, its files stay, and
    /// must be the same; but for those of a result that this one stands against.
    pub(super) fn commit(self, plan: &Plan, retried: bool) -> Result<(), Error> {
        let mut commit = self.commit;
        let mut files = Vec::new();
        for part in self
            .signals
            .into_values()
            .chain(self.features.into_values())
        {
            let rows = part.table.rows();
            let file = part.table.finish()?;
            commit
                .files
                .push(entry(part.path, file.record(), Some(rows)));
            files.push(file);
        }
        commit.files.sort_by(|a, b| a.path.cmp(&b.path));
        publish(&commit, files, self.output, plan, retried)
    }
}

/// Gives the files of a shard their names, and then writes its record, as far as no other result
/// stands.
fn publish(
    commit: &Commit,
    files: Vec<NewFile>,
    output: &Output,
    plan: &Plan,
    retried: bool,
) -> Result<(), Error> {
    let place = || {
        files
            .into_iter()
            .try_for_each(|file| file.commit().map(|_| ()))
    };
    // Who may replace another's files, or may be replaced, does so alone.
    let mut alone = commit.has_deaths();
    loop {
        let _committing = output.committing(alone)?;
        let before = match Commit::find(output, plan, commit.shard, Check::Sums)? {
            Found::Made(before) => before,
            Found::Damaged => {
                place()?;
                return commit.replace(output);
            }
            Found::Nothing => {
                place()?;
                let Some(before) = commit.create(output, plan)? else {
                    return Ok(());
                };
                // It was written meanwhile, from the same files.
                return match commit.against(&before, retried) {
                    Standing::Same | Standing::Before => Ok(()),
                    Standing::New => commit.replace(output),
                    Standing::Differ => Err(commit.differs(&before)?),
                };
            }
        };
        match commit.against(&before, retried) {
            Standing::Same | Standing::Before => return Ok(()),
            Standing::Differ => return Err(commit.differs(&before)?),
            Standing::New if alone => {
                place()?;
                return commit.replace(output);
            }
            Standing::New => alone = true,
        }
    }
}

fn entry(path: String, record: recordings::FileRecord, rows: Option<u64>) -> FileEntry {
    FileEntry {
        path,
        bytes: record.bytes,
        sha256: record.sha256,
        rows,
    }
}

fn write_rows(
    parts: &mut BTreeMap<Split, PartFile>,
    split: Split,
    rows: Vec<Vec<Value>>,
) -> Result<(), Error> {
    if let Some(part) = parts.get_mut(&split) {
        for row in rows {
            part.table.write(row)?;
        }
    }
    Ok(())
}

/// Rows of one row group of a table with these columns: as many as fit its size, where a recording
/// has so many samples, and at most as many as the writer collects.
pub(super) fn rows_per_group(schema: &Schema, samples: f64) -> usize {
    let bytes = |column: &Column| match column.kind {
        Kind::Samples => 4.0 * samples,
        Kind::Text | Kind::Integer | Kind::Real => 8.0,
        Kind::Flag => 1.0,
    };
    let row: f64 = schema.columns().iter().map(bytes).sum();
    (BYTES_PER_GROUP / row.max(1.0)).clamp(1.0, PENDING_ROWS as f64) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn row_groups_are_sized_by_the_table() {
        let table = |kind, count| {
            let columns = (0..count).map(|i| Column::new(format!("c{i}"), kind, ""));
            Schema::new(columns.collect()).unwrap()
        };
        // Four channels of 24 000 samples: 384 kB a row.
        assert_eq!(rows_per_group(&table(Kind::Samples, 4), 24e3), 10);
        // 500 features: 4 kB a row, however long the recordings are.
        assert_eq!(rows_per_group(&table(Kind::Real, 500), 24e3), 1048);
        assert_eq!(rows_per_group(&table(Kind::Samples, 1), 1e9), 1);
        assert_eq!(rows_per_group(&table(Kind::Flag, 1), 1.0), 4096);
    }
}
