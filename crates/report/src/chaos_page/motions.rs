//! Portraits, Poincaré sections and orbits of the cases that are shown: the same rows and columns
//! in every figure.

use super::ChaosPage;
use crate::class_colour::class_colour;
use crate::plate::Plate;
use crate::revolutions::last_turns;
use figure::{Axis, Circle, Colour, Figure, Mark, Panel, Series, Share};
use study::chaos::motions::{Motion, Orbit};
use study::classes;

/// Revolutions that a portrait shows at most: more only blacken it.
const REVOLUTIONS: usize = 10;
/// Revolutions that an orbit shows at most.
const ORBIT_REVOLUTIONS: usize = 4;
/// Largest height of the square of an orbit in pixels.
const ORBIT_HEIGHT: f64 = 180.0;
/// Of more cases than this a caption names the first and the last.
const MOST_NAMED: usize = 6;
/// Largest plotting area of a small multiple in pixels.
const HEIGHT: f64 = 150.0;

/// Velocity against acceleration.
pub(super) fn portraits(page: &ChaosPage) -> Vec<Plate> {
    let panel = |motion: &Motion| {
        let points = motion.velocity_m_s.iter().zip(&motion.acceleration_m_s2);
        let first = last_turns(&motion.crank_angle_rad, REVOLUTIONS);
        let points = points.skip(first).map(|(&v, &a)| [v, a]);
        Panel {
            x: Axis::linear("velocity (m/s)"),
            y: Axis::linear("acceleration (m/s²)"),
            series: vec![Series::new(
                "",
                colour(page, motion),
                Mark::HairLine,
                points,
            )],
            ..Panel::default()
        }
    };
    plates(page, || Plate {
        heading: "Portraits of the crosshead".to_owned(),
        caption: format!(
            "Acceleration of the crosshead against its velocity over the last {REVOLUTIONS} revolutions or fewer. All \
             panels share one scale. A single closed curve is a motion that repeats every revolution, a double one a motion \
             that repeats every second revolution; a filled band is a motion that does not repeat. {}",
            cases(page)
        ),
        figure: small_multiples(page, panel, Share::All, HEIGHT),
        ..Plate::default()
    })
}

/// The colour of the class of a motion: the joints with clearance.
fn colour(page: &ChaosPage, motion: &Motion) -> Colour {
    let joints: Vec<&str> = motion
        .joints
        .iter()
        .map(|orbit| orbit.name.as_str())
        .collect();
    page.class_colour(&joints.join("+"))
}

/// Once a revolution, and at every impact.
pub(super) fn sections(page: &ChaosPage) -> Vec<Plate> {
    let strobe = |motion: &Motion| Panel {
        x: Axis::linear("velocity (m/s)"),
        y: Axis::linear("acceleration (m/s²)"),
        series: vec![Series::new(
            "",
            colour(page, motion),
            Mark::Points,
            motion.strobe.iter().copied(),
        )],
        ..Panel::default()
    };
    let impacts = |motion: &Motion| Panel {
        x: Axis {
            range: Some((0.0, 360.0)),
            ..Axis::crank_angle()
        },
        y: Axis::linear("approach (m/s)"),
        series: per_joint(page, motion, Mark::WideDots, |orbit| {
            orbit
                .impacts
                .iter()
                .map(|&[angle, speed]| [angle.to_degrees(), speed])
                .collect()
        }),
        note: if motion.joints.iter().all(|orbit| orbit.impacts.is_empty()) {
            "no impact".to_owned()
        } else {
            String::new()
        },
        ..Panel::default()
    };
    let mut made = plates(page, || Plate {
        heading: "Sections once a revolution".to_owned(),
        caption: format!(
            "Velocity and acceleration of the crosshead when the crank passes angle 0, one dot per revolution. All panels \
             share one scale. One dot is a motion that repeats every revolution, two dots one that repeats every second \
             revolution. A curve is quasi-periodic, a scatter is chaotic or has not settled. {}",
            cases(page)
        ),
        figure: small_multiples(page, strobe, Share::All, HEIGHT),
        ..Plate::default()
    });
    made.extend(plates(page, || Plate {
        heading: "Sections at impact".to_owned(),
        caption: format!(
            "Crank angle and speed of each impact of the journal on its bearing. All panels share one scale. A periodic \
             motion has impacts at the same angles with the same speeds; a motion that does not repeat has clouds. A panel \
             without dots belongs to a journal that never leaves its bearing. {}",
            cases(page)
        ),
        figure: small_multiples(page, impacts, Share::All, HEIGHT),
        ..Plate::default()
    }));
    made
}

