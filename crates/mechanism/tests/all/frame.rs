//! The free vibration of a frame.

use mechanism::frame::{Frame, Swing};

/// Of 1 kg, the same along both axes: 280 rad/s, with this damping ratio.
fn frame(ratio: f64) -> Frame<f64> {
    let (stiffness, damping) = (280.0 * 280.0, 2.0 * ratio * 280.0);
    Frame {
        mass: 1.0,
        stiffness_x: stiffness,
        stiffness_y: stiffness,
        damping_x: damping,
        damping_y: damping,
        hardening: 0.0,
        carries: false,
    }
}

fn product(a: Swing, b: Swing) -> Swing {
    let entry = |i: usize, j: usize| a[i][0] * b[0][j] + a[i][1] * b[1][j];
    [[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]]
}

/// In a short time place and rate change by the equation itself, and two times make of them what their sum makes: below, at and beyond
/// critical damping.
#[test]
fn a_free_vibration_obeys_its_equation() {
    for ratio in [0.0, 0.05, 1.0, 3.0] {
        let frame = frame(ratio);
        let at = |time| frame.swing(time)[0];
        let short = 1e-7;
        let [[a, b], [c, d]] = at(short);
        let rates = [(a - 1.0) / short, b / short, c / short, (d - 1.0) / short];
        let expected = [0.0, 1.0, -frame.stiffness_x, -frame.damping_x];
        for (rate, expected) in rates.iter().zip(expected) {
            let off = (rate - expected).abs();
            assert!(
                off < 1e-2 + 1e-3 * expected.abs(),
                "{ratio}: {rate}, {expected}"
            );
        }
        let [twice, whole] = [product(at(0.013), at(0.029)), at(0.042)];
        for (a, b) in twice.as_flattened().iter().zip(whole.as_flattened()) {
            assert!((a - b).abs() < 1e-10 * (1.0 + b.abs()), "{ratio} {a} {b}");
        }
    }
}

#[test]
fn a_frame_that_hardens_or_swings_for_ever_is_not_linear() {
    assert!(frame(0.05).is_linear());
    assert!(!frame(0.0).is_linear());
    let hardening = Frame {
        hardening: 0.1,
        ..frame(0.05)
    };
    assert!(!hardening.is_linear());
}
