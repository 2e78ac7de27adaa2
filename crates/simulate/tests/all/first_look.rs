//! What a user looks at first: p-V cards and rod loads, against their closed forms.

use input::MachineFile;
use mechanism::Machine;
use simulate::rod_load::SHORTEST_REVERSAL;
use simulate::{Chamber, IndicatorCard, RodLoad, Settings, Trace, Transient, simulate};
use std::f64::consts::TAU;
use std::path::Path;

/// A shipped machine with ideal joints, and its speed, rad/s.
fn machine(name: &str) -> (Machine, f64) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines");
    let file = input::machine_file::read(&path.join(name)).unwrap();
    let mut tree = file.to_tree().clone();
    for joint in ["main", "big_end", "small_end", "guide"] {
        let path = format!("joints.{joint}.clearance");
        input::paths::set(&mut tree, &path, "ideal".into()).unwrap();
    }
    let resolved = MachineFile::from_tree(&tree).unwrap().resolve();
    let resolved = resolved.unwrap();
    (resolved.machine, resolved.speed)
}

/// The motion of a machine, and the sample rate of its trace, Hz.
fn run(machine: &Machine) -> (Trace, f64) {
    let settings = Settings {
        transient: Transient::Revolutions(2),
        revolutions: 3,
        ..Settings::default()
    };
    let record = simulate(machine, &[], &settings, true).unwrap();
    let trace = record.trace.unwrap();
    let rate = record.sample_rate * trace.stride as f64;
    (trace, rate)
}

