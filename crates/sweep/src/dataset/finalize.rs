//! What makes a dataset complete: `README.md`, `croissant.json`, `sweep.yaml`, `SHA256SUMS` and, last, `manifest.json`.

use std::collections::BTreeMap;

use recordings::{CaseWarning, ColumnEntry, Counts, FailedCase, FileEntry, Manifest, croissant};

use super::attempts;
use super::card::{Rows, card};
use super::check::Check;
use super::diagrams::DiagramTable;
use super::fault::{Damage, Fault};
use super::layout::{CARD, CROISSANT, MANIFEST, SUMS, SWEEP, strays};
use super::output::Output;
use super::parts::{Made, scan};
use super::record::checksum;
use super::tables::Tables;
use super::verify::{faults_of, sums};
use crate::split::Split;
use crate::{Error, Plan};

/// A complete dataset, as its records have it.
pub(super) struct Contents {
    pub(super) manifest: Manifest,
    /// What is written last, in this order: `README.md`, `croissant.json`, `sweep.yaml`, `SHA256SUMS`, `manifest.json`.
    texts: Vec<(&'static str, String)>,
}

/// Completes the dataset of `plan`. Doing it again changes nothing.
///
/// # Errors
/// [`Error::Incomplete`] if a shard or a bifurcation diagram is missing, and errors of files that cannot be
/// read or written.
pub fn finalize(output: &Output, plan: &Plan) -> Result<Manifest, Error> {
    let contents = Contents::new(output, plan)?;
    contents.write(output, &[])?;
    contents.tidy(output)
}

/// As [`finalize`], but compares every file with its checksum before anything is written. Those that are
/// written last are compared too where they stand there, and stay as they are.
///
/// # Errors
/// As [`finalize`], and [`Error::Faults`] with all files that differ from what was written.
pub fn finalize_verified(output: &Output, plan: &Plan) -> Result<Manifest, Error> {
    let contents = Contents::new(output, plan)?;
    let mut standing = Vec::new();
    let mut faults = Vec::new();
    for (path, text) in &contents.texts {
        let Some(found) = output.store.bytes(path)? else {
            continue;
        };
        standing.push(*path);
        if found != text.as_bytes() {
            faults.push(Fault::new(path, Damage::Content));
        }
    }
    let files = contents.manifest.files.iter();
    let files = files.filter(|file| contents.texts.iter().all(|(path, _)| file.path != *path));
    faults.extend(faults_of(&output.store, files, &mut |_| {})?);
    if !faults.is_empty() {
        return Err(Error::Faults {
            path: output.root.clone(),
            faults,
        });
    }
    contents.write(output, &standing)?;
    contents.tidy(output)
}

impl Contents {
    /// What the records of `plan` say, whose files are there in full length.
    ///
    /// # Errors
    /// Where a shard or a bifurcation diagram is missing.
    pub(super) fn new(output: &Output, plan: &Plan) -> Result<Self, Error> {
        let mut parts = Parts::new(plan);
        scan(
            plan,
            output,
            0..plan.parts(),
            Check::Lengths,
            |index, made| {
                parts.add(index, made);
                Ok(())
            },
        )?;
        parts.complete(output, plan)
    }

    /// Whether the manifest that stands there is this one.
    pub(super) fn is_written(&self, output: &Output) -> Result<bool, Error> {
        let found = output.store.bytes(MANIFEST)?;
        Ok(found.is_some_and(|found| self.text(MANIFEST) == Some(found.as_slice())))
    }

    fn text(&self, name: &str) -> Option<&[u8]> {
        let mut texts = self.texts.iter();
        texts.find_map(|(path, text)| (*path == name).then_some(text.as_bytes()))
    }

    fn write(&self, output: &Output, but: &[&str]) -> Result<(), Error> {
        for (path, text) in self.texts.iter().filter(|(path, _)| !but.contains(path)) {
            output.store.write(path, text.as_bytes())?;
        }
        Ok(())
    }

