//! What makes a dataset complete: `README.md`, `sweep.yaml` and, last, `manifest.json`.

use std::collections::BTreeMap;

use input::paths;
use recordings::{Counts, DatasetCard, FileEntry, Manifest, Subset};

use super::commit::{Commit, DiagramCommit};
use super::diagrams::{self, DiagramTable};
use super::output::Output;
use super::tables::Tables;
use crate::split::Split;
use crate::sweep_file::Format;
use crate::{Error, Plan};

/// Completes the dataset of `plan`. Doing it again changes nothing.
///
/// # Errors
/// Where a shard or a bifurcation diagram is missing, or a file cannot be written.
pub fn finalize(output: &Output, plan: &Plan) -> Result<Manifest, Error> {
    let commits = commits(output, plan)?;
    let tables = Tables::new(plan)?;
    let mut rows: BTreeMap<String, BTreeMap<String, u64>> = BTreeMap::new();
    for (split, share) in Split::ALL.iter().zip(plan.shares) {
        if share > 0.0 {
            rows.insert(split.name().into(), BTreeMap::new());
        }
    }
    let mut files: Vec<FileEntry> = Vec::new();
    let mut failed = Vec::new();
    for commit in commits {
        for (split, faults) in commit.rows {
            let sums = rows.entry(split).or_default();
            for (fault, count) in faults {
                *sums.entry(fault).or_default() += count;
            }
        }
        files.extend(commit.files);
        failed.extend(commit.failed);
    }
    for diagram in &plan.diagrams {
        let commit = DiagramCommit::read(output, plan, &diagram.name)?;
        let commit = commit.ok_or_else(|| Error::MissingDiagram(diagram.name.clone()))?;
        files.push(commit.file);
    }
    if plan.calibrated.is_some() {
        files.extend(output.calibration_entries()?);
    }
    let bifurcations = DiagramTable::new(plan)?.schema;
    let card = card(plan, &tables, &bifurcations, &rows, &files).to_string();
    let sweep = input::yaml::to_string(plan.sweep())?;
    for (path, text) in [("README.md", card), ("sweep.yaml", sweep)] {
        let record = output.write(path, text.as_bytes())?;
        files.push(FileEntry {
            path: path.into(),
            bytes: record.bytes,
            sha256: record.sha256,
            rows: None,
        });
    }
    files.sort_by(|a, b| a.path.cmp(&b.path));
    let manifest = Manifest {
        version: env!("CARGO_PKG_VERSION").into(),
        seed: plan.seed,
        counts: Counts {
            cases: plan.cases(),
            failed: failed.len() as u64,
            rows,
        },
        files,
        failed,
    };
    output.write("manifest.json", manifest.to_json()?.as_bytes())?;
    Ok(manifest)
}

fn commits(output: &Output, plan: &Plan) -> Result<Vec<Commit>, Error> {
    let mut commits = Vec::new();
    let mut missing = Vec::new();
    for shard in 0..plan.shards() {
        match Commit::read(output, plan, shard)? {
            Some(commit) => commits.push(commit),
            None => missing.push(shard),
        }
    }
    match missing.as_slice() {
        [] => Ok(commits),
        _ => Err(Error::Incomplete {
            shards: plan.shards(),
            missing,
        }),
    }
}

fn card(
    plan: &Plan,
    tables: &Tables,
    bifurcations: &recordings::Schema,
    rows: &BTreeMap<String, BTreeMap<String, u64>>,
    files: &[FileEntry],
) -> DatasetCard {
    let subset = |name: &str, schema: &recordings::Schema| Subset {
        name: name.into(),
        schema: schema.clone(),
    };
    let features = subset("features", &tables.features);
    let mut example = files
        .iter()
        .map(|file| &file.path)
        .filter(|p| p.starts_with("mcap/"));
    let tags = [
        "time-series",
        "vibration",
        "fault-diagnosis",
        "predictive-maintenance",
        "reciprocating-compressor",
        "simulation",
    ];
    DatasetCard {
        title: plan.name.clone(),
        summary: format!(
            "Simulated recordings of a reciprocating compressor, labelled with the clearance of \
             its joints: {} cases, {} revolutions each at {} Hz. A joint counts as faulty where \
             its clearance exceeds the machine's normal one. Splits are by group: cases that \
             differ in noise alone are in the same split.",
            plan.cases(),
            plan.settings.revolutions,
            plan.settings.sample_rate,
        ),
        // Whose data they are is for the one who publishes them to say.
        license: "unknown".into(),
        tags: tags.map(String::from).to_vec(),
        machine: machine(plan),
        rows: rows.clone(),
        subsets: match plan.format {
            Format::Parquet => vec![subset("signals", &tables.signals), features],
            Format::Mcap => vec![features],
        },
        unsplit: match plan.diagrams.as_slice() {
            [] => Vec::new(),
            _ => vec![subset(diagrams::FOLDER, bifurcations)],
        },
        mcap_example: example.next().cloned(),
        command: "gen-dataset sweep.yaml --out another-folder".into(),
        version: env!("CARGO_PKG_VERSION").into(),
    }
}

/// The machine's main figures, as its file has them.
fn machine(plan: &Plan) -> Vec<(String, String)> {
    let shown = [
        ("machine", "name"),
        ("speed", "speed"),
        ("crank radius", "crank.radius"),
        ("rod length", "rod.length"),
        ("rod mass", "rod.mass"),
        ("crosshead mass", "crosshead.mass"),
        ("piston radius", "cylinder.piston_radius"),
        ("suction pressure", "cylinder.suction"),
        ("discharge pressure", "cylinder.discharge"),
    ];
    let value = |path| paths::get(&plan.sweep()["machine"], path).ok().flatten();
    let text = |path| value(path).and_then(serde_json::Value::as_str);
    let rows = shown.into_iter();
    rows.filter_map(|(name, path)| Some((name.into(), text(path)?.into())))
        .collect()
}
