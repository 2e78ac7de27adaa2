//! Sections of reference machines.

use crate::common;

use common::{Run, reference, reference_machine};
use mechanism::Machine;
use mechanism::drive::Drive;
use mechanism::joints::revolute::Revolute;
use serde_json::Value;
use simulate::Error;
use simulate::bifurcation::{Chunk, Direction, Machines, Walk, WalkSettings};
use simulate::poincare::{Joint, Revolution, SectionSettings, sections};
use std::f64::consts::TAU;

fn machine(case: &str) -> Machine {
    reference_machine(&reference()[case]["parameters"])
}

fn clearance(machine: &Machine, joint: Joint) -> f64 {
    let revolute = |joint: &Revolute| joint.clear().unwrap().clearance;
    match joint {
        Joint::Main => revolute(&machine.main),
        Joint::BigEnd(i) => revolute(&machine.throws[i].big_end),
        Joint::SmallEnd(i) => revolute(&machine.throws[i].small_end),
        Joint::Guide(i) => machine.throws[i].guide.clear().unwrap().clearance,
    }
}

/// Largest difference of two points: offsets in clearances, rates in clearances per millisecond,
/// speeds in m/s and accelerations in hundreds of m/s²; peaks
/// aside, which are seen at the instants that the steps offer.
fn distance(machine: &Machine, joints: &[Joint], a: &Revolution, b: &Revolution) -> f64 {
    let mut worst = 0.0_f64;
    for ((a, b), &joint) in a.joints.iter().zip(&b.joints).zip(joints) {
        let c = clearance(machine, joint);
        for axis in 0..2 {
            worst = worst.max((a.offset[axis] - b.offset[axis]).abs() / c);
            worst = worst.max((a.rate[axis] - b.rate[axis]).abs() / (c * 1e3));
        }
    }
    for (a, b) in a.throws.iter().zip(&b.throws) {
        worst = worst.max((a.velocity - b.velocity).abs());
        worst = worst.max((a.acceleration - b.acceleration).abs() / 100.0);
    }
    worst
}

#[test]
fn a_periodic_motion_is_one_point() {
    for (case, angle) in [("both_02mm", 0.0), ("two_stage", 1.0)] {
        let machine = machine(case);
        let settings = SectionSettings {
            angle,
            revolutions: 10,
            ..SectionSettings::default()
        };
        let sections = sections(&machine, &settings).unwrap();
        assert_eq!(sections.revolutions.len(), 10);
        let first = &sections.revolutions[0];
        assert_eq!(first.throws.len(), machine.throws.len());
        for other in &sections.revolutions {
            let apart = distance(&machine, &sections.joints, first, other);
            assert!(apart < 1e-6, "{case}: {apart:e}");
            for (first, other) in first.throws.iter().zip(&other.throws) {
                let change = other.peak_acceleration / first.peak_acceleration - 1.0;
                assert!(change.abs() < 1e-4, "{case}: {change:e}");
            }
            assert_eq!(first.impacts.len(), other.impacts.len());
        }
    }
}

#[test]
fn impacts_lie_on_the_clearance_circle() {
    let machine = machine("light_both_03mm");
    let settings = SectionSettings {
        transient: 2,
        revolutions: 20,
        tolerance: 1e-10,
        ..SectionSettings::default()
    };
    let sections = sections(&machine, &settings).unwrap();
    let mut worst = 0.0_f64;
    for joint in [Joint::BigEnd(0), Joint::SmallEnd(0)] {
        let c = clearance(&machine, joint);
        assert!(sections.impacts(joint).count() > 20);
        for impact in sections.impacts(joint) {
            let [x, y] = impact.offset;
            worst = worst.max((x.hypot(y) / c - 1.0).abs());
            assert!(impact.approach > 0.0, "{impact:?}");
            let angle = (impact.time * machine.drive.reference_speed()).rem_euclid(TAU);
            assert!((impact.angle - angle).abs() < 1e-9, "{impact:?} {angle}");
        }
    }
    eprintln!("off the circle by at most {worst:e} clearances");
    assert!(worst < 1e-9, "{worst}");
}

