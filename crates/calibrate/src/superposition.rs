//! The lines of a machine as the sum of what each of its throws shows.
//!
//! Throws on a shaft in an ideal bearing do not act on each other where the crank turns as it was recorded. A channel of a throw
//! is that throw's alone, and the frame, which is linear and does not act back, shows the sum of their shares. So each
//! throw is simulated by itself, with its own steps, and one whose parameters have not changed is not simulated again.

use crate::error::Error;
use crate::observation::Observation;
use crate::prediction::{self, Accuracy, Prediction, Wanted, predictions, with_derivatives};
use crate::problem::Problem;
use crate::throw_alone::{ThrowAlone, throws_in_parts};
use signal::order_lines::OrderLines;
use std::collections::HashMap;
use std::ops::AddAssign;
use std::sync::{Arc, Mutex};

/// Predictions of throws that are kept.
const KEPT: usize = 4096;

/// Predictions of a problem, from those of its throws where it can be taken apart.
pub(crate) struct Superposition<'a> {
    problem: &'a Problem,
    /// None where the machine is simulated as a whole.
    throws: Vec<ThrowAlone>,
    known: Mutex<HashMap<Asked, Arc<Prediction>>>,
}

/// A prediction of a throw: which throw, which run, with derivatives or without, how accurate, and the bits of its coordinates.
type Asked = (usize, String, (bool, Accuracy), Vec<u64>);

/// The predictions of runs of several machines without derivatives. Those of machines that are simulated as a whole are simulated
/// side by side.
///
/// # Errors
/// As [`predictions`].
pub(crate) fn predictions_of_machines(
    wanted: &[(&Superposition, Wanted)],
    accuracy: Accuracy,
) -> Vec<Result<Prediction, Error>> {
    let is_whole = |machine: &Superposition| machine.throws.is_empty();
    let whole = wanted.iter().filter(|(machine, _)| is_whole(machine));
    let whole: Vec<_> = whole
        .map(|(machine, run)| (machine.problem, *run))
        .collect();
    let mut whole = prediction::predictions_of_machines(&whole, accuracy).into_iter();
    let of = |(machine, run): &(&Superposition, Wanted)| {
        let found = match is_whole(machine) {
            true => whole.next(),
            false => machine.predictions(&[*run], accuracy).pop(),
        };
        found.unwrap_or(Err(Error::Nothing("nothing was simulated")))
    };
    wanted.iter().map(of).collect()
}

impl<'a> Superposition<'a> {
    /// Of this problem.
    pub fn new(problem: &'a Problem) -> Self {
        // What is wrong with a machine is said where it is simulated.
        let throws = throws_in_parts(problem).unwrap_or_default();
        Self {
            problem,
            throws,
            known: Mutex::default(),
        }
    }

    /// The prediction of a run with derivatives.
    ///
    /// # Errors
    /// As [`with_derivatives`].
    pub fn with_derivatives(
        &self,
        run: &Observation,
        x: &[f64],
        accuracy: Accuracy,
    ) -> Result<Prediction, Error> {
        if self.throws.is_empty() {
            return with_derivatives(self.problem, run, x, accuracy);
        }
        let mut sum = nothing(run, x.len());
        for (i, throw) in self.throws.iter().enumerate() {
            let Some((own, x)) = throw.part(run, x) else {
                continue;
            };
            let asked = asked(i, own, (true, accuracy), &x);
            let share = match self.known(&asked) {
                Some(share) => share,
                None => {
                    let share = Arc::new(with_derivatives(&throw.problem, own, &x, accuracy)?);
                    self.keep(asked, &share);
                    share
                }
            };
            add(&mut sum, run, (throw, own, &share));
        }
        Ok(sum)
    }

