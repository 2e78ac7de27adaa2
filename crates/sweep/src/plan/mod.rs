//! A sweep, made ready: what its case at an index is. Nothing is expanded, so a sweep of 10^9
//! cases takes no more memory than one of ten.

mod axis;
mod block;
mod case;
mod diagram;
mod drawn;
mod estimate;
mod levels;
mod listed;
mod sampler;
mod together;

pub use case::{Case, Judgement, OperatingPoint};
pub use diagram::Diagram;
pub use estimate::{DiagramEstimate, Estimate};

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use input::choice::Or;
use input::yaml::Document;
use input::{Error, MachineFile, Problem, Resolved, paths};
use mechanism::Machine;
use rand::Rng;
use scalar::random::{Purpose, stream};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use simulate::{ExponentSettings, Extent, Settings, Transient};

use crate::design::hash::unit;
use crate::labels::{Joint, joints, labels};
use crate::split;
use crate::sweep_file::{Amount, Format, MOST_CASES_A_SHARD, Run, Study, SweepFile, Windows};
use axis::Frame;
use block::Block;
use sampler::Sampler;
use together::Together;

/// Most cases that one sweep may run.
pub const MOST_CASES: u64 = 100_000_000;

/// Changes when the same plan would give other bytes.
const WRITER: &str = concat!("crosshead ", env!("CARGO_PKG_VERSION"), ", layout 1");

/// A sweep, made ready.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Name of the dataset.
    pub name: String,
    /// The published study that the cases repeat.
    pub study: Option<Study>,
    /// SHA-256 of everything that the dataset's bytes depend on, in hexadecimal.
    pub id: String,
    /// What all random numbers follow from.
    pub seed: u64,
    /// How each case is run.
    pub settings: Settings,
    /// How the motion of each case is judged from the equations, where that is asked for.
    pub judgement: Option<Judgement>,
    /// Whether the kind of motion is told from the recorded signals.
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
    /// What the sweep sets or varies beside clearances, speed and pressures.
    pub parameters: Vec<Parameter>,
    /// The bifurcation diagrams.
    pub diagrams: Vec<Diagram>,
    /// The machine and its sensors as the file has them, before any case changes them.
    pub base: Resolved,
    /// The folder of the calibration that the machine comes from, where there is one.
    pub calibrated: Option<PathBuf>,
    throws: Vec<String>,
    tree: Value,
    blocks: Vec<Block>,
    vary: Vec<(String, Sampler)>,
    together: Vec<Together>,
    repeats: u64,
    sweep: Value,
}

/// Something that a sweep sets or varies.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Path in the machine file.
    pub path: String,
    /// Name of its column: the path and the unit, `joints.big_end.contact.damping_n_s_m`.
    pub column: String,
    /// Unit, where it is a quantity.
    pub unit: Option<String>,
    /// Whether it is a number; text otherwise.
    pub is_number: bool,
}

