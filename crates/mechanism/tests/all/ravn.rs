//! The slider-crank with a clear small end of Ravn 1998 and Flores (literature.md, D1 and D7):
//! its first touches digit by digit, then statistics over 200 revolutions.

use crate::common;

use common::single_stage;
use integrate::Integrator;
use mechanism::drive::{Drive, GivenSpeed};
use mechanism::joints::contact::{ContactLaw, Impact, Restitution};
use mechanism::joints::friction::FrictionLaw;
use mechanism::joints::revolute::{Clearance, JointModel, Revolute};
use mechanism::joints::stiffness::{Material, conformal};
use mechanism::{Crosshead, Dynamics, Machine, Rod};
use std::f64::consts::TAU;

const SPEED: f64 = 5000.0 * TAU / 60.0;
const PERIOD: f64 = 0.012;
const BEARING_RADIUS: f64 = 0.01;

fn stiffness(clearance: f64) -> f64 {
    let steel = Material {
        youngs_modulus: 207e9,
        poisson_ratio: 0.3,
    };
    conformal([steel; 2], BEARING_RADIUS - clearance, clearance)
}

fn lankarani_nikravesh(clearance: f64, slowest_approach: f64) -> ContactLaw {
    ContactLaw::LankaraniNikravesh(Restitution {
        stiffness: stiffness(clearance),
        exponent: 1.5,
        restitution: 0.9,
        slowest_approach,
    })
}

fn machine(clearance: f64, contact: ContactLaw) -> Machine {
    let mut machine = single_stage();
    machine.drive = Drive::Given(GivenSpeed {
        speed: SPEED,
        fluctuation: Vec::new(),
    });
    (machine.gravity_x, machine.gravity_y) = (0.0, 0.0);
    let throw = &mut machine.throws[0];
    throw.crank_radius = 0.05;
    throw.rod = Rod {
        length: 0.12,
        mass: 0.21,
        centre_of_mass: 0.06,
        inertia: 2.5e-4,
    };
    throw.crosshead = Crosshead {
        mass: 0.14,
        inertia: 1e-5,
    };
    // No gas.
    throw.cylinder.piston_radius = 0.0;
    throw.small_end = Revolute::Clear(Clearance {
        clearance,
        journal_radius: BEARING_RADIUS - clearance,
        contact,
        friction: FrictionLaw::none(),
        model: JointModel::ThreeMode,
    });
    machine
}

/// A contact at the small end, from touch to parting.
#[derive(Clone, Copy, Debug, Default)]
struct Contact {
    touch: f64,
    approach: f64,
    parting: f64,
    separation: f64,
    depth: f64,
    acceleration: f64,
}

/// Runs to `end`, and shows `see` the mechanism at many instants of every step, with the time and
/// whether the step is in contact; gives the contacts begun.
fn run(
    machine: Machine,
    tolerance: f64,
    end: f64,
    looks: usize,
    mut see: impl FnMut(f64, f64, bool),
) -> Vec<Contact> {
    let mut dynamics = Dynamics::new(machine, false);
    let mut y = dynamics.initial_state();
    let mut integrator = Integrator::new(&mut dynamics, 0.0, &y, tolerance, PERIOD / 40.0);
    let mut contacts: Vec<Contact> = Vec::new();
    let mut inside = false;
    let mut last = (0.0, 0.0);
    integrator
        .advance(&mut dynamics, end, |dynamics, step| {
            let touching = dynamics.mode().throws[0].small_end.touching > 0.0;
            if touching && !inside {
                contacts.push(Contact {
                    touch: last.0,
                    approach: last.1,
                    ..Contact::default()
                });
            }
            if let (false, true, Some(contact)) = (touching, inside, contacts.last_mut()) {
                (contact.parting, contact.separation) = (last.0, -last.1);
            }
            inside = touching;
            for look in 1..=looks {
                #[expect(clippy::cast_precision_loss, reason = "small numbers")]
                let share = look as f64 / looks as f64;
                step.interpolate(share, &mut y);
                let t = step.start + share * step.length;
                let at = &dynamics.evaluate(t, &y).throws[0];
                let acceleration = at.accelerations.crosshead.abs();
                see(t, acceleration, touching);
                if let (true, Some(contact)) = (touching, contacts.last_mut()) {
                    contact.depth = contact.depth.max(at.joints.small_end.penetration);
                    contact.acceleration = contact.acceleration.max(acceleration);
                }
                last = (t, at.joints.small_end.penetration_rate);
            }
        })
        .unwrap();
    contacts
}

