//! How well the classes of a dataset can be told apart.

use crate::{Boosting, Sample};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// What gradient boosting reaches: one model for each class against all others, the most likely one is the answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Baseline {
    /// Rows that it is trained on.
    pub trained_on: usize,
    /// Rows that it is tested on.
    pub tested_on: usize,
    /// Share of the tested rows whose class is right.
    pub accuracy: f64,
    /// The mean of the classes' shares: what counts where classes are not equally frequent.
    pub balanced_accuracy: f64,
    /// Each class that is tested, by name.
    pub classes: Vec<ClassScore>,
}

/// A class.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClassScore {
    /// Its name.
    pub class: String,
    /// Its tested rows.
    pub rows: usize,
    /// Share of these that are given to it.
    pub recall: f64,
    /// How many of them are given to each class, itself included; classes that none is given to are absent.
    pub answers: BTreeMap<String, usize>,
}

impl ClassScore {
    /// The other class that most are given to, the first of equal ones.
    pub fn confused_with(&self) -> Option<&str> {
        let others = self
            .answers
            .iter()
            .filter(|(class, _)| **class != self.class);
        let most = others.rev().max_by_key(|(_, count)| **count);
        most.map(|(class, _)| class.as_str())
    }
}

/// Trains on one sample and tests on another. `None` where fewer than two classes are trained, or nothing is tested.
pub fn baseline(train: (&Sample, &[String]), test: (&Sample, &[String])) -> Option<Baseline> {
    let known: Vec<&String> = train
        .1
        .iter()
        .collect::<BTreeSet<_>>()
        .into_iter()
        .collect();
    if known.len() < 2 || test.1.is_empty() {
        return None;
    }
    let scores: Vec<Vec<f64>> = known
        .par_iter()
        .map(|class| {
            let of_class: Vec<bool> = train.1.iter().map(|of| of == *class).collect();
            Boosting::fit(&train.0.values, &of_class).scores(&test.0.values)
        })
        .collect();
    // The first of equal ones.
    let answer = |row: usize| {
        let classes = (0..known.len()).rev();
        let best = classes.max_by(|a, b| scores[*a][row].total_cmp(&scores[*b][row]));
        best.map(|class| known[class])
    };
    let answers: Vec<&String> = (0..test.1.len()).filter_map(answer).collect();
    let tested: BTreeSet<&String> = test.1.iter().collect();
    let classes: Vec<ClassScore> = tested
        .into_iter()
        .map(|class| score(class, test.1, &answers))
        .collect();
    let right = test
        .1
        .iter()
        .zip(&answers)
        .filter(|(truth, answer)| truth == *answer)
        .count();
    Some(Baseline {
        trained_on: train.1.len(),
        tested_on: test.1.len(),
        accuracy: right as f64 / test.1.len() as f64,
        balanced_accuracy: classes.iter().map(|class| class.recall).sum::<f64>()
            / classes.len() as f64,
        classes,
    })
}

fn score(class: &String, truth: &[String], answers: &[&String]) -> ClassScore {
    let given = truth.iter().zip(answers).filter(|(of, _)| *of == class);
    let mut counts = BTreeMap::new();
    for (_, answer) in given {
        *counts.entry((*answer).clone()).or_default() += 1;
    }
    let rows = counts.values().sum();
    let right = counts.get(class).copied().unwrap_or(0);
    ClassScore {
        class: class.clone(),
        rows,
        recall: right as f64 / rows as f64,
        answers: counts,
    }
}