/// Mean and standard error over ten batches.
fn mean(values: &[f64]) -> (f64, f64) {
    let average = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let batches: Vec<f64> = values.chunks(values.len() / 10).map(average).collect();
    let middle = average(values);
    let square: f64 = batches.iter().map(|b| (b - middle).powi(2)).sum();
    (middle, (square / 90.0).sqrt())
}

/// Impacts and peaks per revolution against the reference's statistics, which are those of
/// revolutions 50 to 150. The reference counts a joint that is in contact at top dead centre as
/// touching once more there; so does this test.
#[test]
fn impacts_and_peaks_are_those_of_the_reference() {
    let reference = reference();
    for case in ["both_02mm", "light_both_03mm", "two_stage"] {
        let machine = machine(case);
        let settings = SectionSettings {
            transient: 49,
            revolutions: 101,
            ..SectionSettings::default()
        };
        let sections = sections(&machine, &settings).unwrap();
        for throw in 0..machine.throws.len() {
            let statistics = match &reference[case]["statistics"] {
                Value::Array(throws) => &throws[throw],
                one => one,
            };
            let check = |key: &str, values: &[f64], exact: f64| {
                let [expected, theirs] = [0, 1].map(|i| statistics[key][i].as_f64().unwrap());
                let (ours, error) = mean(values);
                let allowed = (3.0 * theirs.hypot(error)).max(exact * expected);
                assert!(
                    (ours - expected).abs() <= allowed,
                    "{case} {throw} {key}: {ours} {expected}"
                );
            };
            for (joint, key) in [
                (Joint::BigEnd(throw), "impacts_per_rev_big"),
                (Joint::SmallEnd(throw), "impacts_per_rev_small"),
            ] {
                let place = sections.joints.iter().position(|j| *j == joint).unwrap();
                let c = clearance(&machine, joint);
                let pairs = sections.revolutions.windows(2);
                let counts: Vec<f64> = pairs
                    .map(|pair| {
                        let [x, y] = pair[0].joints[place].offset;
                        let made = pair[1].impacts.iter().filter(|i| i.joint == joint).count();
                        made as f64 + f64::from(u8::from(x.hypot(y) > c))
                    })
                    .collect();
                check(key, &counts, 0.0);
            }
            let peaks = sections.revolutions[1..].iter();
            let peaks: Vec<f64> = peaks.map(|r| r.throws[throw].peak_acceleration).collect();
            check("peak_per_rev", &peaks, 2e-3);
        }
    }
}

#[test]
fn a_free_crank_is_caught_at_the_angle() {
    let machine = machine("free_both_02mm");
    let settings = SectionSettings {
        angle: 1.0,
        transient: 1,
        revolutions: 6,
        tolerance: 1e-10,
    };
    let sections = sections(&machine, &settings).unwrap();
    let mut run = Run::start(machine.clone(), 1e-11, false);
    for (i, revolution) in sections.revolutions.iter().enumerate() {
        let expected = 1.0 + (i + 2) as f64 * TAU;
        assert!((revolution.angle - expected).abs() < 1e-9);
        // An integration that knows of no section stands at that angle at that time, too.
        run.advance(revolution.time);
        let found = run.now().angle;
        assert!((found - expected).abs() < 1e-9, "{:e}", found - expected);
    }
    // Not where a crank of the reference speed would be.
    let last = &sections.revolutions[5];
    let uniform = machine.drive.reference_speed() * last.time;
    assert!(
        (uniform - last.angle).abs() > 1e-4,
        "{}",
        uniform - last.angle
    );
}

