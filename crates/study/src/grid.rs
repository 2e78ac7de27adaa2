//! Sweeps that compare joints and clearances, all else equal.

use crate::Error;
use crate::Level;
use crate::chaos::cases::is_chaotic;
use crate::examples::operating_point;
use crate::features::HIGH_FROM_HZ;
use crate::operating_points::Settings;
use crate::recording::Recording;
use crate::recording::Response;
use crate::words;
use std::collections::{BTreeMap, BTreeSet};
use sweep::reader::{Case, Dataset, Motions};

/// The grids of a sweep: one for each operating point and each sensor that judges its faults.
#[derive(Clone, Debug, Default)]
pub struct ClearanceGrids {
    /// The grids, in the order of the sweep.
    pub grids: Vec<ClearanceGrid>,
    /// How many more the sweep has.
    pub left_out: usize,
    /// Whether the sweep repeats the clearance study, so that its claims are held against the grids.
    pub claims: bool,
}

/// Responses by set of joints and clearance, as one sensor reads them.
#[derive(Clone, Debug, Default)]
pub struct ClearanceGrid {
    /// What is the same in all cases: «500 rpm, full load».
    pub operating_point: String,
    /// What sets this operating point apart from the others of the sweep: name and value.
    pub settings: Vec<(String, String)>,
    /// The sensor; empty where the dataset has one.
    pub sensor: String,
    /// The machine without clearance, if the sweep has it.
    pub ideal: Option<Response>,
    /// The sets of joints; none where the recordings are not at hand.
    pub joint_sets: Vec<JointSet>,
    /// Frequency above which the motion without clearance has hardly anything.
    pub high_from_hz: f64,
    /// The levels of all cases, the ideal machine first.
    pub levels: Vec<CaseLevel>,
}

/// How large and how violent the acceleration of one case is.
#[derive(Clone, Debug)]
pub struct CaseLevel {
    /// The joints with clearance as a label; `none` for the ideal machine.
    pub joints: String,
    /// Radial clearance in m; 0 for the ideal machine.
    pub clearance_m: f64,
    /// Root mean square, m/s².
    pub rms: Level,
    /// Largest absolute value, m/s².
    pub peak: Level,
    /// Root mean square of what lies above [`ClearanceGrid::high_from_hz`], m/s².
    pub high_rms: Level,
    /// Share of the variance that lies above it.
    pub high_share: f64,
    /// Whether the motion is chaotic by the equations; none where they were not asked.
    pub chaotic: Option<bool>,
}

/// The responses with clearance in the same joints.
#[derive(Clone, Debug)]
pub struct JointSet {
    /// The joints as a label: `big_end+small_end`.
    pub joints: String,
    /// Radial clearance in m, and the response with it.
    pub responses: Vec<(f64, Response)>,
}

/// At most this many grids have figures: more would not fit on a page that a browser opens at once,
/// nor their recordings in little memory.
const MOST_DRAWN: usize = 8;
/// At most this many grids are on the page at all.
const MOST_GRIDS: usize = 64;

/// The cases of one place in a grid: clearance of one size in every faulty joint. There are several
/// where the sweep repeats them.
struct Point<'a> {
    fault: &'a str,
    clearance_m: f64,
    cases: Vec<&'a Case>,
}

/// A grid for each sensor and each operating point at which several sets of joints have the same
/// several clearances; none where there is no such point.
///
/// # Errors
/// A table that cannot be read.
pub fn grids(
    dataset: &Dataset,
    motions: Option<&Motions>,
) -> Result<Option<ClearanceGrids>, Error> {
    let operating_points = operating_points(dataset);
    let firsts = operating_points
        .iter()
        .map(|points| points[0].cases[0].first);
    let settings = Settings::new(dataset, &firsts.collect::<Vec<_>>());
    let sensors = dataset.sensors.channels().len();
    let all: Vec<(usize, usize)> = (0..operating_points.len())
        .flat_map(|at| (0..sensors.max(1)).map(move |sensor| (at, sensor)))
        .filter(|(at, sensor)| {
            let mut clear = operating_points[*at].iter().filter(|p| p.clearance_m > 0.0);
            clear.any(|point| sensors == 0 || judged(dataset, point, *sensor))
        })
        .collect();
    if all.is_empty() {
        return Ok(None);
    }
    let mut shown = Vec::new();
    for &(at, sensor) in all.iter().take(MOST_GRIDS) {
        let context = Context {
            dataset,
            sensor: (sensors > 0).then_some(sensor),
            draws: dataset.has_signals() && shown.len() < MOST_DRAWN,
            motions,
        };
        let mut grid = context.grid(&operating_points[at])?;
        grid.settings = settings.at(at);
        grid.operating_point = settings.described(&grid.operating_point, at);
        shown.push(grid);
    }
    Ok(Some(ClearanceGrids {
        left_out: all.len() - shown.len(),
        grids: shown,
        claims: dataset.plan.study.is_some(),
    }))
}

fn judged(dataset: &Dataset, point: &Point, sensor: usize) -> bool {
    dataset.sensors.of_fault(point.fault).contains(&sensor)
}

/// What a grid is made from.
struct Context<'a> {
    dataset: &'a Dataset,
    /// The sensor that it is seen by; none where the dataset has none.
    sensor: Option<usize>,
    /// Whether it has figures.
    draws: bool,
    motions: Option<&'a Motions>,
}

