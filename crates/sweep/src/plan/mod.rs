//! The plan of a sweep: gives the case at any index. Nothing is expanded, so a sweep of 10^9 cases
//! takes no more memory than one of ten.

mod axis;
mod block;
mod case;
mod census;
mod checks;
mod diagram;
mod drawn;
mod estimate;
mod labelled_effects;
mod levels;
mod listed;
mod machines;
mod name;
mod over_angle;
mod parameter;
mod sampler;
mod settings;
mod survey;
mod swept_parameters;
mod together;
mod varied;

pub use case::{Case, Judgement, OperatingPoint};
pub use census::Census;
pub use diagram::Diagram;
pub use estimate::{DiagramEstimate, Estimate};
pub use over_angle::OverAngle;
pub use parameter::Parameter;

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use input::choice::Or;
use input::yaml::Document;
use input::{Error, MachineFile, Resolved, paths};
use mechanism::Machine;
use rand::Rng;
use scalar::random::{Purpose, stream};
use serde_json::Value;
use sha2::{Digest, Sha256};
use simulate::{Settings, Unrecordable};

use crate::design::hash::unit;
use crate::effects::{VariedEffect, completed, vanish};
use crate::labels::{Joint, joints, labels};
use crate::split;
use crate::sweep_file::{self, Format, Licence, MOST_CASES_A_SHARD, Study, SweepFile, Windows};
use axis::Frame;
use block::Block;
use census::Survey;
use machines::Machines;
use settings::{check_windows, judgement, settings, shares};
use together::Together;
use varied::Varied;

/// Most cases that one sweep may run.
pub const MOST_CASES: u64 = 100_000_000;

/// Changes when the same plan would give other bytes.
const WRITER: &str = concat!("crosshead ", env!("CARGO_PKG_VERSION"), ", layout 4");

/// The plan of a sweep.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Name of the dataset.
    pub name: String,
    /// The published study that the cases repeat.
    pub study: Option<Study>,
    /// The licence of the dataset, where one is chosen.
    pub licence: Option<recordings::Licence>,
    /// SHA-256 of everything that the dataset's bytes depend on, in hexadecimal.
    pub id: String,
    /// The seed of all random numbers.
    pub seed: u64,
    /// How each case is run.
    pub settings: Settings,
    /// How the signals are resampled over the crank angle; absent where they are as recorded.
    pub over_angle: Option<OverAngle>,
    /// How the motion of each case is judged from the equations; absent if it is not.
    pub judgement: Option<Judgement>,
    /// Whether the regime is computed from the recorded signals.
    pub chaos: bool,
    /// How recordings are cut.
    pub windows: Option<Windows>,
    /// Shares of train, validation and test.
    pub shares: [f64; 3],
    /// Format of the recordings.
    pub format: Format,
    /// Cases in one shard.
    pub shard_size: u64,
    /// The joints of the machine, in the order of the labels.
    pub joints: Vec<Joint>,
    /// The effects that the sweep varies, each of them a label.
    pub effects: Vec<VariedEffect>,
    /// Parameters that the sweep sets or varies, other than clearances, speed and pressures.
    pub parameters: Vec<Parameter>,
    /// The bifurcation diagrams.
    pub diagrams: Vec<Diagram>,
    /// The machine and its sensors as the file has them, before any case changes them.
    pub base: Resolved,
    /// The folder of the calibration that the machine comes from, if it is calibrated.
    pub calibrated: Option<PathBuf>,
    throws: Vec<String>,
    tree: Value,
    blocks: Vec<Block>,
    vary: Vec<Varied>,
    together: Vec<Together>,
    repeats: u64,
    sweep: Value,
    survey: OnceLock<Survey>,
}

