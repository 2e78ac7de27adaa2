//! A set fitted with one amendment more: in each form of its law by itself, roughly at first, then to the end.

use crate::amendment::Amendment;
use crate::error::{Error, possible};
use crate::fitter::{Few, Fitter, Start};
use crate::search::far_starts::FarStart;
use crate::search::hypothesis::{Amended, Hypothesis, added, start};
use crate::search::screen::{FORMS, Point, Screened};
use calibrate::Problem;
use rayon::prelude::*;

/// A set that was fitted roughly.
pub(crate) struct Trial {
    pub set: Vec<Amended>,
    pub start: Start,
    /// The coordinates of the node, before rough descents.
    node: Vec<f64>,
    /// Twice the negative logarithm of the likelihood there.
    pub deviance: f64,
}

impl Trial {
    /// A machine to which nothing is added.
    pub fn of_nothing(problem: &Problem) -> Self {
        let x = vec![0.0; problem.parameters.len()];
        Self {
            set: Vec::new(),
            start: (problem.clone(), x.clone()),
            node: x,
            deviance: f64::INFINITY,
        }
    }

    /// From where it is searched far away. What the node has was searched before; but where that is nothing, the values with which the
    /// machine fits belong to a wrong ringing, and those that were given count.
    pub fn far(&self) -> FarStart<'_> {
        let (problem, x) = &self.start;
        let alone = self.set.len() <= 1;
        let mut x = x.clone();
        for (x, node) in x.iter_mut().zip(&self.node) {
            *x = if alone { 0.0 } else { *node };
        }
        FarStart {
            problem,
            x,
            followed: if alone { 0 } else { self.node.len() },
        }
    }

    /// What was added beside what.
    pub fn words(&self) -> String {
        let labels: Vec<String> = self.set.iter().map(|one| one.amendment.label()).collect();
        match labels.split_last() {
            Some((last, [])) => last.clone(),
            Some((last, others)) => format!("{last} beside {}", others.join(" and ")),
            None => String::new(),
        }
    }
}

/// A node with one amendment more, fitted roughly to runs that are alike: each form of its law by itself, the best first. How far
/// a short descent comes does not say which form is right.
///
/// # Errors
/// [`Error::Stopped`].
pub(crate) fn trials(
    fitter: &Fitter,
    few: &Few,
    node: &Hypothesis,
    screened: &Screened,
) -> Result<Vec<Trial>, Error> {
    let amendment = &screened.amendment;
    let problem = added(&few.alike, &node.set)?;
    let mut points = screened.starts.clone();
    // A descent that can leave it out does no worse than the node.
    if let Some(first) = screened.starts.first() {
        points.push(Point {
            x: node.model.x.clone(),
            values: amendment.faint(&first.values),
        });
    }
    let forms = of_each_form(amendment, points).into_par_iter();
    let trials = forms.map(|points| trial(fitter, node, (amendment, &points), &problem));
    let trials = trials.collect::<Result<Vec<_>, Error>>()?;
    let mut trials: Vec<Trial> = trials.into_iter().flatten().collect();
    trials.sort_by(|a, b| a.deviance.total_cmp(&b.deviance));
    trials.truncate(FORMS);
    Ok(trials)
}

/// A node with one amendment more, fitted roughly to `problem`, which has the node's set, from these points of one form; none where no
/// machine there can be simulated.
fn trial(
    fitter: &Fitter,
    node: &Hypothesis,
    (amendment, points): (&Amendment, &[Point]),
    problem: &Problem,
) -> Result<Option<Trial>, Error> {
    let started = points
        .iter()
        .filter_map(|Point { x, values }| Some((start(problem, x, amendment, values)?, values)));
    let (starts, values): (Vec<Start>, Vec<&Vec<f64>>) = started.unzip();
    let Some(rough) = fitter.roughly(&starts)? else {
        return Ok(None);
    };
    let values = values[rough.start].clone();
    let Some(with) = possible(amendment.added(&node.model.problem, &values))? else {
        return Ok(None);
    };
    let mut set = node.set.clone();
    set.push(Amended {
        amendment: amendment.clone(),
        values,
    });
    Ok(Some(Trial {
        deviance: rough.deviance,
        set,
        start: (with, rough.x),
        node: node.model.x.clone(),
    }))
}

/// The points of each form of a law, in the order of their first ones.
fn of_each_form(amendment: &Amendment, points: Vec<Point>) -> Vec<Vec<Point>> {
    let mut forms: Vec<(Vec<f64>, Vec<Point>)> = Vec::new();
    for point in points {
        let form = amendment.form_at(&point.values);
        match forms.iter_mut().find(|(known, _)| *known == form) {
            Some((_, of_form)) => of_form.push(point),
            None => forms.push((form, vec![point])),
        }
    }
    forms.into_iter().map(|(_, points)| points).collect()
}

