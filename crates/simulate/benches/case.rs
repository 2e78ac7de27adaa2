//! One case: ten revolutions thrown away, twenty recorded at 10 kHz by four sensors; and sixteen of
//! them, one by one and side by side.

use criterion::{Criterion, criterion_group, criterion_main};
use input::{MachineFile, Resolved};
use simulate::{Asked, Settings, simulate, simulate_together};

/// The shipped machine with the same clearance at both ends.
fn machine(clearance: &str) -> Option<Resolved> {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../data/machines/single-stage.yaml"
    );
    let file = input::machine_file::read(std::path::Path::new(path)).ok()?;
    let mut tree = file.to_tree().clone();
    for joint in ["big_end", "small_end"] {
        let path = format!("joints.{joint}.clearance");
        input::paths::set(&mut tree, &path, clearance.into()).ok()?;
    }
    MachineFile::from_tree(&tree).ok()?.resolve().ok()
}

fn case(c: &mut Criterion) {
    let mut group = c.benchmark_group("case");
    for clearance in ["ideal", "0.1 mm", "0.3 mm"] {
        let Some(machine) = machine(clearance) else {
            continue;
        };
        group.bench_function(clearance, |b| {
            b.iter(|| {
                simulate(
                    &machine.machine,
                    &machine.sensors,
                    &Settings::default(),
                    false,
                )
                .map(|record| record.series.len())
            });
        });
    }
    group.finish();
}

/// As many as fill the lanes twice, with clearances of their own.
fn sixteen(c: &mut Criterion) {
    let machines: Vec<Resolved> = (0..16)
        .filter_map(|i| machine(&format!("{} mm", 0.1 + 0.02 * f64::from(i))))
        .collect();
    let settings = Settings {
        tolerance: 1e-7,
        ..Settings::default()
    };
    let asked: Vec<Asked> = machines
        .iter()
        .map(|resolved| Asked::from_rest(&resolved.machine, &resolved.sensors, &settings))
        .collect();
    let mut group = c.benchmark_group("sixteen cases");
    group.bench_function("one by one", |b| {
        b.iter(|| {
            let one = |asked: &Asked| {
                let record = simulate(asked.machine, asked.sensors, asked.settings, false);
                record.map_or(0, |record| record.series.len())
            };
            asked.iter().map(one).sum::<usize>()
        });
    });
    group.bench_function("together", |b| {
        b.iter(|| simulate_together(&asked, |_, record| record).len())
    });
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10).without_plots();
    targets = case, sixteen
}
criterion_main!(benches);