/// Asserts agreement to `digits` significant digits' last unit, or 1e-6.
fn check(name: &str, found: f64, expected: f64, last_digit: f64) {
    let off = (found - expected).abs();
    eprintln!(
        "{name:32} {found:.9e} ({expected}) off by {:.1e}",
        off / expected
    );
    let allowed = (0.51 * last_digit).max(1e-6 * expected.abs());
    assert!(off <= allowed, "{name}: {found} {expected}");
}

#[test]
fn ideal_mechanism() {
    let mut machine = machine(5e-4, lankarani_nikravesh(5e-4, 1e-9));
    machine.throws[0].small_end = Revolute::Ideal;
    let mut dynamics = Dynamics::new(machine, false);
    let mut at = |t: f64| dynamics.evaluate(t, &[]).throws[0].accelerations.crosshead;
    check("top dead centre", at(0.0), -19_419.4, 0.1);
    let highest = (0..=4000)
        .map(|i| at(PERIOD * f64::from(i) / 4000.0))
        .fold(0.0, f64::max);
    check("largest", highest, 9_695.9, 0.1);
}

#[test]
fn the_first_six_touches() {
    let law = lankarani_nikravesh(5e-4, 1e-9);
    check("stiffness", stiffness(5e-4), 6.6102e10, 1e6);
    let contacts = run(machine(5e-4, law), 1e-13, 1.8e-3, 200, |_, _, _| ());
    // Time, crank angle in degrees where given, approach speed.
    let expected = [
        (0.227_286_032e-3, Some(6.818_58), 4.385_783),
        (0.637_056_430e-3, Some(19.111_69), 2.756_949),
        (0.749_700_280e-3, Some(22.491_01), 1.826_699),
        (1.085_947_034e-3, Some(32.578_41), 1.101_851),
        (1.205_816_128e-3, None, 0.823_801),
        (1.551_486_001e-3, Some(46.544_58), 0.270_939),
    ];
    for (i, (contact, (time, angle, approach))) in contacts.iter().zip(expected).enumerate() {
        check(
            &format!("touch {}: time", i + 1),
            contact.touch,
            time,
            1e-12,
        );
        if let Some(angle) = angle {
            let degrees = (SPEED * contact.touch).to_degrees();
            check(&format!("touch {}: angle", i + 1), degrees, angle, 1e-5);
        }
        check(
            &format!("touch {}: approach", i + 1),
            contact.approach,
            approach,
            1e-6,
        );
    }
    assert!(contacts.len() >= 6, "{} touches", contacts.len());
    let first = contacts[0];
    check("first: depth", first.depth, 77.952e-6, 1e-9);
    check("first: acceleration", first.acceleration, 3.2734e5, 10.0);
    check(
        "first: duration",
        first.parting - first.touch,
        53.437e-6,
        1e-9,
    );
    check("first: separation", first.separation, 3.911_49, 1e-5);
    let fifth = contacts[4];
    check(
        "fifth: duration",
        fifth.parting - fifth.touch,
        285.070e-6,
        1e-9,
    );
}

#[test]
fn pose_at_the_first_touch() {
    let law = lankarani_nikravesh(5e-4, 1e-9);
    let mut dynamics = Dynamics::new(machine(5e-4, law), false);
    let y = dynamics.initial_state();
    let mut integrator = Integrator::new(&mut dynamics, 0.0, &y, 1e-13, PERIOD / 40.0);
    integrator
        .advance(&mut dynamics, 0.227_286_032e-3, |_, _| ())
        .unwrap();
    let y = integrator.state().to_vec();
    let at = &dynamics.evaluate(integrator.time(), &y).throws[0];
    let e = at.joints.small_end.offset;
    // The source takes e from the slider's pin to the rod's eye.
    check(
        "direction",
        (-e.y).atan2(-e.x).to_degrees().abs(),
        177.912,
        1e-3,
    );
    check("slider", at.motion.crosshead, 0.170, 1e-12);
    check(
        "rod angle",
        at.motion.rod_sin_cos.0.asin(),
        -0.049_337_369,
        1e-9,
    );
    check("rod rate", at.motion.rod_rate, -214.886_909, 1e-6);
}

const BEFORE: usize = 5;
const COUNT: usize = 200;
const MEASURES: [&str; 5] = [
    "10 % of peaks below",
    "50 % of peaks below",
    "90 % of peaks below",
    "contact fraction",
    "touches",
];