#[test]
fn an_ideal_machine_has_a_section_too() {
    let settings = SectionSettings {
        transient: 0,
        revolutions: 3,
        ..SectionSettings::default()
    };
    let sections = sections(&common::single_stage(), &settings).unwrap();
    assert!(sections.joints.is_empty());
    // At the outer dead centre the acceleration is −ω² R (1 + R / L), its peak, and the speed 0.
    let peak = common::SPEED.powi(2) * 0.12 * 1.2;
    for revolution in &sections.revolutions {
        let [throw] = revolution.throws.as_slice() else {
            panic!("one throw");
        };
        assert!(throw.velocity.abs() < 1e-9, "{throw:?}");
        assert!(
            (throw.acceleration / -peak - 1.0).abs() < 1e-12,
            "{throw:?}"
        );
        assert!((throw.peak_acceleration / peak - 1.0).abs() < 1e-12);
        assert!(revolution.impacts.is_empty());
    }
}

/// Revolution by revolution through machines, without transients.
fn walk(machine: impl Fn(usize) -> Machine, count: usize, angle: f64) -> Vec<Revolution> {
    let machines = Machines {
        machine: |i| Ok::<_, Error>(machine(i)),
        angle,
        tolerance: 1e-10,
    };
    let chunks = Chunk::cut(Direction::Up, count, count);
    let settings = WalkSettings {
        transient: 0,
        revolutions: 2,
    };
    let walk = Walk::new(&machines, chunks[0].clone(), settings);
    walk.flat_map(|(_, points)| points.unwrap()).collect()
}

/// A machine that is replaced by its like goes on as if nothing had happened: nothing of the state
/// is lost, for given and free cranks, chaotic motions included.
#[test]
fn nothing_is_lost_on_the_way_from_value_to_value() {
    for (case, angle) in [
        ("light_both_03mm", 0.0),
        ("light_both_03mm", 2.5),
        ("free_both_02mm", 0.0),
        ("two_stage_free", 1.0),
    ] {
        let machine = machine(case);
        let settings = SectionSettings {
            angle,
            transient: 0,
            // After that chaos makes much of the tolerance: a hundred times as much in each.
            revolutions: 4,
            tolerance: 1e-10,
        };
        let whole = sections(&machine, &settings).unwrap();
        let pieces = walk(|_| machine.clone(), 3, angle);
        let mut worst = 0.0_f64;
        for (i, (a, b)) in pieces.iter().zip(&whole.revolutions).enumerate() {
            worst = worst.max(distance(&machine, &whole.joints, a, b));
            // The revolution in which the machine changes begins anew.
            if i % 2 == 1 {
                assert_eq!(a.impacts.len(), b.impacts.len(), "{case}");
            }
        }
        eprintln!("{case} {angle}: {worst:e}");
        assert!(worst < 1e-5, "{case}: {worst:e}");
    }
}

/// A clearance that grows by half from value to value: the journal stays in its bearing.
#[test]
fn a_growing_clearance_carries_its_journal_along() {
    let machines: Vec<Machine> = (0..4)
        .map(|i| common::with_clearance(1e-5 * 1.5_f64.powi(i), 2e-4, 2e4))
        .collect();
    let revolutions = walk(|i| machines[i].clone(), machines.len(), 0.0);
    for (i, revolution) in revolutions.iter().enumerate() {
        let c = clearance(&machines[i / 2], Joint::BigEnd(0));
        let [x, y] = revolution.joints[0].offset;
        // Pressed at top dead centre by some 12 kN: (F / K)^(2/3) = 60 µm, less what gravity and gas
        // take off.
        let depth = x.hypot(y) - c;
        assert!((4e-5..6e-5).contains(&depth), "{i}: {depth:e}");
        assert!(revolution.throws[0].peak_acceleration < 2e3, "{i}");
    }
}

/// Without a motor the gas stops the crank before it comes round often: no endless wait.
#[test]
fn a_crank_that_stalls_is_told() {
    let mut machine = machine("free_both_02mm");
    machine.crankshaft.inertia = 0.5;
    if let Drive::Free(motor) = &mut machine.drive {
        (motor.mean_torque, motor.slope) = (0.0, 0.0);
    }
    let settings = SectionSettings {
        tolerance: 1e-7,
        ..SectionSettings::default()
    };
    let stalled = sections(&machine, &settings);
    assert!(
        matches!(stalled, Err(Error::Stalled { time }) if time > 1.0),
        "{stalled:?}"
    );
}