impl Plan {
    /// Reads the sweep file at `path`, and the machine file that it names.
    ///
    /// # Errors
    /// The first mistake in either file, with its line; a sweep without cases.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let folder = path.parent().unwrap_or(Path::new(""));
        Self::new(&Document::open(path)?, folder)
    }

    /// The plan of a sweep file whose content is `document` and that stands in `folder`.
    ///
    /// # Errors
    /// As [`Plan::read`].
    pub fn new(document: &Document, folder: &Path) -> Result<Self, Error> {
        let file: SweepFile = document.read()?;
        if file.calibrate.is_some() {
            let expected = "a machine that is calibrated, as in the sweep.yaml of the dataset";
            return Err(document.locate(Error::found(
                "calibrate",
                "a calibration to be made",
                expected,
            )));
        }
        let machine = file
            .machine
            .as_ref()
            .ok_or_else(|| Error::missing("machine"));
        let (machine, resolved) = match machine.map_err(|e| document.locate(e))? {
            Or::Scalar(path) => {
                let machine = input::machine_file::read(&folder.join(path))?;
                let resolved = machine.resolve()?;
                (machine, resolved)
            }
            Or::Section(_) => MachineFile::from_tree(&document.tree["machine"])
                .and_then(|machine| Ok((machine.clone(), machine.resolve()?)))
                .map_err(|e| document.locate(e.under("machine")))?,
        };
        let plan = Self::build(&file, machine.to_tree(), resolved, &document.tree);
        let mut plan = plan.map_err(|error| document.locate(error))?;
        plan.calibrated = file.calibrated.as_ref().map(|path| folder.join(path));
        plan.try_cases(document)?;
        Ok(plan)
    }

    /// The same sweep with its recordings in another format.
    #[must_use]
    pub fn with_format(mut self, format: Format) -> Self {
        self.format = format;
        self.sweep["format"] = json!(format.name());
        self.id = id(&self.sweep);
        self
    }

    /// The same sweep in `shards` shards of equal size, or a few less where the cases do not divide
    /// evenly.
    ///
    /// # Errors
    /// Where the shards would be too large.
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
        self.sweep["shard_size"] = json!(size);
        self.id = id(&self.sweep);
        Ok(self)
    }

    fn build(
        file: &SweepFile,
        tree: &Value,
        base: Resolved,
        document: &Value,
    ) -> Result<Self, Error> {
        let sweep = resolved_sweep(document, tree);
        let mut plan = Self {
            name: file.name.clone(),
            study: file.study,
            id: id(&sweep),
            seed: file.seed.map_or(0, |n| n.get()).into(),
            settings: settings(&file.run)?,
            judgement: judgement(&file.run)?,
            chaos: file.run.chaos.unwrap_or(true),
            windows: file.windows,
            shares: shares(file)?,
            format: file.format,
            shard_size: file.shard_size.map_or(256, |n| n.get()).into(),
            joints: joints(&base.machine),
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
        };
        check_windows(file)?;
        for (position, block) in file.cases.iter().enumerate() {
            let block = Block::new(block, position, plan.seed, &plan.frame())?;
            plan.blocks.push(block);
        }
        for (path, draw) in &file.vary.0 {
            let given = paths::get(&plan.tree, path);
            let given = given.map_err(|e| Error::new(path, e.problem().clone()));
            let sampler = given.and_then(|g| Sampler::new(draw, g).map_err(|e| e.under(path)));
            let sampler = sampler.map_err(|e| e.under("vary"))?;
            plan.vary.push((path.clone(), sampler));
        }
        for (position, entry) in file.vary_together.iter().enumerate() {
            let key = format!("vary_together.{position}");
            let together = Together::new(entry, &plan.tree).map_err(|e| e.under(&key))?;
            let varies = |path: &&str| plan.varied().any(|(_, other)| other == *path);
            if let Some(path) = together.paths().find(varies) {
                let key = format!("{key}.parameters.{path}");
                return Err(Error::found(
                    key,
                    "an unknown that varies already",
                    "it once",
                ));
            }
            plan.together.push(together);
        }
        for (position, file) in file.bifurcations.iter().enumerate() {
            let diagram = Diagram::new(file, position, &plan.frame())?;
            if plan.diagrams.iter().any(|other| other.name == diagram.name) {
                let key = format!("bifurcations.{position}.name");
                let expected = "another name than the diagrams before";
                return Err(Error::found(key, diagram.name, expected));
            }
            plan.diagrams.push(diagram);
        }
        let cases = plan
            .blocks
            .iter()
            .try_fold(0_u64, |n, b| n.checked_add(b.count()));
        match cases.and_then(|n| n.checked_mul(plan.repeats)) {
            Some(0) => Err(Error::found("cases", "no case at all", "at least one")),
            None => Err(Error::found("cases", "more than 2^64 cases", "fewer")),
            Some(_) => {
                plan.parameters = plan.find_parameters();
                Ok(plan)
            }
        }
    }

    /// What varies: the section of the sweep file, and the path.
    fn varied(&self) -> impl Iterator<Item = (String, &str)> {
        let alone = self.vary.iter();
        let alone = alone.map(|(path, _)| (String::from("vary"), path.as_str()));
        let together = self.together.iter().enumerate().flat_map(|(i, together)| {
            let paths = together.paths();
            paths.map(move |path| (format!("vary_together.{i}.parameters"), path))
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
        revolutions * TAU / self.base.speed * self.settings.sample_rate
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

    /// Case `index`, computed from its index alone, in about 0.1 ms (95 µs measured with the
    /// shipped `bearing-faults.yaml`, optimised).
    ///
    /// # Errors
    /// Where the drawn values do not make a machine; `index` must be below [`Plan::cases`].
    pub fn case(&self, index: u64) -> Result<Case, Error> {
        let (point, repeat) = (index / self.repeats, index % self.repeats);
        let (block, inside) = self.block_of(point);
        let mut tree = self.tree.clone();
        let mut variation = stream(self.seed, point, Purpose::Variation);
        for (path, sampler) in &self.vary {
            let value = sampler.draw(unit(variation.next_u64()));
            paths::set(&mut tree, path, value)?;
        }
        for together in &self.together {
            for (path, value) in together.draw(&mut variation) {
                paths::set(&mut tree, path, value)?;
            }
        }
        for (path, value) in self.blocks[block].assignments(inside, &self.frame()) {
            paths::set(&mut tree, &path, value)?;
        }
        let resolved = MachineFile::from_tree(&tree)?.resolve()?;
        let group = case::group(&resolved, &self.settings);
        Ok(Case {
            index,
            id: self.case_id(index),
            repeat,
            settings: self.settings,
            judgement: self.judgement,
            motion: None,
            windows: self.windows,
            labels: labels(&self.joints, &resolved),
            operating_point: OperatingPoint::of(&resolved),
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
    /// Where the value makes no machine.
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

    /// Tries cases that between them have every value that the file names, so that a mistake is
    /// found before anything is run.
    fn try_cases(&self, document: &Document) -> Result<(), Error> {
        let mut start = 0;
        for (position, block) in self.blocks.iter().enumerate() {
            for inside in block.probes() {
                let case = self.case((start + inside) * self.repeats);
                if let Err(error) = case.and_then(|case| self.check_columns(&case)) {
                    let keys = block.keys(inside, &self.frame());
                    return Err(document.locate(self.blame(error, keys, position, inside)));
                }
            }
            start += block.count();
        }
        Ok(())
    }

    /// All rows of a table have the same columns, so all cases have the same joints and sensors.
    fn check_columns(&self, case: &Case) -> Result<(), Error> {
        if channels(&case.resolved, &self.throws) != self.channels() {
            let found = "sensors that measure something else";
            return Err(Error::found("sensors", found, "those of the machine file"));
        }
        if joints(&case.resolved.machine) != self.joints {
            let found = "throws with other names";
            return Err(Error::found("throws", found, "those of the machine file"));
        }
        Ok(())
    }

    /// `error` of a case, at the value of the sweep file that it comes from.
    fn blame(&self, error: Error, keys: Vec<(String, String)>, block: usize, case: u64) -> Error {
        let varied = self
            .varied()
            .map(|(key, path)| (format!("{key}.{path}"), path.to_owned()));
        let within = |path: &str, other: &str| {
            let rest = path.strip_prefix(other);
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        };
        let mut sources = keys.into_iter().chain(varied);
        match sources.find(|(_, path)| within(path, error.key()) || within(error.key(), path)) {
            Some((key, _)) => Error::new(key, error.problem().clone()),
            None => {
                let problem = format!("case {case} of this block: {error}");
                Error::new(format!("cases.{block}"), Problem::Other(problem))
            }
        }
    }

    /// The values that blocks list for `path`.
    fn listed<'a>(&'a self, path: &'a str) -> impl Iterator<Item = Value> + 'a {
        let frame = self.frame();
        let setting = self
            .blocks
            .iter()
            .filter(move |b| b.paths().contains(&path));
        setting.flat_map(move |block| {
            let all = block.probes().into_iter();
            let all = all.flat_map(|case| block.assignments(case, &frame));
            let own = all.filter(|(other, _)| other == path);
            own.map(|(_, value)| value).collect::<Vec<_>>()
        })
    }

    fn find_parameters(&self) -> Vec<Parameter> {
        let mut paths: Vec<&str> = self.varied().map(|(_, path)| path).collect();
        paths.extend(self.blocks.iter().flat_map(Block::paths));
        let mut seen = std::collections::BTreeSet::new();
        let has_column = |path: &str| {
            path == "speed"
                || path.ends_with("cylinder.suction")
                || path.ends_with("cylinder.discharge")
                || self.joints.iter().any(|j| j.clearance_path == path)
        };
        paths.retain(|path| !has_column(path) && seen.insert(*path));
        paths.into_iter().map(|path| self.parameter(path)).collect()
    }

    /// How `path` stands in the file and in the cases: a number only if no case has anything else
    /// there, such as a stiffness by a formula.
    fn parameter(&self, path: &str) -> Parameter {
        let value = |tree: &Value| paths::get(tree, path).ok().flatten().and_then(Amount::of);
        let first = || value(&self.case(0).ok()?.tree);
        let amount = value(&self.tree).or_else(first);
        let amount = amount.filter(|_| !self.listed(path).any(|v| Amount::of(&v).is_none()));
        let unit = amount.and_then(|a| a.dimension).map(|d| d.to_string());
        let suffix = unit.as_deref().map_or(String::new(), suffix);
        Parameter {
            path: path.to_owned(),
            column: format!("{path}{suffix}"),
            is_number: amount.is_some(),
            unit,
        }
    }
}

fn channels(machine: &Resolved, throws: &[String]) -> Vec<(String, &'static str)> {
    let throws: Vec<&str> = throws.iter().map(String::as_str).collect();
    let sensors = machine.sensors.iter().map(|sensor| &sensor.measured);
    sensors.map(|m| (m.column(&throws), m.unit())).collect()
}

/// `_n_s_m` of `N s/m`: the ending of a column's name.
fn suffix(unit: &str) -> String {
    let parts = unit.split([' ', '/']).filter(|part| *part != "%");
    let plain = |part: &str| part.replace(['^', '.'], "").to_lowercase();
    parts.map(|part| format!("_{}", plain(part))).collect()
}

/// The file's content with its machine in it, and with what it leaves out.
fn resolved_sweep(document: &Value, machine: &Value) -> Value {
    let mut sweep = document.clone();
    let defaults = [
        ("seed", json!(0)),
        ("repeats", json!(1)),
        (
            "splits",
            json!({"train": "70 %", "validation": "15 %", "test": "15 %"}),
        ),
        ("format", json!("parquet")),
        ("shard_size", json!(256)),
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

fn settings(run: &Run) -> Result<Settings, Error> {
    let default = Settings::default();
    let tolerance = run.tolerance.map_or(default.tolerance, |t| t.get());
    if !(1e-13..=1e-3).contains(&tolerance) {
        let found = format_args!("{tolerance:e}");
        return Err(Error::found(
            "run.tolerance",
            found,
            "1e-13 to 1e-3, e.g. 1e-9",
        ));
    }
    Ok(Settings {
        revolutions: run.revolutions.get(),
        transient: match &run.transient {
            None => default.transient,
            Some(Or::Scalar(revolutions)) => Transient::Revolutions(revolutions.get()),
            Some(Or::Section(settled)) => Transient::Settled {
                change: settled.until_settled.get(),
                at_most: settled.at_most.get(),
            },
        },
        sample_rate: run
            .sample_rate
            .map_or(default.sample_rate, |rate| rate.si()),
        tolerance,
        ..default
    })
}

fn judgement(run: &Run) -> Result<Option<Judgement>, Error> {
    let Some(asked) = run.lyapunov else {
        return Ok(None);
    };
    let default = ExponentSettings::default();
    Ok(Some(Judgement {
        settings: ExponentSettings {
            transient: asked.transient.map_or(default.transient, |n| n.get()),
            revolutions: asked.revolutions.get(),
            tolerance: settings(run)?.tolerance,
        },
        extent: if asked.spectrum {
            Extent::Spectrum
        } else {
            Extent::Largest
        },
        convergence: asked.convergence,
    }))
}

fn shares(file: &SweepFile) -> Result<[f64; 3], Error> {
    let shares = file.splits.shares();
    let total: f64 = shares.iter().sum();
    if (total - 1.0).abs() > 1e-9 {
        let found = format_args!("{} % together", (total * 1e9).round() / 1e7);
        return Err(Error::found("splits", found, "shares that add up to 100 %"));
    }
    Ok(shares)
}

fn check_windows(file: &SweepFile) -> Result<(), Error> {
    let Some(windows) = file.windows else {
        return Ok(());
    };
    let (count, each) = (windows.count.get(), windows.revolutions.get());
    let recorded = file.run.revolutions.get();
    if u64::from(count) * u64::from(each) <= recorded.into() {
        return Ok(());
    }
    let found = format_args!("{count} windows of {each} revolutions");
    let expected = format_args!("no more than run.revolutions, {recorded}");
    Err(Error::found("windows", found, expected))
}