    /// The predictions of these runs at these coordinates without derivatives, simulated side by side.
    ///
    /// # Errors
    /// As [`predictions`].
    pub fn predictions(
        &self,
        wanted: &[Wanted],
        accuracy: Accuracy,
    ) -> Vec<Result<Prediction, Error>> {
        if self.throws.is_empty() {
            return predictions(self.problem, wanted, accuracy);
        }
        let sums = wanted.iter().map(|(run, _)| Ok(nothing(run, 0)));
        let mut sums: Vec<Result<Prediction, Error>> = sums.collect();
        for (i, throw) in self.throws.iter().enumerate() {
            let parts = wanted.iter().map(|(run, x)| throw.part(run, x));
            let parts: Vec<Option<(&Observation, Vec<f64>)>> = parts.collect();
            let mut shares = self.shares((i, throw), parts.iter().flatten(), accuracy);
            for ((sum, (run, _)), part) in sums.iter_mut().zip(wanted).zip(&parts) {
                let (Ok(whole), Some((own, x))) = (&mut *sum, part) else {
                    continue;
                };
                let asked = asked(i, own, (false, accuracy), x);
                match shares.remove(&asked) {
                    Some(Ok(share)) => {
                        add(whole, run, (throw, own, &share));
                        shares.insert(asked, Ok(share));
                    }
                    Some(Err(error)) => *sum = Err(error),
                    None => *sum = Err(Error::Nothing("a run cannot be simulated")),
                }
            }
        }
        sums
    }

    /// How many throws are simulated by themselves.
    pub fn throws(&self) -> usize {
        self.throws.len()
    }

    /// The coordinates of a machine whose throws have those that each of them has at one of these points. What several throws share is in the
    /// middle of their values.
    pub fn mixed(&self, points: &[&[f64]]) -> Vec<f64> {
        let mut mixed = points.first().map_or(Vec::new(), |x| x.to_vec());
        for (place, x) in mixed.iter_mut().enumerate() {
            let throws = self.throws.iter().zip(points);
            let of = throws.filter(|(throw, _)| throw.parameters.contains(&place));
            let of: Vec<f64> = of.map(|(_, point)| point[place]).collect();
            if !of.is_empty() {
                *x = of.iter().sum::<f64>() / of.len() as f64;
            }
        }
        mixed
    }

    /// What the machine shows in a run whose throws are each at one of these points; rough. None where one cannot be simulated.
    pub fn mixture(&self, run: &Observation, points: &[&[f64]]) -> Option<Prediction> {
        let mut sum = nothing(run, 0);
        for ((i, throw), x) in self.throws.iter().enumerate().zip(points) {
            let Some(part) = throw.part(run, x) else {
                continue;
            };
            let shares = self.shares((i, throw), std::iter::once(&part), Accuracy::Rough);
            let share = shares.into_values().next()?.ok()?;
            add(&mut sum, run, (throw, part.0, &share));
        }
        Some(sum)
    }

    /// What a throw shows in these runs at these coordinates of its own.
    fn shares<'w>(
        &self,
        (index, throw): (usize, &ThrowAlone),
        parts: impl Iterator<Item = &'w (&'w Observation, Vec<f64>)>,
        accuracy: Accuracy,
    ) -> HashMap<Asked, Result<Arc<Prediction>, Error>> {
        let mut shares = HashMap::new();
        let mut missing = Vec::new();
        for (run, x) in parts {
            let asked = asked(index, run, (false, accuracy), x);
            match self.known(&asked) {
                Some(share) => drop(shares.insert(asked, Ok(share))),
                None => missing.push((asked, (*run, &x[..]))),
            }
        }
        let (asked, runs): (Vec<Asked>, Vec<Wanted>) = missing.into_iter().unzip();
        let made = predictions(&throw.problem, &runs, accuracy).into_iter();
        for (asked, share) in asked.into_iter().zip(made) {
            let share = share.map(Arc::new);
            if let Ok(share) = &share {
                self.keep(asked.clone(), share);
            }
            shares.insert(asked, share);
        }
        shares
    }

    fn known(&self, asked: &Asked) -> Option<Arc<Prediction>> {
        self.known.lock().ok()?.get(asked).cloned()
    }

    fn keep(&self, asked: Asked, share: &Arc<Prediction>) {
        if let Ok(mut of) = self.known.lock() {
            if of.len() >= KEPT {
                of.clear();
            }
            of.insert(asked, share.clone());
        }
    }
}

