//! Single measures of 10 000 samples of the Lorenz system.

use chaos::delay::times;
use chaos::divergence::rosenstein;
use chaos::entropy::sample_entropy;
use chaos::error::checked;
use chaos::neighbours::{Delays, Neighbours};
use chaos::recurrence::recurrence;
use chaos::test_systems::System;
use criterion::{Criterion, criterion_group, criterion_main};

fn measures(c: &mut Criterion) {
    let signal = System::Lorenz.samples(10_000, 1);
    let (Ok(times), Ok((_, deviation))) = (times(&signal), checked(&signal)) else {
        return;
    };
    let delays = Delays {
        signal: &signal,
        dimension: 4,
        delay: times.delay,
    };
    let spread = 0.2 * deviation;
    let mut group = c.benchmark_group("lorenz");
    group.bench_function("nearest 10 of each", |b| {
        let search = Neighbours::new(&delays, delays.count(), times.theiler);
        b.iter(|| {
            let found = |i| search.as_ref().map_or(0, |s| s.nearest(i, 10).len());
            (0..delays.count()).map(found).sum::<usize>()
        });
    });
    group.bench_function("divergence", |b| {
        b.iter(|| rosenstein(&delays, times.theiler, 50));
    });
    group.bench_function("sample entropy", |b| {
        b.iter(|| sample_entropy(&signal, 2, spread));
    });
    group.bench_function("recurrence", |b| {
        b.iter(|| recurrence(&delays, times.theiler, spread));
    });
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10).without_plots();
    targets = measures
}
criterion_main!(benches);