impl Context<'_> {
    fn grid(&self, points: &[Point]) -> Result<ClearanceGrid, Error> {
        let seen = |point: &&Point| {
            let sensor = self.sensor;
            sensor.is_none_or(|sensor| judged(self.dataset, point, sensor))
        };
        let ideal = points.iter().find(|point| point.clearance_m == 0.0);
        let clear = || points.iter().filter(|p| p.clearance_m > 0.0).filter(seen);
        let mut joint_sets: Vec<JointSet> = Vec::new();
        let drawn = self.sensor.filter(|_| self.draws);
        if let Some(sensor) = drawn {
            for point in clear() {
                let response = (point.clearance_m, self.response(point, sensor)?);
                match joint_sets.iter_mut().find(|set| set.joints == point.fault) {
                    Some(set) => set.responses.push(response),
                    None => joint_sets.push(JointSet {
                        joints: point.fault.to_owned(),
                        responses: vec![response],
                    }),
                }
            }
        }
        let levels = match self.sensor {
            Some(sensor) => {
                let ordered = ideal.into_iter().chain(clear());
                let levels = ordered.map(|point| self.level(point, sensor));
                levels.collect::<Result<_, _>>()?
            }
            None => Vec::new(),
        };
        Ok(ClearanceGrid {
            operating_point: operating_point(self.dataset, points[0].cases[0].first),
            settings: Vec::new(),
            sensor: self
                .sensor
                .map_or(String::new(), |sensor| words::sensor(self.dataset, sensor)),
            ideal: match (ideal, drawn) {
                (Some(point), Some(sensor)) => Some(self.response(point, sensor)?),
                _ => None,
            },
            joint_sets,
            high_from_hz: HIGH_FROM_HZ,
            levels,
        })
    }

    fn response(&self, point: &Point, sensor: usize) -> Result<Response, Error> {
        Recording::read(self.dataset, point.cases[0].first, sensor)?.response()
    }

    /// The levels of a point over all windows of all its cases. The spread is that over the windows,
    /// or over the revolutions where there is one window alone and its recording is at hand.
    fn level(&self, point: &Point, sensor: usize) -> Result<CaseLevel, Error> {
        let measured = &self.dataset.windows.measured[sensor];
        let own: Vec<usize> = point
            .cases
            .iter()
            .flat_map(|c| &c.windows)
            .copied()
            .collect();
        let of = |value: &dyn Fn(usize) -> f64| own.iter().map(|&w| value(w)).collect::<Vec<_>>();
        let high = of(&|w| measured.rms_from(HIGH_FROM_HZ, w).powi(2));
        let variance: f64 = of(&|w| measured.variance(w)).iter().sum();
        let mut level = CaseLevel {
            joints: point.fault.to_owned(),
            clearance_m: point.clearance_m,
            rms: Level::root_mean(&of(&|w| measured.rms[w].powi(2))),
            peak: Level::largest(&of(&|w| measured.peak[w])),
            high_rms: Level::root_mean(&high),
            high_share: high.iter().sum::<f64>() / variance,
            chaotic: self
                .motions
                .and_then(|m| is_chaotic(m, point.cases[0].first)),
        };
        if own.len() == 1 && self.dataset.has_signals() {
            let recording = Recording::read(self.dataset, own[0], sensor)?;
            let spread = recording.spread(HIGH_FROM_HZ)?;
            level.peak.spread = spread.peak;
            level.rms.spread = spread.rms;
            level.high_rms.spread = spread.high_rms;
        }
        Ok(level)
    }
}

/// The points of each operating point that makes a grid, in the order of the sweep.
fn operating_points(dataset: &Dataset) -> Vec<Vec<Point<'_>>> {
    let mut by_operating_point: Vec<Vec<Point>> = Vec::new();
    let mut index: BTreeMap<Vec<String>, usize> = BTreeMap::new();
    for case in &dataset.cases {
        let Some(clearance_m) = common_clearance(dataset, case.first) else {
            continue;
        };
        let key = dataset.windows.all_else(case.first);
        let at = *index.entry(key).or_insert_with(|| {
            by_operating_point.push(Vec::new());
            by_operating_point.len() - 1
        });
        let points = &mut by_operating_point[at];
        let fault = dataset.windows.fault[case.first].as_str();
        let same = |p: &&mut Point| p.fault == fault && p.clearance_m == clearance_m;
        match points.iter_mut().find(same) {
            Some(point) => point.cases.push(case),
            None => points.push(Point {
                fault,
                clearance_m,
                cases: vec![case],
            }),
        }
    }
    by_operating_point.retain(|points| is_grid(points));
    by_operating_point
}

/// Whether two sets of joints have two clearances in common.
fn is_grid(points: &[Point]) -> bool {
    let mut sets: BTreeMap<&str, BTreeSet<u64>> = BTreeMap::new();
    for point in points.iter().filter(|point| point.clearance_m > 0.0) {
        let clearances = sets.entry(point.fault).or_default();
        clearances.insert(point.clearance_m.to_bits());
    }
    let sets: Vec<_> = sets.into_values().collect();
    sets.iter().enumerate().any(|(i, a)| {
        let common = |b: &BTreeSet<u64>| a.intersection(b).count();
        sets[i + 1..].iter().any(|b| common(b) >= 2)
    })
}

/// The clearance that all faulty joints of the window's case have; 0 for a machine without any.
/// None where they differ, where a machine without fault has clearance, and where the case has an
/// effect as a fault.
fn common_clearance(dataset: &Dataset, window: usize) -> Option<f64> {
    let windows = &dataset.windows;
    let largest = windows.largest_clearance(window);
    let mut faulty = windows.faults(window).peekable();
    if faulty.peek().is_none() {
        return (largest == 0.0).then_some(0.0);
    }
    let clearance = |joint: &str| {
        let mut all = windows.clearances(window);
        all.find(|(name, _)| *name == joint).map(|(_, at)| at)
    };
    let alike = faulty.all(|joint| clearance(joint) == Some(largest));
    alike.then_some(largest)
}