/// The journals in their clearance circles.
pub(super) fn orbits(page: &ChaosPage) -> Vec<Plate> {
    const MICROMETRES: f64 = 1e6;
    let panel = |motion: &Motion| Panel {
        x: Axis::linear("x (µm)"),
        y: Axis::linear("y (µm)"),
        series: per_joint(page, motion, Mark::HairLine, |orbit| {
            let points = orbit.x_m.iter().zip(&orbit.y_m);
            let points = points.skip(last_turns(&motion.crank_angle_rad, ORBIT_REVOLUTIONS));
            points
                .map(|(&x, &y)| [x * MICROMETRES, y * MICROMETRES])
                .collect()
        }),
        circles: motion
            .joints
            .iter()
            .map(|orbit| Circle {
                centre: [0.0, 0.0],
                radius: orbit.clearance_m * MICROMETRES,
            })
            .collect(),
        equal_axes: true,
        ..Panel::default()
    };
    plates(page, || Plate {
        heading: "Orbits in the clearance circle".to_owned(),
        caption: format!(
            "The centre of the journal in its bearing over the last {ORBIT_REVOLUTIONS} revolutions or fewer. The radius of \
             the grey circle is the clearance. Inside the circle the journal is free; outside, journal and bearing are in contact, \
             and the distance to the circle is the penetration. One closed curve is a periodic motion. With clearance in two \
             joints, both orbits are in one panel. Every panel has its own scale, the same along both axes. {}",
            cases(page)
        ),
        figure: small_multiples(page, panel, Share::None, ORBIT_HEIGHT),
        ..Plate::default()
    })
}

/// The plate, if there are motions to show.
fn plates(page: &ChaosPage, plate: impl Fn() -> Plate) -> Vec<Plate> {
    let any = page
        .motions
        .iter()
        .flat_map(|row| &row.motions)
        .any(Option::is_some);
    any.then(plate).into_iter().collect()
}

/// Which cases the panels are of; of many the first and the last.
fn cases(page: &ChaosPage) -> String {
    let motions = page.motions.iter().flat_map(|row| &row.motions).flatten();
    let ids: Vec<&str> = motions.map(|motion| motion.case_id.as_str()).collect();
    let named = match ids.as_slice() {
        [first, .., last] if ids.len() > MOST_NAMED => {
            format!(
                "{first} to {last} ({} shown)",
                text::counted(ids.len(), "case")
            )
        }
        _ => ids.join(", "),
    };
    format!("Simulated again without sensors: {named}.")
}

fn per_joint(
    page: &ChaosPage,
    motion: &Motion,
    mark: Mark,
    points: impl Fn(&Orbit) -> Vec<[f64; 2]>,
) -> Vec<Series> {
    let series = motion.joints.iter().map(|orbit| {
        let colour = class_colour(&orbit.name, &page.joints, std::iter::empty());
        Series::new(classes::name(&orbit.name), colour, mark, points(orbit))
    });
    series.collect()
}

/// A row of panels for each row of motions.
fn small_multiples(
    page: &ChaosPage,
    panel: impl Fn(&Motion) -> Panel,
    share: Share,
    row_height: f64,
) -> Figure {
    let rows = page.motions.iter().map(|row| {
        let panels = row.motions.iter().map(|motion| match motion {
            Some(motion) => Panel {
                title: motion.title.clone(),
                ..panel(motion)
            },
            None => Panel {
                note: "not in the sweep".to_owned(),
                ..panel(&Motion::default())
            },
        });
        panels.collect()
    });
    Figure {
        rows: rows.collect(),
        row_headings: page.motions.iter().map(|row| row.heading.clone()).collect(),
        row_height,
        share_x: share,
        share_y: share,
        ..Figure::default()
    }
}
