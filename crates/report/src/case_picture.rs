//! The picture of one simulated case.

use crate::over_crank_angle::over_crank_angle;
use figure::{Axis, Circle, Colour, Figure, Mark, Panel, Series};
use simulate::Trace;

/// Everything that the picture shows, at the times of one recording.
///
/// All signals have the length of `crank_angle_rad`; where one is shorter, the shorter counts.
#[derive(Clone, Debug)]
pub struct CasePicture<'a> {
    /// Heading: the machine, its operating point.
    pub title: &'a str,
    /// Crank angle, running on or starting again at every revolution.
    pub crank_angle_rad: &'a [f64],
    /// Acceleration of the crosshead.
    pub acceleration_m_s2: &'a [f64],
    /// Velocity of the crosshead.
    pub velocity_m_s: &'a [f64],
    /// The joints with clearance; none for an ideal machine.
    pub joints: Vec<ClearJoint<'a>>,
}

/// What happens in one joint with clearance.
#[derive(Clone, Debug)]
pub struct ClearJoint<'a> {
    /// Name in the data, for instance `big_end`.
    pub name: &'a str,
    /// Radial clearance.
    pub clearance_m: f64,
    /// The journal's centre from the bearing's.
    pub x_m: &'a [f64],
    /// The journal's centre from the bearing's, across `x_m`.
    pub y_m: &'a [f64],
    /// Normal contact force.
    pub contact_force_n: &'a [f64],
}

impl<'a> CasePicture<'a> {
    /// Of the first throw of a run and its joints with clearance; none without a throw.
    pub fn new(title: &'a str, trace: &'a Trace) -> Option<Self> {
        Self::of_throw(title, trace, 0)
    }

    /// Of throw number `index` of a run and its joints with clearance; the main bearing stands with the first.
    /// None without that throw.
    pub fn of_throw(title: &'a str, trace: &'a Trace, index: usize) -> Option<Self> {
        let throw = trace.throws.get(index)?;
        let main = if index == 0 { &trace.main } else { &None };
        let joints = [
            ("main", main),
            ("big_end", &throw.big_end),
            ("small_end", &throw.small_end),
        ];
        let clear = joints.into_iter().filter_map(|(name, joint)| {
            let joint = joint.as_ref()?;
            Some(ClearJoint {
                name,
                clearance_m: joint.clearance,
                x_m: &joint.x,
                y_m: &joint.y,
                contact_force_n: &joint.normal_force,
            })
        });
        Some(Self {
            title,
            crank_angle_rad: &trace.crank_angle,
            acceleration_m_s2: &throw.acceleration,
            velocity_m_s: &throw.velocity,
            joints: clear.collect(),
        })
    }

    /// The picture as SVG: acceleration and contact force against crank angle, the
    /// velocity-acceleration portrait, and the orbit of each journal in its clearance circle.
    pub fn svg(&self) -> String {
        let mut second = self.motion();
        if self.joints.is_empty() {
            second.push(Panel {
                title: "Journal orbit".to_owned(),
                x: Axis::linear("eccentricity x (µm)"),
                y: Axis::linear("eccentricity y (µm)"),
                equal_axes: true,
                note: "ideal joints: no orbit".to_owned(),
                ..Panel::default()
            });
        }
        Figure {
            title: self.title.to_owned(),
            rows: vec![vec![self.acceleration(), self.contact_force()], second],
            width: 1000.0,
            row_height: 270.0,
            ..Figure::default()
        }
        .svg()
    }

    /// The velocity-acceleration portrait, and the orbit of each journal.
    pub(crate) fn motion(&self) -> Vec<Panel> {
        let joints = self.joints.iter().enumerate();
        let orbits = joints.map(|(i, joint)| orbit(joint, joint_colour(i)));
        std::iter::once(self.portrait()).chain(orbits).collect()
    }

    fn acceleration(&self) -> Panel {
        Panel {
            title: "Crosshead acceleration: each revolution, and the mean".to_owned(),
            x: Axis::crank_angle(),
            y: Axis::linear("acceleration (m/s²)"),
            series: over_crank_angle(
                self.crank_angle_rad,
                self.acceleration_m_s2,
                Colour::Class(0),
                "",
            ),
            ..Panel::default()
        }
    }

    fn contact_force(&self) -> Panel {
        let series = self.joints.iter().enumerate().flat_map(|(i, joint)| {
            over_crank_angle(
                self.crank_angle_rad,
                joint.contact_force_n,
                joint_colour(i),
                &text::words(joint.name),
            )
        });
        let note = if self.joints.is_empty() {
            "ideal joints: no contact force"
        } else {
            ""
        };
        Panel {
            title: "Contact force: each revolution, and the mean".to_owned(),
            x: Axis::crank_angle(),
            y: Axis::linear("normal force (N)"),
            series: series.collect(),
            note: note.to_owned(),
            ..Panel::default()
        }
    }

    fn portrait(&self) -> Panel {
        let points = self
            .velocity_m_s
            .iter()
            .zip(self.acceleration_m_s2)
            .map(|(&v, &a)| [v, a]);
        Panel {
            title: "Velocity-acceleration portrait".to_owned(),
            x: Axis::linear("velocity (m/s)"),
            y: Axis::linear("acceleration (m/s²)"),
            series: vec![Series::new("", Colour::Class(0), Mark::Line, points)],
            ..Panel::default()
        }
    }
}

/// The colour of the i-th joint, apart from that of the acceleration.
fn joint_colour(i: usize) -> Colour {
    Colour::Class(i + 1)
}

fn orbit(joint: &ClearJoint<'_>, colour: Colour) -> Panel {
    const MICROMETRES: f64 = 1e6;
    let points = joint
        .x_m
        .iter()
        .zip(joint.y_m)
        .map(|(&x, &y)| [x * MICROMETRES, y * MICROMETRES]);
    let name = text::capitalised(&text::words(joint.name));
    Panel {
        title: format!(
            "{name} orbit, clearance {}",
            text::clearance(joint.clearance_m)
        ),
        x: Axis::linear("eccentricity x (µm)"),
        y: Axis::linear("eccentricity y (µm)"),
        series: vec![Series::new("", colour, Mark::Line, points)],
        circles: vec![Circle {
            centre: [0.0, 0.0],
            radius: joint.clearance_m * MICROMETRES,
        }],
        equal_axes: true,
        ..Panel::default()
    }
}
