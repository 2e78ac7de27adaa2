//! One sweep of eight short cases, files included, and the planning of one case of the large one.

use criterion::{Criterion, criterion_group, criterion_main};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use sweep::dataset::{Existing, Options, generate};
use sweep::{Plan, simulate_cases};

const SWEEP: &str = "
name: bench
machine: MACHINE
run: {revolutions: 4, transient: 2}
cases:
  - grid: {joints: [[big_end], [big_end, small_end]], clearance: [0.1 mm, 0.2 mm, 0.3 mm, 0.4 mm]}
";

fn pipelines(name: &str) -> String {
    format!("{}/../../{name}", env!("CARGO_MANIFEST_DIR"))
}

fn dataset(c: &mut Criterion) {
    let text = SWEEP.replace("MACHINE", &pipelines("data/machines/single-stage.yaml"));
    let plan = input::yaml::Document::parse(&text, "sweep.yaml")
        .and_then(|document| Plan::new(&document, Path::new("")));
    let (Ok(plan), Ok(folder)) = (plan, tempfile::tempdir()) else {
        return;
    };
    c.bench_function("sweep of eight cases on one thread", |b| {
        b.iter(|| {
            let options = Options {
                existing: Existing::Overwrite,
                threads: 1,
                cancel: &AtomicBool::new(false),
                retry_failed: false,
                trial: None,
            };
            generate(&plan, folder.path(), &options, &simulate_cases, &mut ()).is_ok()
        });
    });
}

fn planning(c: &mut Criterion) {
    let Ok(plan) = Plan::read(Path::new(&pipelines("pipelines/bearing-faults.yaml"))) else {
        return;
    };
    let mut index = 0;
    c.bench_function("planning one of 2048 random cases", |b| {
        b.iter(|| {
            index = (index + 1) % plan.cases();
            plan.case(index).map(|case| case.group)
        });
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10).without_plots();
    targets = dataset, planning
}
criterion_main!(benches);
