//! Switches that follow close on each other: a ball whose long flights and tiny hops alternate.

use integrate::{Integrator, System};

/// A ball above a floor that throws it up again, at `SPEEDS` in turn.
struct Ball {
    touches: Vec<f64>,
}

const GRAVITY: f64 = 9.81;
const SPEEDS: [f64; 2] = [0.005, 5.0];

impl System<f64> for Ball {
    fn dimension(&self) -> usize {
        2
    }
    fn derivative(&mut self, _t: f64, y: &[f64], dy: &mut [f64]) {
        dy[0] = y[1];
        dy[1] = -GRAVITY;
    }
    fn scales(&self) -> &[f64] {
        &[1.0, 1.0]
    }
    fn guard_count(&self) -> usize {
        1
    }
    fn guards(&mut self, _t: f64, y: &[f64], guards: &mut [f64]) {
        guards[0] = y[0];
    }
    fn switch(&mut self, _guard: usize, t: f64, y: &mut [f64]) {
        y[1] = SPEEDS[self.touches.len() % 2];
        self.touches.push(t);
    }
}

#[test]
fn a_hop_much_shorter_than_a_step_is_not_stepped_over() {
    // Flights are exact for the method, so steps are as long as allowed: 1 s, against 1 ms.
    let mut ball = Ball {
        touches: Vec::new(),
    };
    let mut run = Integrator::new(&mut ball, 0.0, &[1.0, 0.0], 1e-10, 1.0);
    run.advance(&mut ball, 60.0, |_, _| ()).unwrap();
    let mut expected = (2.0 / GRAVITY).sqrt();
    for (i, touch) in ball.touches.iter().enumerate() {
        assert!((touch - expected).abs() < 1e-9, "{i}: {touch} {expected}");
        expected += 2.0 * SPEEDS[i % 2] / GRAVITY;
    }
    assert!(expected > 60.0, "touches end before {expected}");
}

#[test]
fn an_observer_ends_the_integration_behind_its_step() {
    let mut ball = Ball {
        touches: Vec::new(),
    };
    let mut run = Integrator::new(&mut ball, 0.0, &[1.0, 0.0], 1e-10, 0.01);
    let mut seen = 0;
    let stopped = run.watch(&mut ball, 60.0, |_, step| {
        seen += 1;
        if step.start > 0.1 {
            step.stop();
        }
    });
    let Err(integrate::Error::Stopped { time }) = stopped else {
        panic!("{stopped:?}");
    };
    assert!((0.1..0.13).contains(&time), "{time}");
    assert!(seen >= 10, "{seen}");
}