fn asked(throw: usize, run: &Observation, how: (bool, Accuracy), x: &[f64]) -> Asked {
    let bits = x.iter().map(|x| x.to_bits()).collect();
    (throw, run.id.clone(), how, bits)
}

/// What is there of a run before the share of any throw.
fn nothing(run: &Observation, parameters: usize) -> Prediction {
    let none = OrderLines {
        amplitude: Vec::new(),
        variance: Vec::new(),
        revolutions: usize::MAX,
    };
    let channels = run.channels.len();
    Prediction {
        derivatives: vec![vec![Vec::new(); channels]; parameters],
        scatter: vec![Vec::new(); channels],
        ..Prediction::new(vec![none; channels], true)
    }
}

/// Adds the share of a throw.
fn add(
    sum: &mut Prediction,
    run: &Observation,
    (throw, own, share): (&ThrowAlone, &Observation, &Prediction),
) {
    sum.periodic &= share.periodic;
    for (of_own, channel) in own.channels.iter().enumerate() {
        let mut channels = run.channels.iter();
        let Some(at) = channels.position(|c| c.column == channel.column) else {
            continue;
        };
        let (whole, lines) = (&mut sum.lines[at], &share.lines[of_own]);
        add_to(&mut whole.amplitude, &lines.amplitude);
        add_to(&mut whole.variance, &lines.variance);
        // Throws scatter each by itself.
        if let Some(scatter) = share.scatter.get(of_own) {
            add_to(&mut sum.scatter[at], scatter);
        }
        whole.revolutions = whole.revolutions.min(lines.revolutions);
        for (place, derivatives) in throw.parameters.iter().zip(&share.derivatives) {
            if let Some(whole) = sum.derivatives.get_mut(*place) {
                add_to(&mut whole[at], &derivatives[of_own]);
            }
        }
    }
}

