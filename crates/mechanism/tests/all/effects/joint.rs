//! Effects in a joint: its oil, its shape.

use super::near;
use crate::common::with_clearance;
use mechanism::Dynamics;
use mechanism::effects::{BearingOvality, Effect, Joint, Law, Oval, Place, SqueezeFilm};
use std::f64::consts::PI;

#[test]
fn a_film_pushes_back_as_ocvirk_s() {
    let (viscosity, length, clearance) = (0.03, 3e-3, 2e-4);
    let force = |effects: Vec<Effect>, rate: f64| {
        let mut machine = with_clearance(0.0, clearance, 2e4);
        machine.effects = effects;
        let mut dynamics = Dynamics::new(machine, false);
        let i = dynamics.layout().throws[0].small_end.unwrap();
        let mut y = dynamics.initial_state();
        y[i] = 0.5 * clearance;
        y[i + 2] = rate;
        dynamics.evaluate(0.0, &y).throws[0].joints.small_end.force
    };
    let film = |joint| Effect {
        law: Law::SqueezeFilm(SqueezeFilm {
            viscosity,
            length,
            roughness: 1e-6,
            separation: 1.0,
            long: 0.0,
        }),
        place: Place {
            joint: Some(joint),
            ..Place::default()
        },
    };
    let still = PI * viscosity * 0.035 * length.powi(3) / clearance.powi(3);
    for rate in [0.1, -0.1] {
        let found = force(vec![film(Joint::SmallEnd)], rate);
        near(found.x, -still * 1.5 / 0.75_f64.powf(2.5) * rate, 1e-9);
        assert!(found.y.abs() < 1e-12);
    }
    assert_eq!(force(vec![film(Joint::BigEnd)], 0.1).norm(), 0.0);
    // The film of a long bearing.
    let mut long = film(Joint::SmallEnd);
    if let Law::SqueezeFilm(film) = &mut long.law {
        film.long = 1.0;
    }
    near(
        force(vec![long], 0.1).x,
        -still / 0.75_f64.powf(1.5) * 0.1,
        1e-9,
    );
    // Where the metal touches the film is as thick as the roughness, however deep the journal goes.
    let resists = |effects: Vec<Effect>, depth: f64| {
        let mut machine = with_clearance(0.0, clearance, 2e4);
        machine.effects = effects;
        let mut dynamics = Dynamics::new(machine, false);
        let i = dynamics.layout().throws[0].small_end.unwrap();
        let mut y = dynamics.initial_state();
        (y[i], y[i + 2]) = (depth * clearance, 0.1);
        dynamics.evaluate(0.0, &y).throws[0]
            .joints
            .small_end
            .force
            .x
    };
    let mut rough = film(Joint::SmallEnd);
    if let Law::SqueezeFilm(film) = &mut rough.law {
        film.roughness = 0.1;
    }
    for depth in [1.05_f64, 1.3] {
        let found = resists(vec![rough.clone()], depth) - resists(Vec::new(), depth);
        let square = depth * depth;
        let deeper = square - 1.0 + 0.1;
        let thin: f64 = 0.1 + 0.5 * (f64::hypot(deeper, 0.02) - deeper);
        near(
            found,
            -still * (1.0 + 2.0 * square) / thin.powf(2.5) * 0.1,
            1e-7,
        );
        assert!((thin - 0.1).abs() < 1e-3);
    }
    // A film that cannot pull resists the approach alone; one that half can pulls half as much. It tears over 1 mm/s.
    for separation in [0.0, 0.5] {
        let mut weak = film(Joint::SmallEnd);
        if let Law::SqueezeFilm(film) = &mut weak.law {
            film.separation = separation;
        }
        for rate in [0.1, 1e-3, -1e-3, -0.1] {
            let whole = force(vec![film(Joint::SmallEnd)], rate).x;
            let found = force(vec![weak.clone()], rate).x / whole;
            let away = 0.5 * (1.0 - rate / f64::hypot(rate, 1e-3));
            let share = 1.0 - away * (1.0 - separation);
            assert!((found - share).abs() < 1e-9, "{rate}: {found}");
        }
    }
}

#[test]
fn an_oval_bearing_is_wider_along_its_long_axis() {
    let (clearance, amplitude, direction) = (2e-4, 5e-5, 0.4);
    let (lobes, lobes_direction) = (1e-5, 1.1);
    // Half of it in proportion to the clearance, which is twice that of the statement.
    let (growth, grown) = (0.5, 1.5);
    let mut machine = with_clearance(0.0, clearance, 2e4);
    machine.effects = vec![Effect {
        law: Law::BearingOvality(BearingOvality {
            amplitude,
            direction,
            oval: Oval::Bearing,
            lobes,
            lobes_direction,
            growth,
        }),
        place: Place {
            joint: Some(Joint::SmallEnd),
            ..Place::default()
        },
    }];
    let mut dynamics = Dynamics::new(machine, false);
    let i = dynamics.layout().throws[0].small_end.unwrap();
    let mut penetration = |angle: f64| {
        let mut y = dynamics.initial_state();
        y[i] = clearance * angle.cos();
        y[i + 1] = clearance * angle.sin();
        // At top dead centre the rod lies along x, but for the offset.
        let part = dynamics.evaluate(0.0, &y).throws[0];
        (
            part.joints.small_end.penetration,
            part.motion.rod_sin_cos.0.asin(),
        )
    };
    for (angle, wider) in [(0.0, 1.0), (PI / 2.0, -1.0), (PI, 1.0), (PI / 4.0, 0.0)] {
        let (found, rod) = penetration(direction + angle);
        let turned = grown * amplitude * (2.0 * (angle - rod)).cos();
        let third = grown * lobes * (3.0 * (direction + angle - rod - lobes_direction)).cos();
        assert!((found + turned + third).abs() < 1e-15, "{angle}: {found:e}");
        assert!((found + third + wider * grown * amplitude).abs() < 2e-3 * amplitude);
    }
}
