//! The records of a dataset under way, broken by a disk or by somebody: how far it has got, and what
//! completes it, is told or refused.

use crate::mutate::Mutator;
use crate::trial::{Seed, corpus, trial};
use input::yaml::Document;
use signal::channel::Channel;
use std::fs;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use sweep::dataset::{Failure, Output, status};
use sweep::{Case, Error, Existing, Options, Plan, Recording, finalize, generate};

const SWEEP: &str = "
name: records
machine: machine/one-throw.yaml
run: {revolutions: 1, sample_rate: 1 kHz, chaos: false}
cases: [{grid: {speed: [400 rpm, 500 rpm, 600 rpm]}}]
shard_size: 2
splits: {train: 100 %}
";

/// The records that are broken.
const RECORDS: [&str; 4] = [
    "_sweep/commits/0.json",
    "_sweep/commits/1.json",
    "_sweep/plan.json",
    "sweep.yaml",
];

/// Recordings of nothing, but for the last case, which fails.
fn runner(cases: &[Case]) -> Vec<Result<Recording, Failure>> {
    let recording = |case: &Case| {
        let sensors = case.resolved.sensors.iter();
        let channels = sensors.map(|sensor| Channel {
            name: sensor.measured.column(&[""]),
            unit: sensor.measured.unit().into(),
            samples: vec![0.0; 100],
        });
        match case.index {
            2 => Err("it has to".into()),
            _ => Ok(Recording {
                sample_rate_hz: 1000.0,
                channels: channels.collect(),
                motion: None,
                warnings: Vec::new(),
            }),
        }
    };
    cases.iter().map(recording).collect()
}

/// Makes a dataset, and tries it with one of its records broken, `executions` times.
pub fn records(executions: u64) {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().join("out");
    let document = Document::parse(SWEEP, "sweep.yaml").unwrap();
    let plan = Plan::new(&document, &corpus()).unwrap();
    let cancel = AtomicBool::new(false);
    let options = Options {
        existing: Existing::Refuse,
        threads: 1,
        cancel: &cancel,
        retry_failed: false,
        trial: None,
    };
    generate(&plan, &root, &options, &runner, &mut ()).unwrap();
    let whole = RECORDS.map(|name| fs::read_to_string(root.join(name)).unwrap());
    let seeds: Vec<Seed> = RECORDS
        .iter()
        .zip(&whole)
        .map(|(name, text)| (String::from(*name), text.clone().into_bytes()))
        .collect();
    let mut turn = 0;
    let mutator = Mutator::new(Vec::new());
    trial("records", seeds, mutator, executions, move |text| {
        let _keep = &folder;
        // The seeds come first, each in its own place.
        let place = turn % RECORDS.len();
        turn += 1;
        fs::write(root.join(RECORDS[place]), text).unwrap();
        let answer = open_status_finalize(&root);
        fs::write(root.join(RECORDS[place]), &whole[place]).unwrap();
        answer.map_err(|error| error.to_string())
    });
}

fn open_status_finalize(root: &Path) -> Result<String, Error> {
    let (output, plan) = Output::open_read_only(root)?;
    let status = status(&output, &plan, false)?;
    let manifest = finalize(&output, &plan)?;
    Ok(format!(
        "{} cases, {} files",
        status.cases,
        manifest.files.len()
    ))
}