fn add_to<T: Copy + Default + AddAssign>(sum: &mut Vec<T>, of: &[T]) {
    sum.resize(sum.len().max(of.len()), T::default());
    sum.iter_mut().zip(of).for_each(|(sum, of)| *sum += *of);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crank_motion::CrankMotion;
    use crate::meter::Meter;
    use crate::observation::Observed;
    use crate::parameter::Parameter;
    use input::paths;
    use mechanism::drive::GivenSpeed;
    use serde_json::json;
    use signal::Complex64;
    use std::path::Path;

    const TURNING: f64 = 50.0;

    /// The two-stage machine with a crank of constant speed, whose crosshead and frame are looked at.
    fn problem(columns: [&str; 2]) -> Problem {
        let file = format!(
            "{}/../../data/machines/two-stage.yaml",
            env!("CARGO_MANIFEST_DIR")
        );
        let file = input::machine_file::read(Path::new(&file)).unwrap();
        let mut tree = file.to_tree().clone();
        paths::set(&mut tree, "crank.drive", json!("given")).unwrap();
        paths::set(&mut tree, "speed", json!(format!("{TURNING} rad/s"))).unwrap();
        let clearance = |throw| format!("throws.{throw}.joints.big_end.clearance");
        let parameter = |throw| Parameter::at(&tree, &clearance(throw)).unwrap();
        let channel = |column: &str| Observed {
            scatter: Vec::new(),
            column: column.into(),
            orders: (1..100).collect(),
            lines: OrderLines {
                amplitude: vec![Complex64::ZERO; 100],
                variance: vec![1.0; 100],
                revolutions: 20,
            },
        };
        Problem {
            parameters: ["throw1", "throw2"].map(parameter).into(),
            tree,
            runs: vec![Observation {
                id: "run".into(),
                settings: Vec::new(),
                crank: GivenSpeed {
                    speed: TURNING,
                    fluctuation: Vec::new(),
                },
                channels: columns.map(channel).into(),
                warm_start: None,
            }],
            crank: CrankMotion::Driven,
            meter: Meter::default(),
        }
    }

    /// The greatest difference of lines over the greatest line, from order 1 on: the weight of the crank itself is a constant.
    fn apart(a: &[Complex64], b: &[Complex64]) -> f64 {
        let greatest = |of: &mut dyn Iterator<Item = f64>| of.fold(0.0, f64::max);
        let pairs = a.iter().zip(b).skip(1).take(99);
        let difference = greatest(&mut pairs.map(|(a, b)| (a - b).norm()));
        difference / greatest(&mut b.iter().skip(1).map(|c| c.norm()))
    }

    #[test]
    fn the_frame_shows_the_sum_of_the_throws_and_a_throw_itself() {
        let problem = problem([
            "frame_acceleration_x_m_s2",
            "throw2.crosshead_acceleration_m_s2",
        ]);
        let parts = Superposition::new(&problem);
        assert_eq!(parts.throws.len(), 2);
        let (run, x) = (&problem.runs[0], [0.3, -0.2]);
        let sum = parts.with_derivatives(run, &x, Accuracy::Coarse).unwrap();
        let whole = with_derivatives(&problem, run, &x, Accuracy::Coarse).unwrap();
        assert!(sum.periodic && whole.periodic);
        for channel in 0..2 {
            let [a, b] = [&sum, &whole].map(|of| &of.lines[channel].amplitude);
            assert!(apart(a, b) < 2e-3, "{channel}: {}", apart(a, b));
        }
        for parameter in 0..2 {
            let [a, b] = [&sum, &whole].map(|of| &of.derivatives[parameter][0]);
            assert!(apart(a, b) < 5e-2, "{parameter}: {}", apart(a, b));
        }
        // Only the second throw is simulated again.
        let before = problem.meter.steps();
        let roughly = |x: [f64; 2]| {
            let mut all = parts.predictions(&[(run, &x)], Accuracy::Rough);
            all.remove(0).unwrap()
        };
        let rough = roughly(x);
        let both = problem.meter.steps() - before;
        roughly([0.3, -0.1]);
        let one = problem.meter.steps() - before - both;
        assert!(10 * one < 7 * both, "{one} of {both}");
        let [a, b] = [&rough, &whole].map(|of| &of.lines[0].amplitude);
        assert!(apart(a, b) < 5e-2, "{}", apart(a, b));
    }

    #[test]
    fn throws_of_two_points_are_mixed() {
        let problem = problem([
            "frame_acceleration_x_m_s2",
            "throw2.crosshead_acceleration_m_s2",
        ]);
        let parts = Superposition::new(&problem);
        let run = &problem.runs[0];
        let points = [&[0.3, -0.2][..], &[0.1, 0.4][..]];
        assert_eq!(parts.mixed(&points), [0.3, 0.4]);
        let mixture = parts.mixture(run, &points).unwrap();
        let mut same = parts.predictions(&[(run, &[0.3, 0.4])], Accuracy::Rough);
        assert_eq!(mixture.lines, same.remove(0).unwrap().lines);
    }

    #[test]
    fn a_machine_whose_throws_act_on_each_other_is_simulated_as_a_whole() {
        let mut problem = problem(["frame_acceleration_x_m_s2", "frame_acceleration_y_m_s2"]);
        let taken_apart = |problem: &Problem| !Superposition::new(problem).throws.is_empty();
        assert!(taken_apart(&problem));
        let clear = json!("0.1 mm");
        let mut coupled = problem.clone();
        paths::set(&mut coupled.tree, "joints.main.clearance", clear).unwrap();
        assert!(!taken_apart(&coupled));
        problem.tree["effects"] = json!([{"frame_compliance": {}}]);
        assert!(!taken_apart(&problem));
    }
}