/// The likeliest of a set's forms, fitted from where rough descents have led; those after one that leaves no more than noise are not
/// fitted.
///
/// # Errors
/// [`Error::Stopped`].
pub(crate) fn settled(
    fitter: &Fitter,
    forms: &[Trial],
    own: usize,
) -> Result<Option<Hypothesis>, Error> {
    let mut best: Option<Hypothesis> = None;
    for Trial { set, start, .. } in forms {
        let model = fitter.settled(start)?;
        let model = model.map(|model| Hypothesis::new(set.clone(), model, own));
        best = likelier(best, model);
        if best.as_ref().is_some_and(is_at_noise) {
            break;
        }
    }
    Ok(best)
}

/// The one of two fits of a set that makes the recordings likelier.
pub(crate) fn likelier(one: Option<Hypothesis>, other: Option<Hypothesis>) -> Option<Hypothesis> {
    let both = one.into_iter().chain(other);
    both.min_by(|a, b| a.model.deviance.total_cmp(&b.model.deviance))
}

/// Whether a set leaves no more than noise.
pub(crate) fn is_at_noise(set: &Hypothesis) -> bool {
    Fitter::is_at_noise(&set.model)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{effort, fitter, problem, problem_of};
    use serde_json::json;

    /// A set of an amendment of this kind at its usual values, of which nothing is known.
    fn usual(problem: &Problem, kind: &str) -> Trial {
        let all = Amendment::all(problem).unwrap();
        let found = all.into_iter().find(|one| one.kind() == kind);
        let amendment = found.unwrap();
        let values = amendment.effect().unwrap().usual();
        let start = start(problem, &[0.0], &amendment, &values).unwrap();
        Trial {
            set: vec![Amended { amendment, values }],
            start,
            node: vec![0.0],
            deviance: f64::INFINITY,
        }
    }

    #[test]
    fn a_set_is_searched_from_the_given_machine_and_a_pair_from_where_its_node_was() {
        let mut trial = usual(&problem(), "sensor_gain");
        let (own, new) = trial.start.1.split_at_mut(1);
        (own[0], new[0]) = (0.4, 0.2);
        trial.node = vec![0.3];
        let from = trial.far();
        assert_eq!((&from.x[..2], from.followed), (&[0.0, 0.2][..], 0));
        trial.set.push(trial.set[0].clone());
        let from = trial.far();
        assert_eq!((&from.x[..2], from.followed), (&[0.3, 0.2][..], 1));
    }

    #[test]
    fn another_form_is_fitted_where_the_first_leaves_more_than_noise() {
        let hidden =
            json!([{"sensor_gain": {"measure": "crosshead_acceleration", "error": "40 %"}}]);
        let problem = problem_of(hidden);
        let fitted = |forms: &[&str]| {
            let effort = effort();
            let fitter = &fitter(&effort);
            let forms: Vec<Trial> = forms.iter().map(|kind| usual(&problem, kind)).collect();
            let best = settled(fitter, &forms, 1).unwrap().unwrap();
            (best.kinds().concat(), effort.journal.spent())
        };
        let (wrong, of_wrong) = fitted(&["extra_clearance"]);
        let (right, of_right) = fitted(&["sensor_gain"]);
        assert_eq!([&wrong[..], &right], ["extra_clearance", "sensor_gain"]);
        let both = fitted(&["extra_clearance", "sensor_gain"]);
        assert_eq!(both, (right.clone(), of_wrong + of_right));
        // Nothing more is fitted after one that leaves noise.
        let first = fitted(&["sensor_gain", "extra_clearance"]);
        assert_eq!(first, (right, of_right));
    }

    #[test]
    fn the_points_of_a_form_start_together() {
        let all = Amendment::all(&problem()).unwrap();
        let with_forms = |one: &&Amendment| {
            let effect = one.effect();
            effect.is_some_and(|it| !it.other_forms_of(&it.usual()).is_empty())
        };
        let amendment = all.iter().find(with_forms).unwrap();
        let effect = amendment.effect().unwrap();
        let usual = effect.usual();
        let other = effect.other_forms_of(&usual).swap_remove(0);
        let point = |x: f64, values: &Vec<f64>| Point {
            x: vec![x],
            values: values.clone(),
        };
        let points = vec![point(0.0, &other), point(1.0, &usual), point(2.0, &other)];
        let forms = of_each_form(amendment, points);
        let of_form = |points: &Vec<Point>| points.iter().map(|point| point.x[0]).collect();
        let forms: Vec<Vec<f64>> = forms.iter().map(of_form).collect();
        assert_eq!(forms, [vec![0.0, 2.0], vec![1.0]]);
    }
}
