//! A second list of systems on which the intervals are counted, written down before any of them was run
//! and used for nothing else. Most are in Sprott's "Chaos and Time-Series Analysis" (2003), appendix A, and
//! his "Elegant Chaos" (2010).

use super::systems::{Case, State, flow, map};
use std::f64::consts::TAU;

/// The systems.
pub fn second() -> Vec<Case> {
    let near = [0.1, 0.2, 0.1, 0.0];
    vec![
        map(
            "pinchers",
            |[x, ..]| one((2.0 * (x - 0.5)).tanh().abs()),
            [0.0; 4],
        ),
        map(
            "Maynard Smith",
            |[x, ..]| one(2.2 * x / (1.0 + x.powi(9))),
            [0.6; 4],
        ),
        map("quadratic", |[x, ..]| one(1.85 - x * x), [0.2; 4]),
        Case {
            observed: |y| (TAU * y[0]).sin(),
            ..map("circle map, K = 3", circle, [0.1; 4])
        },
        Case {
            observed: |y| y[1],
            ..map("Kaplan-Yorke", kaplan_yorke, [0.31, 0.4, 0.0, 0.0])
        },
        map(
            "gingerbreadman",
            |[x, y, ..]| two(1.0 - y + x.abs(), x),
            [0.5, 3.7, 0.0, 0.0],
        ),
        map("predator and prey", predator, [0.5, 0.5, 0.0, 0.0]),
        map(
            "Henon, three coordinates",
            |[x, y, z, _]| [1.76 - y * y - 0.1 * z, x, y, 0.0],
            near,
        ),
        Case {
            observed: |y| y[1],
            ..map("standard, dissipative", dissipative, [0.3, 0.4, 0.0, 0.0])
        },
        map(
            "Rulkov",
            |[x, y, ..]| two(4.3 / (1.0 + x * x) + y, y - 0.001 * (x + 1.0)),
            [-1.0, -2.9, 0.0, 0.0],
        ),
        flow(
            "Genesio-Tesi",
            |[x, y, z, _]| [y, z, -x - 1.1 * y - 0.44 * z + x * x, 0.0],
            [0.1, 0.1, 0.1, 0.0],
        ),
        flow(
            "Sprott E",
            |[x, y, z, _]| [y * z, x * x - y, 1.0 - 4.0 * x, 0.0],
            [0.1, 0.1, 0.1, 0.0],
        ),
        flow(
            "Sprott F",
            |[x, y, z, _]| [y + z, -x + 0.5 * y, x * x - z, 0.0],
            [0.1, 0.1, 0.1, 0.0],
        ),
        flow(
            "Sprott G",
            |[x, y, z, _]| [0.4 * x + z, x * z - y, -x + y, 0.0],
            [0.1, 0.1, 0.1, 0.0],
        ),
        flow(
            "Sprott S",
            |[x, y, z, _]| [-x - 4.0 * y, x + z * z, 1.0 + x, 0.0],
            [0.1, 0.1, 0.1, 0.0],
        ),
        flow(
            "Burke-Shaw",
            |[x, y, z, _]| {
                [
                    -10.0 * (x + y),
                    -y - 10.0 * x * z,
                    10.0 * x * y + 4.272,
                    0.0,
                ]
            },
            near,
        ),
        flow(
            "Dadras",
            |[x, y, z, _]| {
                [
                    y - 3.0 * x + 2.7 * y * z,
                    1.7 * y - x * z + z,
                    2.0 * x * y - 9.0 * z,
                    0.0,
                ]
            },
            near,
        ),
        flow(
            "Roessler 1979",
            |[x, y, z, _]| [-y - z, x, 0.5 * (y - y * y) - 0.5 * z, 0.0],
            near,
        ),
        flow("Hindmarsh-Rose", hindmarsh, [-1.0, 0.0, 3.0, 0.0]),
        flow(
            "butterfly with a sign",
            |[x, y, z, _]| [0.55 * (y - x), z * x.signum(), x.abs() - 1.0, 0.0],
            near,
        ),
        flow(
            "jerk with a corner",
            |[x, v, a, _]| [v, a, -0.6 * a - v - x.abs() + 1.0, 0.0],
            near,
        ),
        flow(
            "jerk with a sign",
            |[x, v, a, _]| [v, a, -0.8 * (a + v + x - x.signum()), 0.0],
            near,
        ),
        Case {
            observed: |y| y[1],
            ..flow("Lorenz 1996, four sites", lorenz96, [1.0, 2.0, 3.0, 4.0])
        },
        flow(
            "Henon-Heiles, E = 1/6",
            henon_heiles,
            [0.4, 0.0, 0.0, 0.416_3],
        ),
        flow("Newton-Leipnik", leipnik, [0.349, 0.0, -0.16, 0.0]),
        flow(
            "Nose-Hoover",
            |[x, y, z, _]| [y, -x + y * z, 1.0 - y * y, 0.0],
            [0.0, 5.0, 0.0, 0.0],
        ),
    ]
}

fn one(x: f64) -> State {
    [x, 0.0, 0.0, 0.0]
}

fn two(x: f64, y: f64) -> State {
    [x, y, 0.0, 0.0]
}

fn circle([x, ..]: State) -> State {
    one((x + 0.5 - 3.0 / TAU * (TAU * x).sin()).rem_euclid(1.0))
}

/// Doubling, with a modulus a little below 1 so that it does not end in 0 after 53 steps.
fn kaplan_yorke([x, y, ..]: State) -> State {
    two(
        (2.0 * x).rem_euclid(0.999_95),
        0.2 * y + (2.0 * TAU * x).cos(),
    )
}

/// Beddington, Free and Lawton 1975.
fn predator([x, y, ..]: State) -> State {
    two(
        x * (3.0 * (1.0 - x) - 5.0 * y).exp(),
        x * (1.0 - (-5.0 * y).exp()),
    )
}

fn dissipative([x, y, ..]: State) -> State {
    let y = 0.1 * y + 8.8 * x.sin();
    two((x + y).rem_euclid(TAU), y)
}

fn hindmarsh([x, y, z, _]: State) -> State {
    [
        y - x.powi(3) + 3.0 * x * x - z + 3.25,
        1.0 - 5.0 * x * x - y,
        0.006 * (4.0 * (x + 1.6) - z),
        0.0,
    ]
}

fn lorenz96(x: State) -> State {
    std::array::from_fn(|i| (x[(i + 1) % 4] - x[(i + 2) % 4]) * x[(i + 3) % 4] - x[i] + 15.0)
}

fn henon_heiles([x, y, u, v]: State) -> State {
    [u, v, -x - 2.0 * x * y, -y - x * x + y * y]
}

fn leipnik([x, y, z, _]: State) -> State {
    [
        -0.4 * x + y + 10.0 * y * z,
        -x - 0.4 * y + 5.0 * x * z,
        0.175 * z - 5.0 * x * y,
        0.0,
    ]
}
