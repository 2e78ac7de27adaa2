//! The derivative of the state, which leaves out what it does not need of a full evaluation.

use crate::common;

use common::{REVOLUTION, with_clearance};
use integrate::System;
use mechanism::frame::Frame;
use mechanism::{Dynamics, Machine};

fn framed() -> Machine {
    let mut machine = with_clearance(3e-4, 3e-4, 2e4);
    machine.frame = Some(Frame {
        mass: 450.0,
        stiffness_x: 3e7,
        stiffness_y: 2e7,
        damping_x: 1e4,
        damping_y: 1e4,
        hardening: 0.0,
        carries: false,
    });
    machine
}

#[test]
fn what_was_evaluated_before_does_not_matter() {
    for (machine, ledger) in [
        (with_clearance(3e-4, 3e-4, 2e4), false),
        (with_clearance(3e-4, 3e-4, 2e4), true),
        (framed(), false),
    ] {
        let mut fresh = Dynamics::new(machine.clone(), ledger);
        let mut used = Dynamics::new(machine, ledger);
        let y: Vec<f64> = (0..fresh.dimension())
            .map(|i| 1e-4 * (1.0 + i as f64).sin())
            .collect();
        let time = 0.3 * REVOLUTION;
        let other: Vec<f64> = y.iter().map(|y| 0.5 - y).map(|y| 1e-4 * y).collect();
        used.evaluate(0.8 * REVOLUTION, &other);
        let (mut first, mut second) = (y.clone(), y.clone());
        fresh.derivative(time, &y, &mut first);
        used.derivative(time, &y, &mut second);
        assert_eq!(first, second);
        // And it is what a full evaluation finds.
        let whole = used.evaluate(time, &y).clone();
        let big = used.layout().throws[0].big_end.unwrap();
        assert_eq!(first[big + 2], whole.throws[0].accelerations.big_end.x);
        if let Some(frame) = used.layout().frame {
            assert_eq!(first[frame + 2..frame + 4], [whole.frame.x, whole.frame.y]);
        }
    }
}
