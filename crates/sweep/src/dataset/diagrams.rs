//! Bifurcation diagrams: `bifurcations/NAME.parquet`, one row per direction and value.
//!
//! The chunks of all diagrams run side by side; a diagram is written when its last chunk is there,
//! and not computed again after an interruption.

use std::sync::atomic::Ordering;

use recordings::formats::parquet::TableWriter;
use recordings::{Column, FileEntry, Kind, Role, Schema, Value};
use simulate::bifurcation::{Chunk, Machines, Walk};
use simulate::poincare::{Joint, Revolution, ThrowPoint};

use super::check::Check;
use super::commit::{DiagramCommit, Found};
use super::layout::DIAGRAMS;
use super::options::Options;
use super::output::Output;
use super::progress::Progress;
use super::recording::Failure;
use super::tables::prefixed;
use crate::in_order::{in_order, pool};
use crate::plan::Diagram;
use crate::{Error, Plan};

/// Rows of one row group.
const ROWS_PER_GROUP: usize = 256;

/// Computes the diagrams of `plan` that are not there yet.
///
/// # Errors
/// [`Error::DiagramsCancelled`] if it is stopped, [`Error::NotDeterministic`] if a diagram has other bytes
/// than before, and errors of files. A value at which the machine fails is no error: its row has the reason.
pub fn run_diagrams(
    plan: &Plan,
    output: &Output,
    options: &Options,
    progress: &mut dyn Progress,
) -> Result<(), Error> {
    let mut pending: Vec<&Diagram> = Vec::new();
    for diagram in &plan.diagrams {
        let found = DiagramCommit::find(output, plan, &diagram.name, Check::Resume)?;
        if found.made().is_none() {
            pending.push(diagram);
        }
    }
    if pending.is_empty() {
        return Ok(());
    }
    compute(plan, output, &pending, options, progress)
}

/// Computes the diagrams `pending` of `plan`.
pub(super) fn compute(
    plan: &Plan,
    output: &Output,
    pending: &[&Diagram],
    options: &Options,
    progress: &mut dyn Progress,
) -> Result<(), Error> {
    let cancelled = || options.cancel.load(Ordering::Relaxed);
    let stopped = |done: usize| Error::DiagramsCancelled {
        done,
        diagrams: plan.diagrams.len(),
    };
    let mut done = plan.diagrams.len() - pending.len();
    let values = plan.estimate_diagrams().values;
    let chunks: Vec<(&Diagram, Chunk)> = pending
        .iter()
        .flat_map(|diagram| diagram.chunks().into_iter().map(move |c| (*diagram, c)))
        .collect();
    let unfinished: u64 = chunks.iter().map(|(_, chunk)| chunk.len() as u64).sum();
    progress.diagrams_begin(values, values - unfinished);
    let (id, count) = (&plan.id[..12], pending.len());
    output.say(format_args!(
        "plan {id}: {unfinished} values of {count} bifurcation diagrams"
    ));
    let table = DiagramTable::new(plan)?;
    let mut rows = Vec::new();
    in_order(
        &pool(options.threads)?,
        2 * options.threads.max(1),
        chunks.into_iter().take_while(|_| !cancelled()),
        |(diagram, chunk)| table.rows(plan, diagram, chunk, &cancelled),
        |(diagram, chunk), walked| {
            if cancelled() {
                return Err(stopped(done));
            }
            progress.values_done(chunk.len() as u64);
            rows.extend(walked);
            if rows.len() == diagram.count() * diagram.directions.len() {
                table.write(plan, output, diagram, std::mem::take(&mut rows))?;
                output.say(format_args!("bifurcation diagram {} made", diagram.name));
                done += 1;
            }
            Ok(())
        },
    )?;
    if done < plan.diagrams.len() {
        return Err(stopped(done));
    }
    Ok(())
}

/// Runs a few revolutions of `diagram` to estimate the time, and returns their number.
///
/// # Errors
/// Where the machine in its middle fails.
pub(crate) fn sample_diagram(plan: &Plan, diagram: &Diagram) -> Result<u32, Failure> {
    let machine = plan.diagram_machine(diagram, diagram.count() / 2)?;
    let settings = simulate::SectionSettings {
        angle: diagram.angle,
        transient: diagram.settings.transient.min(20),
        revolutions: diagram.settings.revolutions.min(20),
        tolerance: plan.settings.tolerance,
    };
    simulate::sections(&machine, &settings)?;
    Ok(settings.transient + settings.revolutions)
}

/// The table of all diagrams of a dataset: they have the same columns, so that they can be read as
/// one.
pub(super) struct DiagramTable {
    /// Its columns.
    pub schema: Schema,
    /// Joints that are clear in any diagram.
    joints: Vec<Joint>,
}

impl DiagramTable {
    /// The table of the diagrams of `plan`.
    pub(super) fn new(plan: &Plan) -> Result<Self, recordings::Error> {
        let mut joints: Vec<Joint> = Vec::new();
        for joint in plan.diagrams.iter().flat_map(|d| &d.joints) {
            if !joints.contains(joint) {
                joints.push(*joint);
            }
        }
        joints.sort_by_key(|joint| match *joint {
            Joint::Main => (0, 0),
            Joint::BigEnd(throw) => (throw, 1),
            Joint::SmallEnd(throw) => (throw, 2),
            Joint::Guide(throw) => (throw, 3),
        });
        Ok(Self {
            schema: Schema::new(columns(plan, &joints))?.with_metadata(plan.metadata()),
            joints,
        })
    }

