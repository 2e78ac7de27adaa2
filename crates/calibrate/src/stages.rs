//! The stages of a calibration's search, and who watches them.

use crate::correction::{Corrected, Depth, correct};
use crate::error::Error;
use crate::fit::{Fit, FitSettings, Optimiser, calibrate};
use crate::optimiser::Progress;
use crate::task::Task;
use crate::transfer::{Transfer, transfer};
use std::ops::ControlFlow;

/// Local fits before the search proper, which a wrong zero of the crank angle would send far away. After each of
/// them, runs without a recorded zero are aligned anew.
pub(crate) const ALIGNMENTS: usize = 3;

/// A stage of a calibration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// The parameters are fitted.
    Fit,
    /// The model is wrong: values of the data sheet are fitted one by one.
    DataSheet,
    /// The relations between clearances are compared.
    Relations,
    /// Clearances are screened on a grid.
    Screen,
    /// Clearances are fitted.
    Clearances,
}

/// Follows a calibration, and may stop it.
pub trait Watcher {
    /// A stage begins, which takes at most so many evaluations of the model.
    fn begins(&mut self, stage: Stage, evaluations: u64);
    /// The best so far in this stage; a break stops the calibration.
    fn progress(&mut self, progress: &Progress) -> ControlFlow<()>;
    /// The stage has ended.
    fn ends(&mut self);
}

/// What has come of a task's search.
pub(crate) struct Searched {
    /// The fit.
    pub fit: Fit,
    /// What was looked for in the data sheet; none where no more than noise is left at once.
    pub corrected: Option<Corrected>,
    /// Evaluations of the model.
    pub evaluations: u64,
}

/// Searches the best fit until `watcher` stops it. Where that leaves more than noise, searches the value of the
/// data sheet that is wrong. By default this begins as soon as the first descent has ended, before the
/// search goes on: the evaluations of both are in the checkpoint.
///
/// # Errors
/// Where the machine cannot be simulated.
pub(crate) fn search(task: &mut Task, watcher: &mut dyn Watcher) -> Result<Searched, Error> {
    let mut spent = 0;
    if task.settings.optimiser == Optimiser::Default {
        let first = fitted(task, Optimiser::FirstDescent, watcher)?;
        let searched = looked_up(task, first, Depth::Descents, watcher)?;
        let ended = !searched.fit.complete;
        let corrected = searched.corrected.as_ref();
        if ended || corrected.is_some_and(|c| c.fit.is_some() || !c.corrections.is_empty()) {
            return Ok(searched);
        }
        spent = corrected.map_or(0, |corrected| corrected.evaluations);
    }
    let fit = fitted(task, task.settings.optimiser, watcher)?;
    let mut searched = looked_up(task, fit, Depth::Search, watcher)?;
    searched.evaluations += spent;
    Ok(searched)
}

/// Compares the relations between clearances for a fitted task; none where `watcher` stops it.
///
/// # Errors
/// Where the machine cannot be simulated.
pub(crate) fn relations(
    task: &Task,
    fit: &Fit,
    watcher: &mut dyn Watcher,
) -> Result<Option<Transfer>, Error> {
    watcher.begins(Stage::Relations, task.settings.evaluations);
    let transfer = transfer(&task.problem, fit, |progress| watcher.progress(progress));
    watcher.ends();
    transfer
}

fn fitted(task: &mut Task, optimiser: Optimiser, watcher: &mut dyn Watcher) -> Result<Fit, Error> {
    watcher.begins(Stage::Fit, task.settings.evaluations);
    let found = aligned(task, optimiser, watcher);
    watcher.ends();
    found
}

/// A fit with what comes of the data sheet where it does not explain the recordings.
fn looked_up(
    task: &Task,
    mut fit: Fit,
    depth: Depth,
    watcher: &mut dyn Watcher,
) -> Result<Searched, Error> {
    let mut evaluations = fit.evaluations;
    let mut corrected = None;
    if fit.complete && !fit.is_at_noise() {
        watcher.begins(Stage::DataSheet, task.settings.evaluations);
        let watch = |progress: &Progress| watcher.progress(progress);
        let found = correct(&task.problem, &fit, &task.settings, depth, watch);
        watcher.ends();
        let found = found?;
        evaluations += found.evaluations;
        fit.complete &= found.complete;
        corrected = Some(found);
    }
    Ok(Searched {
        fit,
        corrected,
        evaluations,
    })
}

fn aligned(task: &mut Task, optimiser: Optimiser, watcher: &mut dyn Watcher) -> Result<Fit, Error> {
    let mut settings = task.settings.clone();
    settings.optimiser = Optimiser::LevenbergMarquardt;
    let mut spent = 0;
    let rounds = match task.zeroed.contains(&false) {
        true => ALIGNMENTS,
        false => 0,
    };
    for _ in 0..rounds {
        let fit = fit(task, &settings, watcher, spent)?;
        spent = fit.evaluations;
        if !fit.complete {
            return Ok(fit);
        }
        let x = fit.coordinates();
        let moved = task.align(&x)?;
        settings.start = Some(x);
        if !moved {
            break;
        }
    }
    settings.optimiser = optimiser;
    fit(task, &settings, watcher, spent)
}

/// One fit, after `spent` evaluations.
fn fit(
    task: &Task,
    settings: &FitSettings,
    watcher: &mut dyn Watcher,
    spent: u64,
) -> Result<Fit, Error> {
    let watch = |progress: &Progress| {
        watcher.progress(&Progress {
            evaluations: spent + progress.evaluations,
            ..progress.clone()
        })
    };
    let mut fit = calibrate(&task.problem, settings, watch)?;
    fit.evaluations += spent;
    Ok(fit)
}
