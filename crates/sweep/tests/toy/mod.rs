//! A sweep with a cheap runner in place of the simulation.
#![allow(dead_code)] // Each test binary uses some of it.

use input::yaml::Document;
use rand::Rng;
use recordings::Manifest;
use signal::channel::Channel;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use sweep::dataset::Failure;
use sweep::{Case, Error, Existing, Options, Plan, Recording, generate};

pub const SWEEP: &str = "
name: test
machine: single-stage.yaml
seed: 3
run: {revolutions: 4, transient: 2, sample_rate: 1 kHz, chaos: false}
repeats: 2
windows: {count: 2, revolutions: 2}
cases:
  - grid:
      joints: [[], [big_end], [big_end, small_end]]
      clearance: [0.1 mm, 0.2 mm]
      speed: [400 rpm, 500 rpm]
  - random:
      count: 5
      axes: {cylinder.discharge: {uniform: [0.3 MPa, 0.4 MPa]}}
vary:
  joints.big_end.contact.damping: {lognormal: {factor: 1.5}}
splits: {train: 60 %, test: 40 %}
shard_size: 7
";

/// 2 × (2 + 4 + 4 + 5).
pub const CASES: u64 = 30;

pub fn machines() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines")
}

pub fn plan(text: &str) -> Plan {
    let document = Document::parse(text, "sweep.yaml").unwrap();
    Plan::new(&document, &machines()).unwrap()
}

/// Channels that depend on the case: its speed, its clearances and its own noise.
pub fn record(case: &Case) -> Result<Recording, Failure> {
    let mut noise = case.noise();
    let rate = case.settings.sample_rate;
    let period = std::f64::consts::TAU / case.resolved.speed;
    let samples = (f64::from(case.settings.revolutions) * period * rate).ceil() as usize;
    let wear: f64 = case.labels.clearances_m.iter().sum();
    let sensors = case.resolved.sensors.iter();
    let channels = sensors.map(|sensor| Channel {
        name: sensor.measured.column(&[""]),
        unit: sensor.measured.unit().into(),
        samples: (0..samples)
            .map(|i| {
                let turn = i as f64 / rate / period;
                let angle = turn.fract() * std::f64::consts::TAU;
                let hiss = f64::from(noise.next_u32()) / f64::from(u32::MAX) - 0.5;
                match sensor.measured.unit() {
                    "rad" => angle as f32,
                    _ => (angle.sin() + 1e4 * wear * hiss) as f32,
                }
            })
            .collect(),
    });
    Ok(Recording {
        motion: None,
        warnings: Vec::new(),
        sample_rate_hz: rate,
        channels: channels.collect(),
    })
}

/// A runner that takes cases one by one.
pub fn each<F>(of_case: F) -> impl Fn(&[Case]) -> Vec<Result<Recording, Failure>> + Sync
where
    F: Fn(&Case) -> Result<Recording, Failure> + Sync,
{
    move |cases| cases.iter().map(&of_case).collect()
}

pub fn options(existing: Existing, threads: usize, cancel: &AtomicBool) -> Options<'_> {
    Options {
        existing,
        threads,
        cancel,
        retry_failed: false,
        trial: None,
    }
}

pub fn run(
    plan: &Plan,
    root: &Path,
    existing: Existing,
    threads: usize,
) -> Result<Manifest, Error> {
    let cancel = AtomicBool::new(false);
    generate(
        plan,
        root,
        &options(existing, threads, &cancel),
        &each(record),
        &mut (),
    )
}

/// Every file below `root` but for the logs, by path.
pub fn files(root: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![root.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.extend((!path.ends_with("_sweep/logs")).then_some(path));
            } else {
                let name = path.strip_prefix(root).unwrap().to_owned();
                found.insert(name, fs::read(path).unwrap());
            }
        }
    }
    found
}

pub fn assert_same(a: &Path, b: &Path) {
    let (a, b) = (files(a), files(b));
    assert_eq!(a.keys().collect::<Vec<_>>(), b.keys().collect::<Vec<_>>());
    let differ: Vec<_> = a.keys().filter(|name| a[*name] != b[*name]).collect();
    assert!(differ.is_empty(), "{differ:?}");
}