    /// Removes what is not needed any more, and names what is not of this dataset.
    fn tidy(self, output: &Output) -> Result<Manifest, Error> {
        attempts::forget(output, |_| true)?;
        output.tidy()?;
        let known = |path: &str| self.manifest.files.iter().any(|file| file.path == path);
        for path in strays(&output.store, known)? {
            output.warn(format!(
                "`{}` {}",
                output.path(&path).display(),
                Damage::Extra
            ));
        }
        Ok(self.manifest)
    }
}

/// What the parts of a dataset left.
pub(super) struct Parts {
    rows: Rows,
    files: Vec<FileEntry>,
    warnings: Vec<CaseWarning>,
    /// Cases that failed.
    pub(super) failed: Vec<FailedCase>,
    /// Cases in finished shards.
    pub(super) cases: u64,
    /// Parts that are not finished.
    pub(super) missing: Vec<u64>,
}

impl Parts {
    /// None yet.
    pub(super) fn new(plan: &Plan) -> Self {
        let splits = Split::ALL.iter().zip(plan.shares);
        let splits = splits.filter(|(_, share)| *share > 0.0);
        Self {
            rows: splits
                .map(|(split, _)| (split.name().into(), BTreeMap::new()))
                .collect(),
            files: Vec::new(),
            warnings: Vec::new(),
            failed: Vec::new(),
            cases: 0,
            missing: Vec::new(),
        }
    }

    /// Adds part `index`. Parts come in order.
    pub(super) fn add(&mut self, index: u64, made: Option<Made>) {
        match made {
            Some(Made::Shard(commit)) => {
                let [start, end] = commit.cases;
                self.cases += end - start;
                add(&mut self.rows, commit.rows);
                self.files.extend(commit.files);
                self.failed.extend(commit.failed);
                self.warnings.extend(commit.warnings);
            }
            Some(Made::Diagram(commit)) => self.files.push(commit.file),
            None => self.missing.push(index),
        }
    }

    /// The dataset that they make up.
    pub(super) fn complete(self, output: &Output, plan: &Plan) -> Result<Contents, Error> {
        let Self {
            rows,
            mut files,
            warnings,
            failed,
            missing,
            ..
        } = self;
        if !missing.is_empty() {
            let shards = plan.parts();
            return Err(Error::Incomplete { shards, missing });
        }
        if plan.calibrated.is_some() {
            files.extend(output.calibration_entries()?);
        }
        let (tables, bifurcations) = (Tables::new(plan)?, DiagramTable::new(plan)?.schema);
        files.sort_by(|a, b| a.path.cmp(&b.path));
        let card = card(plan, &tables, &bifurcations, &rows, &files, failed.len());
        let mut texts = vec![
            (CARD, card.to_string()),
            (CROISSANT, croissant(&card, &files)?),
            (SWEEP, input::yaml::to_string(plan.sweep())?),
        ];
        files.extend(texts.iter().map(|(path, text)| FileEntry {
            path: (*path).into(),
            bytes: text.len() as u64,
            sha256: checksum(text),
            rows: None,
        }));
        files.sort_by(|a, b| a.path.cmp(&b.path));
        let manifest = Manifest {
            version: env!("CARGO_PKG_VERSION").into(),
            seed: plan.seed,
            counts: Counts {
                cases: plan.cases(),
                failed: failed.len() as u64,
                rows,
            },
            columns: (card.subsets.iter().chain(&card.unsplit))
                .map(|table| (table.name.clone(), ColumnEntry::from_schema(&table.schema)))
                .collect(),
            files,
            failed,
            warnings,
        };
        let json = manifest.to_json()?;
        // The manifest comes last: without it the dataset is not complete.
        texts.push((SUMS, sums(&manifest, &json)));
        texts.push((MANIFEST, json));
        Ok(Contents { manifest, texts })
    }
}

fn add(rows: &mut Rows, more: Rows) {
    for (split, faults) in more {
        let sums = rows.entry(split).or_default();
        for (fault, count) in faults {
            *sums.entry(fault).or_default() += count;
        }
    }
}
