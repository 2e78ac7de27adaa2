//! One right-hand side (plain, dual, lanes), and one revolution.

#[path = "../tests/all/common/mod.rs"]
mod common;

use common::{REVOLUTION, Run, with_clearance};
use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, criterion_group, criterion_main};
use integrate::System;
use mechanism::{Dynamics, Machine, lift};
use scalar::{Dual, InLanes, Lanes, Scalar, in_lanes};
use std::hint::black_box;

/// A state of the settled motion, and its time.
fn settled() -> (f64, Vec<f64>) {
    let mut run = Run::start(with_clearance(3e-4, 3e-4, 2e4), 1e-9, false);
    run.advance(5.3 * REVOLUTION);
    (run.integrator.time(), run.integrator.state().to_vec())
}

fn right_hand_side(c: &mut Criterion) {
    let machine = with_clearance(3e-4, 3e-4, 2e4);
    let (t, y) = settled();
    let mut group = c.benchmark_group("right_hand_side");
    let mut plain = Dynamics::new(machine.clone(), false);
    group.bench_function("plain", |b| {
        b.iter(|| plain.evaluate(black_box(t), black_box(&y)).speed);
    });
    let mut dual = Dynamics::<Dual<f64, 1>>::new(lift::constants(&machine), false);
    let dual_y: Vec<Dual<f64, 1>> = y.iter().map(|y| Dual::constant(*y)).collect();
    group.bench_function("dual", |b| {
        b.iter(|| {
            dual.evaluate(black_box(Dual::constant(t)), black_box(&dual_y))
                .speed
        });
    });
    let mut tangents = Dynamics::<Dual<f64, 8>>::new(lift::constants(&machine), false);
    let tangents_y: Vec<Dual<f64, 8>> = y.iter().map(|y| Dual::constant(*y)).collect();
    group.bench_function("eight tangents", |b| {
        b.iter(|| {
            tangents
                .evaluate(black_box(Dual::constant(t)), black_box(&tangents_y))
                .speed
        });
    });
    in_lanes(LanesBench {
        group: &mut group,
        machine: &machine,
        t,
        y: &y,
    });
    let mut dy = y.clone();
    let mut with_ledger = Dynamics::new(machine, true);
    let mut y = y;
    y.resize(with_ledger.dimension(), 0.0);
    dy.resize(y.len(), 0.0);
    group.bench_function("derivative with ledger", |b| {
        b.iter(|| with_ledger.derivative(black_box(t), black_box(&y), &mut dy));
    });
    group.finish();
}

/// A right-hand side in as many lanes as the processor has.
struct LanesBench<'a, 'b> {
    group: &'a mut BenchmarkGroup<'b, WallTime>,
    machine: &'a Machine,
    t: f64,
    y: &'a [f64],
}

impl InLanes for LanesBench<'_, '_> {
    type Output = ();
    fn run<L: Lanes<W>, const W: usize>(self) {
        let mut lanes = Dynamics::<L>::new(lift::lanes([self.machine; W]), false);
        let (t, y) = (L::constant(self.t), self.y.iter().map(|y| L::constant(*y)));
        let y: Vec<L> = y.collect();
        self.group.bench_function(format!("{W} lanes"), |b| {
            b.iter(|| lanes.evaluate(black_box(t), black_box(&y)).speed);
        });
    }
}

fn revolution(c: &mut Criterion) {
    let mut group = c.benchmark_group("revolution");
    for tolerance in [1e-6, 1e-9, 1e-12] {
        let mut run = Run::start(with_clearance(3e-4, 3e-4, 2e4), tolerance, false);
        run.advance(5.0 * REVOLUTION);
        let start = run.integrator.clone();
        let mode = run.dynamics.clone();
        group.bench_function(format!("tolerance {tolerance:e}"), |b| {
            b.iter(|| {
                let (mut integrator, mut dynamics) = (start.clone(), mode.clone());
                integrator
                    .reach(&mut dynamics, 6.0 * REVOLUTION)
                    .map(|()| integrator.state()[0])
            });
        });
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(30).without_plots();
    targets = right_hand_side, revolution
}
criterion_main!(benches);
