//! What makes a dataset complete: `README.md`, `sweep.yaml` and, last, `manifest.json`.

use std::collections::BTreeMap;

use input::paths;
use recordings::{Counts, DatasetCard, FileEntry, Manifest, Subset};

use super::commit::Check;
use super::diagrams::{self, DiagramTable};
use super::output::Output;
use super::parts::{Made, scan};
use super::tables::Tables;
use crate::split::Split;
use crate::sweep_file::Format;
use crate::{Error, Plan};

/// Completes the dataset of `plan`. Doing it again changes nothing.
///
/// # Errors
/// Where a shard or a bifurcation diagram is missing, or a file cannot be written.
pub fn finalize(output: &Output, plan: &Plan) -> Result<Manifest, Error> {
    output.tidy()?;
    let tables = Tables::new(plan)?;
    let mut rows = Rows::new();
    for (split, share) in Split::ALL.iter().zip(plan.shares) {
        if share > 0.0 {
            rows.insert(split.name().into(), BTreeMap::new());
        }
    }
    let mut files: Vec<FileEntry> = Vec::new();
    let (mut failed, mut warnings) = (Vec::new(), Vec::new());
    let mut missing = Vec::new();
    scan(
        plan,
        output,
        0..plan.parts(),
        Check::Lengths,
        |index, made| {
            match made {
                Some(Made::Shard(commit)) => {
                    add(&mut rows, commit.rows);
                    files.extend(commit.files);
                    failed.extend(commit.failed);
                    warnings.extend(commit.warnings);
                }
                Some(Made::Diagram(commit)) => files.push(commit.file),
                None => missing.push(index),
            }
            Ok(())
        },
    )?;
    if !missing.is_empty() {
        let shards = plan.parts();
        return Err(Error::Incomplete { shards, missing });
    }
    if plan.calibrated.is_some() {
        files.extend(output.calibration_entries()?);
    }
    let bifurcations = DiagramTable::new(plan)?.schema;
    let card = card(plan, &tables, &bifurcations, &rows, &files).to_string();
    let sweep = input::yaml::to_string(plan.sweep())?;
    for (path, text) in [("README.md", card), ("sweep.yaml", sweep)] {
        let record = output.store.write(path, text.as_bytes())?;
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
        warnings,
    };
    output
        .store
        .write("manifest.json", manifest.to_json()?.as_bytes())?;
    Ok(manifest)
}

/// Checks every file of a finalized dataset against its checksum.
///
/// # Errors
/// The first file that is not the one that was written.
pub fn verify(output: &Output, manifest: &Manifest) -> Result<(), Error> {
    for file in &manifest.files {
        let found = output.store.record(&file.path)?;
        let found = found.map_or("none".into(), |found| found.sha256);
        if found != file.sha256 {
            return Err(Error::Changed {
                path: output.path(&file.path),
                found,
                expected: file.sha256.clone(),
            });
        }
    }
    Ok(())
}

/// Rows by split, then by fault.
type Rows = BTreeMap<String, BTreeMap<String, u64>>;

fn add(rows: &mut Rows, more: Rows) {
    for (split, faults) in more {
        let sums = rows.entry(split).or_default();
        for (fault, count) in faults {
            *sums.entry(fault).or_default() += count;
        }
    }
}

fn card(
    plan: &Plan,
    tables: &Tables,
    bifurcations: &recordings::Schema,
    rows: &Rows,
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
             its clearance exceeds the machine's normal one.{} Splits are by group: cases that \
             differ in noise and sensors alone are in the same split.{}",
            plan.cases(),
            plan.settings.revolutions,
            plan.settings.sample_rate,
            effects(plan),
            match plan.is_stratified() {
                true => " They are stratified by label.",
                false => "",
            },
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

/// Which effects are labels, as a sentence; empty where none is.
fn effects(plan: &Plan) -> String {
    let mut labels: Vec<&str> = plan.effects.iter().map(|e| e.label.as_str()).collect();
    labels.dedup();
    match labels.as_slice() {
        [] => String::new(),
        labels => format!(
            " Effects are labels as well, where their amplitude is not 0: {}.",
            labels.join(", ")
        ),
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
