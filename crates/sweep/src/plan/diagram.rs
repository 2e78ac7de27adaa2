//! A bifurcation diagram, made ready: its values, and the machine at each of them.

use input::quantity::{Kind, Speed};
use input::{Error, MachineFile, Problem, paths};
use mechanism::Machine;
use serde_json::Value;
use simulate::bifurcation::{Chunk, Direction, WalkSettings};
use simulate::poincare::{Joint, clear_joints};

use super::axis::{Axis, Frame, JointSet, Target, check_clearances, own};
use super::case::rpm;
use super::levels::Levels;
use super::name::check_diagram;
use super::sampler::{same_dimension, text};
use crate::sweep_file::{Amount, Bifurcation, Directions, Range, Values};

/// Values that are walked without a break.
const CHUNK: usize = 24;
/// Revolutions at a value before the recording.
const TRANSIENT: u32 = 40;

/// A bifurcation diagram.
#[derive(Clone, Debug)]
pub struct Diagram {
    /// Its name.
    pub name: String,
    /// What changes.
    pub path: String,
    /// Unit of the values, where they have one; rpm for a speed.
    pub unit: Option<String>,
    /// The ways in which the values are gone through.
    pub directions: Vec<Direction>,
    /// Crank angle of the section, rad.
    pub angle: f64,
    /// Revolutions at each value.
    pub settings: WalkSettings,
    /// The joints with clearance.
    pub joints: Vec<Joint>,
    chunk: usize,
    set: JointSet,
    /// What is set, the parameter last.
    axes: Vec<Axis<Levels>>,
}

impl Diagram {
    /// The diagram that the sweep file has at `bifurcations.{position}`.
    pub(super) fn new(file: &Bifurcation, position: usize, frame: &Frame) -> Result<Self, Error> {
        let key = format!("bifurcations.{position}");
        check_diagram(&file.name).map_err(|e| e.under(&key))?;
        let set = match &file.joints {
            None => Vec::new(),
            Some(names) => {
                let set = frame.set(&names.clone().into());
                set.map_err(|e| e.under("joints").under(&key))?
            }
        };
        let sets = file.joints.as_ref().map(|_| std::slice::from_ref(&set));
        let mut axes = Vec::new();
        for (name, value) in &file.set.0 {
            let key = format!("{key}.set.{name}");
            let target = target(name, sets, &key, frame)?;
            if target == Target::Load {
                frame.check_load(value).map_err(|e| e.under(&key))?;
            }
            let values = Levels::List(vec![value.clone()]);
            axes.push(Axis {
                key,
                target,
                values,
            });
        }
        axes.push(Axis {
            target: parameter(file, &set, frame).map_err(|e| e.under(&key))?,
            values: values(file).map_err(|e| e.under(&key))?,
            key: key.clone(),
        });
        check_clearances(std::slice::from_ref(&set), &axes, &key, frame).map_err(|_| {
            let expected = "their clearance as path, or beside it, e.g. 'set: {clearance: 0.2 mm}'";
            Error::unexpected(
                format!("{key}.joints"),
                "joints without clearance",
                expected,
            )
        })?;
        let mut diagram = Self {
            name: file.name.clone(),
            path: file.path.clone(),
            unit: unit(&file.from),
            directions: match file.directions {
                Directions::Up => vec![Direction::Up],
                Directions::Down => vec![Direction::Down],
                Directions::Both => vec![Direction::Up, Direction::Down],
            },
            angle: file.at.map_or(0.0, |angle| angle.si()),
            settings: WalkSettings {
                transient: file.transient.map_or(TRANSIENT, |n| n.get()),
                revolutions: file.revolutions.get(),
            },
            joints: Vec::new(),
            chunk: file.chunk.map_or(CHUNK, |n| n.get() as usize),
            set,
            axes,
        };
        // Both ends are tried; a value between them that makes no machine gets a reason.
        for (end, value) in [("from", 0), ("to", diagram.count() - 1)] {
            let machine = diagram.machine(value, frame);
            let machine = machine.map_err(|e| diagram.blame(e, &key, end, frame))?;
            diagram.joints = clear_joints(&machine);
        }
        Ok(diagram)
    }

    fn parameter(&self) -> &Axis<Levels> {
        &self.axes[self.axes.len() - 1]
    }

    /// Number of values.
    pub fn count(&self) -> usize {
        self.parameter().values.len() as usize
    }

    /// Value number `value`, SI; in rpm for a speed.
    pub fn value(&self, value: usize) -> f64 {
        let amount = Amount::from_value(&self.parameter().values.at(value));
        match amount {
            Some(amount) if amount.dimension == Some(Speed::DIMENSION) => rpm(amount.si),
            amount => amount.map_or(f64::NAN, |amount| amount.si),
        }
    }