/// The measures of 200 revolutions after 5: percentiles of the revolutions' peaks of the slider's
/// acceleration, share of time in contact, touches a revolution.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "counts of revolutions"
)]
fn measures(machine: Machine, tolerance: f64) -> [f64; 5] {
    let (begin, end) = (BEFORE as f64 * PERIOD, (BEFORE + COUNT) as f64 * PERIOD);
    let mut peaks = vec![0.0_f64; COUNT];
    let (mut inside, mut last) = (0.0, 0.0_f64);
    let contacts = run(machine, tolerance, end, 4, |t, acceleration, touching| {
        if t > begin {
            let cycle = (((t - begin) / PERIOD) as usize).min(COUNT - 1);
            peaks[cycle] = peaks[cycle].max(acceleration);
            inside += if touching { t - last.max(begin) } else { 0.0 };
        }
        last = t;
    });
    peaks.sort_by(f64::total_cmp);
    let touches = contacts.iter().filter(|c| c.touch > begin).count();
    [
        peaks[COUNT / 10],
        peaks[COUNT / 2],
        peaks[COUNT * 9 / 10],
        inside / (end - begin),
        touches as f64 / COUNT as f64,
    ]
}

/// Compares with the source's measures, each with half a unit of its last digit. The source's run
/// is one of 200 revolutions on a chaotic motion; so is each of eight of ours, whose tolerances
/// differ a little so that they go other ways. Their spread is the sampling error of each; that of four is
/// known too badly itself.
fn compare(name: &str, machine: &Machine, expected: [(f64, f64); 5]) {
    const RUNS: usize = 8;
    let tolerance = |run: usize| 1e-8 * (1.0 + 0.1 * run as f64);
    let runs: [_; RUNS] = std::array::from_fn(|run| measures(machine.clone(), tolerance(run)));
    let count = RUNS as f64;
    eprintln!("{name}:");
    for (i, (expected, rounding)) in expected.into_iter().enumerate() {
        let mean = runs.iter().map(|r| r[i]).sum::<f64>() / count;
        let square: f64 = runs.iter().map(|r| (r[i] - mean).powi(2)).sum();
        let spread = (square / (count - 1.0)).sqrt();
        let error = spread * (1.0 + 1.0 / count).sqrt();
        let what = MEASURES[i];
        eprintln!("  {what:20} {mean:.4e} ± {error:.0e}, source {expected:.3e}");
        assert!(
            (mean - expected).abs() <= 3.0 * error + rounding,
            "{name}, {what}: {mean} ± {error}, source {expected}"
        );
    }
}

#[test]
fn statistics_of_lankarani_and_nikravesh_at_half_a_millimetre() {
    // What v₀ a grazing touch gets is the source's convention; but the slowest of these touches
    // has 2.7e-3 m/s, and a floor of 1e-3 m/s gives the same bits as the source's 1e-9.
    compare(
        "LN, c = 0.5 mm",
        &machine(5e-4, lankarani_nikravesh(5e-4, 1e-9)),
        [
            (5.0e4, 5e2),
            (1.57e5, 5e2),
            (2.13e5, 5e2),
            (0.79, 5e-3),
            (12.0, 0.5),
        ],
    );
}

#[test]
#[ignore = "minutes: tests/nightly/run references"]
fn statistics_of_lankarani_and_nikravesh_at_a_fifth_of_a_millimetre() {
    compare(
        "LN, c = 0.2 mm",
        &machine(2e-4, lankarani_nikravesh(2e-4, 1e-9)),
        [
            (3.2e4, 5e2),
            (5.4e4, 5e2),
            (1.08e5, 5e2),
            (0.96, 5e-3),
            (4.0, 0.5),
        ],
    );
}

#[test]
fn lankarani_and_nikravesh_settles_into_contact_at_a_tenth_of_a_millimetre() {
    let found = measures(machine(1e-4, lankarani_nikravesh(1e-4, 1e-9)), 1e-8);
    eprintln!("LN, c = 0.1 mm: {found:.4?} (2.34e4 2.35e4 2.38e4)");
    // v₀ of the last touch damps the ringing for ever after; the start decides it: to 1 % only.
    for (found, expected) in found.into_iter().zip([2.34e4, 2.35e4, 2.38e4]) {
        assert!((found / expected - 1.0).abs() < 0.01, "{found} {expected}");
    }
    assert!((found[3] - 1.0).abs() < 1e-12);
    assert_eq!(found[4], 0.0);
}

#[test]
fn statistics_of_impact() {
    let law = ContactLaw::Impact(Impact {
        stiffness: 6.61e10,
        exponent: 1.5,
        damping: 5e3,
        depth: 1e-5,
    });
    compare(
        "IMPACT, c = 0.5 mm",
        &machine(5e-4, law),
        [
            (4.9e4, 5e2),
            (8.2e4, 5e2),
            (1.40e5, 5e2),
            (0.953, 5e-4),
            (2.025, 5e-3),
        ],
    );
}