#[test]
fn ideal_cycles_have_the_power_of_their_closed_form() {
    for name in ["single-stage.yaml", "two-stage.yaml"] {
        let (machine, speed) = machine(name);
        let chambers = Chamber::of_machine(&machine);
        let (trace, rate) = run(&machine);
        let cards = IndicatorCard::of_run(&chambers, &trace, rate).unwrap();
        assert_eq!(cards.len(), chambers.len());
        for card in cards {
            let chamber = &card.chamber;
            let cylinder = &machine.throws[chamber.throw].cylinder;
            let (low, high) = (cylinder.suction, cylinder.discharge);
            let ratio: f64 = high / low;
            let [compression, expansion] = [cylinder.exponent, cylinder.expansion_exponent];
            // Compression from V₁, discharge, expansion from the clearance volume to V₄, suction.
            let full = chamber.clearance_volume + chamber.swept_volume();
            let taken = |n: f64| n / (n - 1.0) * low * (ratio.powf((n - 1.0) / n) - 1.0);
            let expanded = chamber.clearance_volume * ratio.powf(1.0 / expansion);
            let closed = taken(compression) * full - taken(expansion) * expanded;
            let error = card.work / closed - 1.0;
            assert!(error.abs() < 1e-3, "{}: {error:.1e}", chamber.column);
            // A free crank turns at its own speed, near the stated one.
            let within = if name.starts_with("single") {
                1e-6
            } else {
                1e-2
            };
            let error = card.power / (card.work * speed / TAU) - 1.0;
            assert!(error.abs() < within, "{name}: {error:.1e}");
            let mean = card.work / chamber.swept_volume();
            assert!((card.mean_pressure / mean - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn volumes_are_those_of_the_dead_centres() {
    let (machine, _) = machine("two-stage.yaml");
    for chamber in Chamber::of_machine(&machine) {
        let volumes = (0..3600).map(|i| chamber.volume(f64::from(i) * TAU / 3600.0));
        let volumes: Vec<f64> = volumes.collect();
        let low = volumes.iter().copied().fold(f64::INFINITY, f64::min);
        let high = volumes.iter().copied().fold(0.0, f64::max);
        assert!((low / chamber.clearance_volume - 1.0).abs() < 1e-4);
        let swept = high - low;
        assert!((swept / chamber.swept_volume() - 1.0).abs() < 1e-5);
    }
}

#[test]
fn without_clearance_the_inertia_load_is_that_of_the_simulated_motion() {
    for name in ["single-stage.yaml", "two-stage.yaml"] {
        let (machine, _) = machine(name);
        let (trace, _) = run(&machine);
        let loads = RodLoad::of_run(&machine, &trace).unwrap();
        for ((load, throw), traced) in loads.iter().zip(&machine.throws).zip(&trace.throws) {
            let simulated = |i: usize| -throw.crosshead.mass * traced.acceleration[i];
            let peak = load
                .inertia
                .iter()
                .fold(0.0_f64, |peak, x| peak.max(x.abs()));
            // The trace begins at crank angle 0; its points are not those of the load.
            let step = TAU / load.inertia.len() as f64;
            for i in (0..trace.crank_angle.len()).step_by(97) {
                let place = trace.crank_angle[i] / step;
                let (j, share) = (place as usize, place.fract());
                let n = load.inertia.len();
                let (a, b) = (load.inertia[j % n], load.inertia[(j + 1) % n]);
                let found = a + share * (b - a);
                assert!((found - simulated(i)).abs() < 1e-4 * peak, "{name}, {i}");
            }
        }
    }
}

/// A gas load that is constant, with an inertia load like a cosine of amplitude 1.
fn constant_and_cosine(gas: f64) -> RodLoad {
    let n = 4096;
    let inertia = (0..n).map(|j| (TAU * f64::from(j) / f64::from(n)).cos());
    RodLoad::new(vec![gas; n as usize], inertia.collect())
}

#[test]
fn reversals_have_their_closed_form() {
    // c + cos θ < 0 over the angle 2 arccos c.
    for angle in [180.0_f64, 90.0, 15.01, 14.99, 4.0] {
        let gas = (angle.to_radians() / 2.0).cos();
        for load in [constant_and_cosine(gas), constant_and_cosine(-gas)] {
            let reversal = load.reversal();
            let error = reversal.angle().to_degrees() - angle;
            assert!(error.abs() < 1e-3, "{angle}: {error}");
            let share = (1.0 - gas) / (1.0 + gas);
            assert!((reversal.share() - share).abs() < 1e-6);
            let long = reversal.angle() >= SHORTEST_REVERSAL;
            // At 15° the peak of the reversed load is 0.4 % of the other.
            assert_eq!(reversal.is_sufficient(), long && share >= 0.03);
            assert_eq!(load.zeros().len(), 2);
        }
    }
    assert!(constant_and_cosine(0.0).reversal().is_sufficient());
}

#[test]
fn a_load_of_one_direction_does_not_reverse() {
    for gas in [2.0, -2.0] {
        let reversal = constant_and_cosine(gas).reversal();
        assert_eq!((reversal.angle(), reversal.share()), (0.0, 0.0));
        let sides = [reversal.tension.angle, reversal.compression.angle];
        assert_eq!(sides[usize::from(gas < 0.0)], TAU);
        assert!(!reversal.is_sufficient());
    }
}

#[test]
fn of_several_reversals_the_longest_counts() {
    // Tension over 10° and over 20°, else compression: the longest stretches are 20° and 180°.
    let degree = |j: i32| match j {
        0..10 | 190..210 => 1.0,
        _ => -2.0,
    };
    let load = RodLoad::new((0..360).map(degree).collect(), vec![0.0; 360]);
    let angle = load.reversal().angle().to_degrees();
    // Straight lines from −2 to 1 and back add a third of a degree at each end, less what they take.
    assert!((angle - (19.0 + 2.0 / 3.0)).abs() < 1e-9, "{angle}");
    assert!((load.reversal().share() - 0.5).abs() < 1e-12);
}

#[test]
fn the_longer_direction_may_have_the_larger_peak() {
    // Tension of 2 over 200°, compression of 1 over 160°: angle and share are of the two sides that they stand with.
    let load = |j: i32| if j < 200 { 2.0 } else { -1.0 };
    let load = RodLoad::new((0..360).map(load).collect(), vec![0.0; 360]);
    let reversal = load.reversal();
    assert_eq!(
        [reversal.tension.peak, reversal.compression.peak],
        [2.0, 1.0]
    );
    let angles = [reversal.tension.angle, reversal.compression.angle].map(f64::to_degrees);
    assert!((angles[0] - 200.0).abs() < 1.0 && (angles[1] - 160.0).abs() < 1.0);
    assert_eq!(reversal.angle(), reversal.compression.angle);
}