    /// The rows of a chunk, up to a cancellation.
    fn rows(
        &self,
        plan: &Plan,
        diagram: &Diagram,
        chunk: &Chunk,
        cancelled: &dyn Fn() -> bool,
    ) -> Vec<Vec<Value>> {
        let machines = Machines {
            machine: |value| Ok::<_, Failure>(plan.diagram_machine(diagram, value)?),
            angle: diagram.angle,
            tolerance: plan.settings.tolerance,
        };
        let direction = chunk.direction().name();
        Walk::new(&machines, chunk.clone(), diagram.settings)
            .take_while(|_| !cancelled())
            .map(|(value, revolutions)| {
                let mut row: Vec<Value> = vec![
                    diagram.name.as_str().into(),
                    diagram.path.as_str().into(),
                    diagram.unit.as_deref().map(str::to_owned).into(),
                    direction.into(),
                    diagram.value(value).into(),
                    revolutions.as_ref().err().map(ToString::to_string).into(),
                ];
                row.extend(self.lists(plan, diagram, revolutions.ok().as_deref()));
                row
            })
            .collect()
    }

    /// The lists of a row, one entry per revolution each.
    fn lists(
        &self,
        plan: &Plan,
        diagram: &Diagram,
        revolutions: Option<&[Revolution]>,
    ) -> Vec<Value> {
        let list = |value: &dyn Fn(&Revolution) -> f64| {
            let values = |of: &[Revolution]| of.iter().map(|r| value(r) as f32).collect();
            let list: Option<Vec<f32>> = revolutions.map(values);
            Value::from(list)
        };
        let mut lists = Vec::new();
        for joint in &self.joints {
            let position = diagram.joints.iter().position(|clear| clear == joint);
            for axis in 0..2 {
                lists.push(match position {
                    Some(i) => list(&|revolution| revolution.joints[i].offset[axis]),
                    None => Value::Missing,
                });
            }
        }
        for throw in 0..plan.throws().len() {
            for (_, _, value) in THROW {
                lists.push(list(&|revolution| value(&revolution.throws[throw])));
            }
        }
        lists
    }

    fn write(
        &self,
        plan: &Plan,
        output: &Output,
        diagram: &Diagram,
        rows: Vec<Vec<Value>>,
    ) -> Result<(), Error> {
        let name = &diagram.name;
        let before = DiagramCommit::find(output, plan, name, Check::Sums)?;
        let path = format!("{DIAGRAMS}/{name}.parquet");
        let file = output.store.create(&path)?;
        let mut table = TableWriter::new(file, &self.schema, ROWS_PER_GROUP)?;
        for row in rows {
            table.write(row)?;
        }
        let rows = table.rows();
        let record = table.finish()?.commit()?;
        let commit = DiagramCommit {
            plan_id: plan.id.clone(),
            file: FileEntry {
                path,
                bytes: record.bytes,
                sha256: record.sha256,
                rows: Some(rows),
            },
        };
        match before {
            Found::Damaged => commit.replace(output, name),
            Found::Nothing | Found::Made(_) => commit.create(output, plan, name),
        }
    }
}

/// Name, unit and value of a column of a throw.
type ThrowColumn = (&'static str, &'static str, fn(&ThrowPoint) -> f64);

const THROW: [ThrowColumn; 3] = [
    ("crosshead_velocity_m_s", "m/s", |throw| throw.velocity),
    ("crosshead_acceleration_m_s2", "m/s^2", |throw| {
        throw.acceleration
    }),
    ("peak_acceleration_m_s2", "m/s^2", |throw| {
        throw.peak_acceleration
    }),
];

fn columns(plan: &Plan, joints: &[Joint]) -> Vec<Column> {
    let text =
        |name: &str, meaning: &str| Column::new(name, Kind::Text, meaning).role(Role::Identifier);
    let value = "the value; SI, or rpm for a speed";
    let mut columns = vec![
        text("bifurcation", "name of the diagram"),
        text("path", "what changes: a path of the machine file"),
        text("unit", "unit of the value, where it has one").optional(),
        text(
            "direction",
            "up or down: which way the motion came to this value",
        ),
        Column::new("value", Kind::Real, value).role(Role::Condition),
        text("reason", "why the machine failed at this value").optional(),
    ];
    let mut list = |throw: &str, name: &str, unit: &str, meaning: &str| {
        let name = prefixed(throw, name);
        let meaning = format!("{meaning}, once a revolution");
        let column = Column::new(name, Kind::Samples, meaning);
        columns.push(column.unit(unit).role(Role::Signal).optional());
    };
    let throws = plan.throws();
    for joint in joints {
        let (throw, name) = match *joint {
            Joint::Main => ("", "main"),
            Joint::BigEnd(i) => (throws[i].as_str(), "big_end"),
            Joint::SmallEnd(i) => (throws[i].as_str(), "small_end"),
            Joint::Guide(i) => (throws[i].as_str(), "guide"),
        };
        if name == "guide" {
            list(throw, "guide_y_m", "m", "shift of the crosshead");
            list(throw, "guide_tilt_rad", "rad", "tilt of the crosshead");
        } else {
            for axis in ["x", "y"] {
                let meaning = format!("offset of the journal along {axis}");
                list(throw, &format!("{name}_{axis}_m"), "m", &meaning);
            }
        }
    }
    for throw in throws {
        let meanings = [
            "speed of the crosshead",
            "acceleration of the crosshead",
            "largest magnitude of the crosshead's acceleration",
        ];
        for ((name, unit, _), meaning) in THROW.into_iter().zip(meanings) {
            list(throw, name, unit, meaning);
        }
    }
    columns
}
