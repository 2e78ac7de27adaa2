//! A finished dataset without `_sweep`, as published datasets are. The records of its shards follow
//! from its plan and its manifest, so undamaged files are not made again.

use std::collections::{BTreeMap, BTreeSet};

use recordings::{CaseWarning, FailedCase, FileEntry, Manifest};

use super::commit::{Commit, DiagramCommit};
use super::layout::{DIAGRAMS, MANIFEST};
use super::output::Output;
use crate::{Error, Plan};

/// What a manifest says, by what it says it of.
struct Published {
    files: BTreeMap<String, FileEntry>,
    failed: BTreeMap<String, FailedCase>,
    warnings: BTreeMap<String, Vec<CaseWarning>>,
}

impl Output {
    /// Writes the records of a finished dataset of `plan`. Its files are not
    /// checked here.
    ///
    /// # Errors
    /// A manifest that cannot be read, or a record that cannot be written.
    pub(super) fn adopt(&self, plan: &Plan) -> Result<(), Error> {
        let published = Published::new(Manifest::read(&self.path(MANIFEST))?);
        for shard in 0..plan.shards() {
            published.commit(plan, shard)?.create(self, plan)?;
        }
        for diagram in &plan.diagrams {
            let path = format!("{}/{}.parquet", DIAGRAMS, diagram.name);
            let Some(file) = published.files.get(&path).cloned() else {
                continue;
            };
            let plan_id = plan.id.clone();
            DiagramCommit { plan_id, file }.create(self, plan, &diagram.name)?;
        }
        Ok(())
    }
}

impl Published {
    fn new(manifest: Manifest) -> Self {
        let mut warnings: BTreeMap<String, Vec<CaseWarning>> = BTreeMap::new();
        for warning in manifest.warnings {
            let of_case = warnings.entry(warning.case_id.clone()).or_default();
            of_case.push(warning);
        }
        let files = manifest.files.into_iter();
        let failed = manifest.failed.into_iter();
        Self {
            files: files.map(|file| (file.path.clone(), file)).collect(),
            failed: failed.map(|case| (case.case_id.clone(), case)).collect(),
            warnings,
        }
    }

    /// The record of shard `shard`.
    fn commit(&self, plan: &Plan, shard: u64) -> Result<Commit, Error> {
        let cases = plan.shard(shard);
        let windows = plan.windows.map_or(1, |windows| windows.count.get());
        let mut commit = Commit {
            plan_id: plan.id.clone(),
            shard,
            cases: [cases.start, cases.end],
            files: Vec::new(),
            rows: BTreeMap::new(),
            failed: Vec::new(),
            warnings: Vec::new(),
        };
        let mut names: BTreeSet<String> = plan.tables_of(shard).collect();
        for index in cases {
            let id = plan.case_id(index);
            names.insert(format!("mcap/{id}.mcap"));
            commit
                .warnings
                .extend(self.warnings.get(&id).into_iter().flatten().cloned());
            if let Some(failed) = self.failed.get(&id) {
                commit.failed.push(failed.clone());
                continue;
            }
            let case = plan.case(index)?;
            let faults = commit.rows.entry(case.split.name().into()).or_default();
            *faults.entry(case.labels.fault).or_default() += u64::from(windows);
        }
        let files = names.iter().filter_map(|name| self.files.get(name));
        commit.files.extend(files.cloned());
        Ok(commit)
    }
}