impl Plan {
    /// Reads the sweep file at `path`, and the machine file that it names.
    ///
    /// # Errors
    /// All mistakes in both files, with their lines; also a sweep without cases or with more than 2^64.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let folder = path.parent().unwrap_or(Path::new(""));
        Self::new(&Document::open(path)?, folder)
    }

    /// The plan of a sweep file whose content is `document` and that stands in `folder`.
    ///
    /// # Errors
    /// As [`Plan::read`].
    pub fn new(document: &Document, folder: &Path) -> Result<Self, Error> {
        let mut machines = Machines::new(folder, &document.tree["machine"]);
        document.collect(sweep_file::schema, |tree| {
            let plan = Self::of_tree(tree, &mut machines);
            match (plan, machines.mistakes()) {
                (plan, None) => plan,
                (Ok(_), Some(of_machine)) => Err(of_machine),
                (Err(error), Some(of_machine)) => Err(error.and(of_machine)),
            }
        })
    }

    /// The plan of a sweep file with this content; keys of errors are those of the file.
    fn of_tree(tree: &Value, machines: &mut Machines) -> Result<Self, Error> {
        let file: SweepFile = Document::from_tree(tree.clone()).read()?;
        input::sided::check(tree)?;
        name::check_dataset(&file.name)?;
        if file.calibrate.is_some() {
            let expected = "a machine that is calibrated, as in the sweep.yaml of the dataset";
            return Err(Error::unexpected(
                "calibrate",
                "a calibration to be made",
                expected,
            ));
        }
        let (machine, resolved) = match &file.machine {
            None => return Err(Error::missing("machine")),
            Some(Or::Scalar(path)) => machines.at(path)?,
            Some(Or::Section(_)) => MachineFile::from_tree(&tree["machine"])
                .and_then(|machine| Ok((machine.clone(), machine.resolve()?)))
                .map_err(|e| e.under("machine"))?,
        };
        let mut plan = Self::build(&file, machine.to_tree(), resolved, tree)?;
        plan.calibrated = file
            .calibrated
            .as_ref()
            .map(|path| machines.folder.join(path));
        plan.try_cases()?;
        Ok(plan)
    }

    /// The same sweep with its recordings in another format.
    ///
    /// # Errors
    /// A format with times, where the signals are over the crank angle.
    pub fn with_format(mut self, format: Format) -> Result<Self, Error> {
        if self.over_angle.is_some() {
            OverAngle::check(format)?;
        }
        self.format = format;
        self.sweep["format"] = format.name().into();
        self.id = id(&self.sweep);
        Ok(self)
    }

    /// The same sweep of the machine with those sensors alone that give some of the channels of these names.
    ///
    /// # Errors
    /// A channel that no sensor gives.
    pub fn with_channels(self, channels: &[String]) -> Result<Self, Error> {
        let mut tree = self.sweep;
        let machine = MachineFile::from_tree(&tree["machine"])?.with_channels(channels)?;
        tree["machine"] = machine.to_tree().clone();
        let mut plan = Self::new(&Document::from_tree(tree), Path::new(""))?;
        plan.calibrated = self.calibrated;
        Ok(plan)
    }

    /// The same sweep in `shards` shards of equal size, or a few less where the cases do not divide
    /// evenly.
    ///
    /// # Errors
    /// [`crate::Error::LargeShards`] if a shard would have more than [`MOST_CASES_A_SHARD`] cases.
    pub fn with_shards(mut self, shards: u64) -> Result<Self, crate::Error> {
        let cases = self.cases();
        let size = cases.div_ceil(shards.max(1)).max(1);
        let most = MOST_CASES_A_SHARD.into();
        if size > most {
            return Err(crate::Error::LargeShards {
                cases,
                shards,
                size,
                most,
            });
        }
        self.shard_size = size;
        self.sweep["shard_size"] = size.into();
        self.id = id(&self.sweep);
        Ok(self)
    }

    fn build(
        file: &SweepFile,
        tree: &Value,
        base: Resolved,
        document: &Value,
    ) -> Result<Self, Error> {
        let tree = &completed(tree, file.paths());
        let sweep = resolved_sweep(document, tree);
        let mut plan = Self {
            name: file.name.clone(),
            study: file.study,
            licence: file.licence.map(Licence::identifiers),
            id: id(&sweep),
            seed: file.seed.map_or(0, |n| n.get()).into(),
            settings: settings(&file.run, base.sample_rate)?,
            over_angle: OverAngle::new(file, &base)?,
            judgement: judgement(&file.run)?,
            chaos: file.run.chaos.unwrap_or(true),
            windows: file.windows,
            shares: shares(file)?,
            format: file.format,
            shard_size: file.shard_size.map_or(256, |n| n.get()).into(),
            joints: joints(&base.machine),
            effects: Vec::new(),
            parameters: Vec::new(),
            diagrams: Vec::new(),
            throws: base.machine.throws.iter().map(|t| t.name.clone()).collect(),
            base,
            calibrated: None,
            tree: tree.clone(),
            blocks: Vec::new(),
            vary: Vec::new(),
            together: Vec::new(),
            repeats: file.repeats.map_or(1, |n| n.get()).into(),
            sweep,
            survey: OnceLock::new(),
        };
        check_windows(file)?;
        let recordable = plan.settings.check(plan.base.speed);
        recordable.map_err(|Unrecordable { rate, expected }| {
            Error::unexpected("run.sample_rate", format_args!("{rate} Hz"), expected)
        })?;
        plan.settings_at(plan.base.speed)?;
        for (position, block) in file.cases.iter().enumerate() {
            let block = Block::new(block, position, plan.seed, &plan.frame())?;
            plan.blocks.push(block);
        }
        for (path, draw) in &file.vary.0 {
            let varied = Varied::new(path, draw, &plan.tree);
            plan.vary.push(varied.map_err(|e| e.under("vary"))?);
        }
        for (position, entry) in file.vary_together.iter().enumerate() {
            let key = format!("vary_together.{position}");
            let together = Together::new(entry, &plan.tree).map_err(|e| e.under(&key))?;
            let varies = |path: &&str| plan.varied().any(|(_, other)| other == *path);
            if let Some(path) = together.paths().find(varies) {
                let key = format!("{key}.parameters.{path}");
                return Err(Error::unexpected(
                    key,
                    "an unknown that varies already",
                    "it once",
                ));
            }
            plan.together.push(together);
        }
        for (position, file) in file.bifurcations.iter().enumerate() {
            // Its values go together: one that was guessed makes no mistake of another.
            let whole = format!("/bifurcations.{position}.*.*.*.*.*.*");
            let diagram = Diagram::new(file, position, &plan.frame());
            let diagram = diagram.map_err(|e| e.against(whole))?;
            if plan.diagrams.iter().any(|other| other.name == diagram.name) {
                let key = format!("bifurcations.{position}.name");
                let expected = "another name than the diagrams before";
                return Err(Error::unexpected(key, diagram.name, expected));
            }
            plan.diagrams.push(diagram);
        }
        let cases = plan
            .blocks
            .iter()
            .try_fold(0_u64, |n, b| n.checked_add(b.count()));
        match cases.and_then(|n| n.checked_mul(plan.repeats)) {
            Some(0) => {
                let none = Error::unexpected("cases", "no case at all", "at least one");
                Err(none.against("/cases.*.*.*.*.*.*.*.*"))
            }
            None => Err(Error::unexpected("cases", "more than 2^64 cases", "fewer")),
            Some(_) => {
                plan.effects = plan.find_effects();
                plan.parameters = plan.find_parameters();
                Ok(plan)
            }
        }
    }

    /// What varies: its key in the sweep file, and each path that it sets.
    fn varied(&self) -> impl Iterator<Item = (String, &str)> {
        let alone = self.vary.iter().flat_map(|varied| {
            let key = format!("vary.{}", varied.written);
            let places = varied.places.iter();
            places.map(move |place| (key.clone(), place.as_str()))
        });
        let together = self.together.iter().enumerate().flat_map(|(i, together)| {
            let paths = together.paths();
            paths.map(move |path| (format!("vary_together.{i}.parameters.{path}"), path))
        });
        alone.chain(together)
    }

    fn frame(&self) -> Frame<'_> {
        Frame {
            machine: &self.tree,
            joints: &self.joints,
            throws: &self.throws,
        }
    }

    /// Number of cases, repeats included.
    pub fn cases(&self) -> u64 {
        self.blocks.iter().map(Block::count).sum::<u64>() * self.repeats
    }

    /// Number of shards.
    pub fn shards(&self) -> u64 {
        self.cases().div_ceil(self.shard_size)
    }

    /// The cases of shard `shard`.
    pub fn shard(&self, shard: u64) -> std::ops::Range<u64> {
        let start = shard * self.shard_size;
        start..(start + self.shard_size).min(self.cases())
    }

    /// Names of the throws, where there are several; one empty name otherwise.
    pub fn throws(&self) -> &[String] {
        &self.throws
    }

    /// Name and unit of every channel of a recording, in order.
    pub fn channels(&self) -> Vec<(String, &'static str)> {
        channels(&self.base, &self.throws)
    }

    /// Samples of one channel and window at the machine file's speed.
    pub fn samples_per_window(&self) -> f64 {
        let windows = self.windows.map(|w| w.revolutions.get());
        let revolutions = f64::from(windows.unwrap_or(self.settings.revolutions));
        revolutions * self.samples_per_revolution(self.base.speed)
    }

    /// Samples of one channel in a revolution at this speed, rad/s.
    pub fn samples_per_revolution(&self, speed: f64) -> f64 {
        match self.over_angle {
            Some(over_angle) => over_angle.samples_per_revolution.into(),
            None => TAU / speed * self.settings.sample_rate,
        }
    }

    /// How a case of this speed, rad/s, is run.
    fn settings_at(&self, speed: f64) -> Result<Settings, Error> {
        match self.over_angle {
            Some(over_angle) => over_angle.settings(&self.settings, speed),
            None => Ok(self.settings),
        }
    }

    /// What holds for every table of the dataset: its plan, and its licence where one is chosen.
    pub(crate) fn metadata(&self) -> BTreeMap<String, String> {
        let licence = self.licence.map(|licence| ("license", licence.spdx));
        let own = licence.into_iter().chain([("plan_id", self.id.as_str())]);
        own.map(|(key, value)| (key.to_owned(), value.to_owned()))
            .collect()
    }

    /// The sweep with everything in it that it depends on, the machine included: reading it gives
    /// the same plan.
    pub fn sweep(&self) -> &Value {
        &self.sweep
    }

    /// The name of case `index`.
    pub fn case_id(&self, index: u64) -> String {
        let digits = (self.cases() - 1).to_string().len().max(6);
        format!("case-{index:0digits$}")
    }

    /// The index of the case of this name.
    pub fn case_index(&self, id: &str) -> Option<u64> {
        let index = id.rsplit('-').next()?.parse().ok()?;
        (index < self.cases() && self.case_id(index) == id).then_some(index)
    }

    /// Case `index`, computed from its index alone but for its split, in about 0.1 ms (95 µs
    /// measured with the shipped `bearing-faults.yaml`, optimised). The split follows from the labels
    /// of all cases where those are few (see [`Census`]); the first call looks at them.
    ///
    /// # Errors
    /// An input error if the values of the case make an invalid machine. `index` must be below [`Plan::cases`].
    pub fn case(&self, index: u64) -> Result<Case, Error> {
        let case = self.case_before_splits(index)?;
        let split = self.split(case.group);
        Ok(Case { split, ..case })
    }

    /// Case `index` with the unstratified split of its group.
    fn case_before_splits(&self, index: u64) -> Result<Case, Error> {
        let (point, repeat) = (index / self.repeats, index % self.repeats);
        let (block, inside) = self.block_of(point);
        let mut tree = self.tree.clone();
        let mut variation = stream(self.seed, point, Purpose::Variation);
        for varied in &self.vary {
            let value = varied.sampler.draw(unit(variation.next_u64()));
            for place in &varied.places {
                paths::set(&mut tree, place, value.clone())?;
            }
        }
        // What is known of the machine with an uncertainty is its own in each case.
        let mut own = Cow::Borrowed(&self.tree);
        for together in &self.together {
            for (path, value) in together.draw(&mut variation) {
                paths::set(own.to_mut(), path, value.clone())?;
                paths::set(&mut tree, path, value)?;
            }
        }
        for (path, value) in self.blocks[block].assignments(inside, &self.frame()) {
            paths::set(&mut tree, &path, value)?;
        }
        let resolved = MachineFile::from_tree(&tree)?.resolve()?;
        vanish(&mut tree, &resolved.idle_effects);
        let group = case::group(&resolved, &self.settings);
        Ok(Case {
            index,
            id: self.case_id(index),
            repeat,
            settings: self.settings_at(resolved.speed)?,
            judgement: self.judgement,
            motion: None,
            windows: self.windows,
            labels: labels(&self.joints, &self.effects, &tree, &resolved, &own),
            operating_point: OperatingPoint::new(&resolved),
            group,
            split: split::assign(self.shares, self.seed, group),
            seed: self.seed,
            tree,
            resolved,
        })
    }

    /// The machine of `diagram` at its value number `value`.
    ///
    /// # Errors
    /// An input error if the value makes an invalid machine.
    pub fn diagram_machine(&self, diagram: &Diagram, value: usize) -> Result<Machine, Error> {
        diagram.machine(value, &self.frame())
    }

    /// The block that point `point` of the sweep is in, and its index there.
    fn block_of(&self, point: u64) -> (usize, u64) {
        let mut rest = point;
        for (position, block) in self.blocks.iter().enumerate() {
            if rest < block.count() {
                return (position, rest);
            }
            rest -= block.count();
        }
        (self.blocks.len() - 1, rest)
    }

    /// The values that blocks list for `path`.
    pub(super) fn listed<'a>(&'a self, path: &'a str) -> impl Iterator<Item = Value> + 'a {
        let frame = self.frame();
        let setting = self
            .blocks
            .iter()
            .filter(move |b| b.paths().iter().any(|(own, _)| *own == path));
        setting.flat_map(move |block| {
            let all = block.probes().into_iter();
            let all = all.flat_map(|case| block.assignments(case, &frame));
            let own = all.filter(|(other, _)| other == path);
            own.map(|(_, value)| value).collect::<Vec<_>>()
        })
    }
}

fn channels(machine: &Resolved, throws: &[String]) -> Vec<(String, &'static str)> {
    let throws: Vec<&str> = throws.iter().map(String::as_str).collect();
    let sensors = machine.sensors.iter().map(|sensor| &sensor.measured);
    sensors.map(|m| (m.column(&throws), m.unit())).collect()
}

/// The file's content with its machine in it, and with what it leaves out.
fn resolved_sweep(document: &Value, machine: &Value) -> Value {
    let mut sweep = document.clone();
    let splits = [("train", "70 %"), ("validation", "15 %"), ("test", "15 %")];
    let defaults = [
        ("seed", Value::from(0)),
        ("repeats", Value::from(1)),
        ("splits", Value::from_iter(splits)),
        ("format", Value::from("parquet")),
        ("shard_size", Value::from(256)),
    ];
    if let Some(section) = sweep.as_object_mut() {
        section.insert("machine".into(), machine.clone());
        for (key, default) in defaults {
            section.entry(key).or_insert(default);
        }
    }
    sweep
}

fn id(sweep: &Value) -> String {
    let mut digest = Sha256::new();
    digest.update(WRITER);
    digest.update(sweep.to_string());
    digest
        .finalize()
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect()
}
