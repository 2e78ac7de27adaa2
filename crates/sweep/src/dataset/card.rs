//! What the card of a dataset says.

use std::collections::BTreeMap;

use input::paths;
use recordings::{DatasetCard, FileEntry, Schema, Subset};

use super::layout::DIAGRAMS;
use super::tables::Tables;
use crate::Plan;
use crate::sweep_file::Format;

/// Rows by split, then by fault.
pub(super) type Rows = BTreeMap<String, BTreeMap<String, u64>>;

/// The card of the dataset of `plan`, of whose cases `failed` have no row.
pub(super) fn card(
    plan: &Plan,
    tables: &Tables,
    bifurcations: &Schema,
    rows: &Rows,
    files: &[FileEntry],
    failed: usize,
) -> DatasetCard {
    let subset = |name: &str, schema: &Schema| Subset {
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
        summary: summary(plan),
        licence: plan.licence,
        uses: uses(plan),
        limits: limits(plan, failed),
        tags: tags.map(String::from).to_vec(),
        machine: machine(plan),
        rows: rows.clone(),
        subsets: match plan.format {
            Format::Parquet => vec![subset("signals", &tables.signals), features],
            Format::Mcap => vec![features],
        },
        unsplit: match plan.diagrams.as_slice() {
            [] => Vec::new(),
            _ => vec![subset(DIAGRAMS, bifurcations)],
        },
        mcap_example: example.next().cloned(),
        command: "gen-dataset sweep.yaml --out another-folder".into(),
        version: env!("CARGO_PKG_VERSION").into(),
    }
}

fn summary(plan: &Plan) -> String {
    let sampled = match plan.over_angle {
        Some(over_angle) => format!(
            "{} samples in each, at equal steps of the crank angle",
            over_angle.samples_per_revolution
        ),
        None => format!("each at {} Hz", plan.settings.sample_rate),
    };
    format!(
        "Simulated recordings of a reciprocating compressor, labelled with the radial clearance of \
         its joints: {} cases, {} revolutions {sampled}. A joint counts as faulty where \
         its clearance exceeds the machine's normal one.{} Splits are by group: cases that \
         differ in noise and sensors alone are in the same split.{}",
        plan.cases(),
        plan.settings.revolutions,
        effects(plan),
        match plan.is_stratified() {
            true => " They are stratified by label.",
            false => "",
        },
    )
}

fn uses(plan: &Plan) -> Vec<String> {
    let mut uses = vec![
        "Train and compare classifiers: the target is `fault`, the columns of the role `feature` or `signal` are what \
         they see. Labels, conditions and unknowns of other columns give the answer away."
            .to_owned(),
        "Estimate how large a fault is: the targets are `clearance_*` and the amplitudes of effects.".to_owned(),
        "Cross-validate by `group`: rows of one group are recordings of one motion.".to_owned(),
    ];
    if plan.calibrated.is_some() {
        uses.push(
            "Diagnose recordings of the machine that it is calibrated to, in `calibration/`. \
             `crosshead features --like` computes the same features from them."
                .to_owned(),
        );
    }
    uses
}

fn limits(plan: &Plan, failed: usize) -> Vec<String> {
    let mut limits = vec![
        match plan.calibrated {
            Some(_) => {
                "The machine is calibrated to recordings. Other machines of its kind differ from it."
            }
            None => {
                "The machine has the values of its file. It is compared with no recording, so that a real machine may \
                 differ from it more than a fault does."
            }
        }
        .to_owned(),
        "A fault of a joint is a larger clearance. Cracks, spalls and loose parts are not simulated.".to_owned(),
        "Motion is planar. There is no load-carrying oil film, no torsion, and no wear during a recording.".to_owned(),
        "The shares of the faults are those of the sweep, not those of machines in service.".to_owned(),
    ];
    if plan.over_angle.is_some() {
        limits.push(format!(
            "Signals are resampled over the crank angle: orders up to 0.4 of the samples per revolution pass within 1e-4. \
             Features are those of the recordings before, at {} Hz.",
            plan.settings.sample_rate
        ));
    }
    if failed > 0 {
        limits.push(format!(
            "{failed} of {} cases could not be simulated and have no row: `failed` in `manifest.json`.",
            plan.cases()
        ));
    }
    limits
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
