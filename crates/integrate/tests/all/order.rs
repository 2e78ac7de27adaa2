//! The order of the method, on a smooth stretch and across located contacts.

use integrate::{Integrator, System};

/// A mass above a linear spring, under gravity: free flight and contact both in closed form.
struct Bouncer {
    touching: bool,
    gravity: f64,
    /// Angular frequency of the mass on the spring, rad/s.
    frequency: f64,
    located: bool,
}

impl System<f64> for Bouncer {
    fn dimension(&self) -> usize {
        2
    }
    fn derivative(&mut self, _t: f64, y: &[f64], dy: &mut [f64]) {
        let touching = if self.located {
            self.touching
        } else {
            y[0] < 0.0
        };
        let spring = if touching {
            self.frequency.powi(2) * y[0]
        } else {
            0.0
        };
        dy[0] = y[1];
        dy[1] = -self.gravity - spring;
    }
    fn scales(&self) -> &[f64] {
        &[1.0, 1.0]
    }
    fn guard_count(&self) -> usize {
        usize::from(self.located)
    }
    fn guards(&mut self, _t: f64, y: &[f64], guards: &mut [f64]) {
        if self.located {
            guards[0] = if self.touching { -y[0] } else { y[0] };
        }
    }
    fn switch(&mut self, _guard: usize, _t: f64, _y: &mut [f64]) {
        self.touching = !self.touching;
    }
}

impl Bouncer {
    fn new(located: bool) -> Self {
        Self {
            touching: false,
            gravity: 9.81,
            frequency: 40.0,
            located,
        }
    }

    /// Time between two touches after a fall from `height`, by the closed form.
    fn period(&self, height: f64) -> f64 {
        let speed = (2.0 * self.gravity * height).sqrt();
        let flight = 2.0 * speed / self.gravity;
        let contact = 2.0 * (std::f64::consts::PI - (self.frequency * speed / self.gravity).atan())
            / self.frequency;
        flight + contact
    }

    /// Error of the height at the top after `bounces` bounces with steps of `step`.
    fn error(mut self, bounces: u32, step: f64) -> f64 {
        let height = 0.1;
        let end = self.period(height) * f64::from(bounces);
        let mut integrator = Integrator::new(&mut self, 0.0, &[height, 0.0], 1e9, step);
        integrator.set_length(step);
        integrator.advance(&mut self, end, |_, _| ()).unwrap();
        let y = integrator.state();
        (y[0] - height).abs() + y[1].abs()
    }
}

/// A nonlinear problem with a known end: the two-body orbit of eccentricity 0.3 returns after 2π.
struct Orbit;

impl System<f64> for Orbit {
    fn dimension(&self) -> usize {
        4
    }
    fn derivative(&mut self, _t: f64, y: &[f64], dy: &mut [f64]) {
        let cube = (y[0] * y[0] + y[1] * y[1]).sqrt().powi(3);
        dy.copy_from_slice(&[y[2], y[3], -y[0] / cube, -y[1] / cube]);
    }
    fn scales(&self) -> &[f64] {
        &[1.0; 4]
    }
}

fn orbit_error(step: f64) -> f64 {
    let start = [0.7, 0.0, 0.0, (1.3_f64 / 0.7).sqrt()];
    let mut integrator = Integrator::new(&mut Orbit, 0.0, &start, 1e9, step);
    integrator.set_length(step);
    integrator
        .advance(&mut Orbit, std::f64::consts::TAU, |_, _| ())
        .unwrap();
    let y = integrator.state();
    y.iter().zip(start).map(|(a, b)| (a - b).abs()).sum()
}

/// Slope of log error over log step by least squares.
fn order(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let logs: Vec<(f64, f64)> = points.iter().map(|(h, e)| (h.ln(), e.ln())).collect();
    let (mx, my) = logs
        .iter()
        .fold((0.0, 0.0), |s, p| (s.0 + p.0 / n, s.1 + p.1 / n));
    let (num, den) = logs.iter().fold((0.0, 0.0), |s, p| {
        (s.0 + (p.0 - mx) * (p.1 - my), s.1 + (p.0 - mx).powi(2))
    });
    num / den
}

fn table(name: &str, steps: &[f64], error: impl Fn(f64) -> f64) -> f64 {
    let points: Vec<(f64, f64)> = steps.iter().map(|h| (*h, error(*h))).collect();
    let slope = order(&points);
    eprintln!("{name}: order {slope:.2}");
    for (h, e) in &points {
        eprintln!("  step {h:.5}  error {e:.3e}");
    }
    slope
}

#[test]
fn order_is_eight_on_a_smooth_stretch() {
    let steps = [64.0, 80.0, 100.0, 128.0].map(|n| std::f64::consts::TAU / n);
    let slope = table("two-body orbit", &steps, orbit_error);
    assert!((7.5..9.5).contains(&slope), "{slope}");
}

#[test]
fn order_is_eight_across_located_contacts_and_low_where_they_are_stepped_over() {
    let steps = [0.016, 0.0133, 0.0111, 0.0092, 0.0077];
    let located = table("bounces, located", &steps, |h| {
        Bouncer::new(true).error(3, h)
    });
    let blind = table("bounces, stepped over", &steps, |h| {
        Bouncer::new(false).error(3, h)
    });
    assert!((7.5..10.0).contains(&located), "{located}");
    assert!(blind < 4.0, "{blind}");
}

#[test]
fn a_tolerance_that_cannot_be_met_is_an_error_with_its_time() {
    struct Blow;
    impl System<f64> for Blow {
        fn dimension(&self) -> usize {
            1
        }
        fn derivative(&mut self, _t: f64, y: &[f64], dy: &mut [f64]) {
            dy[0] = y[0] * y[0];
        }
        fn scales(&self) -> &[f64] {
            &[1.0]
        }
    }
    let mut integrator = Integrator::new(&mut Blow, 0.0, &[1.0], 1e-9, f64::INFINITY);
    let error = integrator.advance(&mut Blow, 2.0, |_, _| ()).unwrap_err();
    let integrate::Error::StepTooSmall { time, .. } = error else {
        panic!("{error}");
    };
    assert!((time - 1.0).abs() < 1e-6, "{time}");
}