    /// What is walked in one piece: all chunks of the first direction, then those of the second.
    pub fn chunks(&self) -> Vec<Chunk> {
        let directions = self.directions.iter();
        let cut = |direction: &Direction| Chunk::cut(*direction, self.count(), self.chunk);
        directions.flat_map(cut).collect()
    }

    /// Revolutions to simulate.
    pub fn revolutions(&self) -> u64 {
        let chunks = self.chunks();
        chunks.iter().map(|c| c.revolutions(&self.settings)).sum()
    }

    /// What is set at value number `value`, with the key of the sweep file that it comes from.
    fn assignments(&self, value: usize, frame: &Frame) -> Vec<(String, Value, String)> {
        let own = own(&self.axes);
        let parameter = self.axes.len() - 1;
        let mut all = Vec::new();
        for (i, axis) in self.axes.iter().enumerate() {
            let level = if i == parameter { value } else { 0 };
            let mut assigned = Vec::new();
            let value = axis.values.at(level);
            frame.assign(&axis.target, &value, &self.set, &own, &mut assigned);
            let keyed = |(path, value)| (path, value, axis.key.clone());
            all.extend(assigned.into_iter().map(keyed));
        }
        all
    }

    /// The machine at value number `value`.
    pub(super) fn machine(&self, value: usize, frame: &Frame) -> Result<Machine, Error> {
        let mut tree = frame.machine.clone();
        for (path, value, _) in self.assignments(value, frame) {
            paths::set(&mut tree, &path, value)?;
        }
        Ok(MachineFile::from_tree(&tree)?.resolve()?.machine)
    }

    /// `error` of the machine at one end, at the line of the sweep file that it comes from.
    fn blame(&self, error: Error, key: &str, end: &str, frame: &Frame) -> Error {
        let value = if end == "from" { 0 } else { self.count() - 1 };
        let found = self.assignments(value, frame).into_iter().rev();
        let mut found = found.filter(|(path, ..)| {
            let within = |a: &str, b: &str| {
                let rest = a.strip_prefix(b);
                rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
            };
            within(path, error.key()) || within(error.key(), path)
        });
        match found.next() {
            Some((.., axis)) if axis == key => {
                Error::new(format!("{key}.{end}"), error.problem().clone())
            }
            Some((.., axis)) => Error::new(axis, error.problem().clone()),
            None => {
                let problem = format!("the machine at its end '{end}': {error}");
                Error::new(key, Problem::Other(problem))
            }
        }
    }
}

/// What `name` at `key` of the sweep file sets; `sets` is that of its `joints`, if any.
fn target(
    name: &str,
    sets: Option<&[JointSet]>,
    key: &str,
    frame: &Frame,
) -> Result<Target, Error> {
    if name == "clearance" && sets.is_none() {
        let expected = "joints beside it, e.g. 'joints: [big_end]'";
        return Err(Error::unexpected(
            key,
            "a clearance without joints",
            expected,
        ));
    }
    frame.target(name, sets, key)
}

/// What the parameter sets.
fn parameter(file: &Bifurcation, set: &JointSet, frame: &Frame) -> Result<Target, Error> {
    let sets = file.joints.as_ref().map(|_| std::slice::from_ref(set));
    match target(&file.path, sets, "path", frame)? {
        Target::Load => {
            let expected = "the path of one number, e.g. cylinder.discharge";
            Err(Error::unexpected("path", "load", expected))
        }
        Target::ClearanceOf { joint } if !set.contains(&joint) => {
            let expected = format!("{} among joints", frame.joints[joint].name);
            Err(Error::unexpected("path", &file.path, expected))
        }
        Target::Clearance if set.is_empty() => {
            Err(Error::unexpected("joints", "no joint", "at least one"))
        }
        target => Ok(target),
    }
}

fn values(file: &Bifurcation) -> Result<Levels, Error> {
    let (from, to) = (file.from, file.to);
    same_dimension(&[from, to]).map_err(|e| e.under("to"))?;
    let levels = Levels::new(&Values::Rule(Range {
        from,
        to,
        count: file.steps,
        spacing: file.spacing,
    }))?;
    if from.si >= to.si {
        let expected = format!("more than {}, where it begins", text(&from));
        return Err(Error::unexpected("to", text(&to), expected));
    }
    Ok(levels)
}

fn unit(amount: &Amount) -> Option<String> {
    match amount.dimension {
        Some(dimension) if dimension == Speed::DIMENSION => Some("rpm".into()),
        dimension => dimension.map(|d| d.to_string()).filter(|unit| unit != "%"),
    }
}
