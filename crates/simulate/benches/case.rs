//! One case: ten revolutions thrown away, twenty recorded at 10 kHz by four sensors.

use criterion::{Criterion, criterion_group, criterion_main};
use input::{MachineFile, Resolved};
use simulate::{Settings, simulate};

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

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10).without_plots();
    targets = case
}
criterion_main!(benches);
