//! One throw of several, by itself.
//!
//! Throws whose shaft lies in an ideal bearing feel each other through the crank's turning alone.
//! Where the crank turns as it was recorded, each of them is therefore a machine of its own, with few
//! parameters and few minima.

use crate::crank_motion::CrankMotion;
use crate::error::Error;
use crate::observation::{Observation, Observed};
use crate::problem::{Problem, throw};
use input::MachineFile;
use serde_json::Value;

/// A throw's own problem, and which of the whole problem's parameters it has.
#[derive(Clone, Debug)]
pub struct ThrowAlone {
    /// Its problem.
    pub problem: Problem,
    /// The indices of its parameters among those of the whole.
    pub parameters: Vec<usize>,
}

impl ThrowAlone {
    /// A run of the whole machine at these coordinates as this throw has it.
    pub(crate) fn part(&self, run: &Observation, x: &[f64]) -> Option<(&Observation, Vec<f64>)> {
        let own = self.problem.runs.iter().find(|own| own.id == run.id)?;
        Some((own, self.parameters.iter().map(|i| x[*i]).collect()))
    }
}

/// Each throw of a problem by itself. None where there is only one, or where they cannot be taken
/// apart.
///
/// # Errors
/// An invalid machine.
pub fn throws_alone(problem: &Problem) -> Result<Vec<ThrowAlone>, Error> {
    alone_with(problem, |_| false)
}

/// The same with their shares in what the frame shows. None where that is not their sum, or where a channel belongs to
/// none of them.
///
/// # Errors
/// An invalid machine.
pub(crate) fn throws_in_parts(problem: &Problem) -> Result<Vec<ThrowAlone>, Error> {
    let runs = problem.runs.iter();
    let mut shared = runs.flat_map(|run| &run.channels).filter(|c| is_shared(c));
    let effects = problem.tree.get("effects").and_then(Value::as_array);
    let is_linear = effects.is_none_or(|effects| effects.iter().all(|e| throw_of(e).is_some()));
    if shared.any(|channel| !(is_linear && channel.column.starts_with("frame_"))) {
        return Ok(Vec::new());
    }
    alone_with(problem, is_shared)
}

/// Whether a channel is not that of a throw.
fn is_shared(channel: &Observed) -> bool {
    !channel.column.contains('.')
}

fn alone_with(
    problem: &Problem,
    shares: impl Fn(&Observed) -> bool,
) -> Result<Vec<ThrowAlone>, Error> {
    let machine = MachineFile::from_tree(&problem.tree)?.resolve()?;
    let names: Vec<&str> = machine
        .machine
        .throws
        .iter()
        .map(|t| t.name.as_str())
        .collect();
    if names.len() < 2 || machine.machine.main.clear().is_some() || machine.speed <= 0.0 {
        return Ok(Vec::new());
    }
    let alone = names.iter().map(|name| alone(problem, name, &shares));
    Ok(alone.filter(|a| !a.problem.runs.is_empty()).collect())
}

fn alone(problem: &Problem, name: &str, shares: impl Fn(&Observed) -> bool) -> ThrowAlone {
    let mut tree = problem.tree.clone();
    let effects = Effects::new(&tree, name);
    let belongs =
        |path: &str| throw(path).is_none_or(|of| of == name) && effects.renamed(path).is_some();
    keep(&mut tree, "throws", |item| word(item, "name") == Some(name));
    keep(&mut tree, "sensors", |item| {
        word(item, "throw").is_none_or(|of| of == name)
    });
    keep(&mut tree, "effects", |item| acts_on(item, name));
    let parameters: Vec<usize> = (0..problem.parameters.len())
        .filter(|i| belongs(&problem.parameters[*i].path))
        .collect();
    let own = parameters.iter().map(|i| {
        let mut parameter = problem.parameters[*i].clone();
        parameter.places.retain(|place| belongs(place));
        let places = parameter.places.iter_mut();
        for path in places.chain([&mut parameter.path]) {
            *path = effects.renamed(path).unwrap_or_default();
        }
        parameter
    });
    let runs = problem.runs.iter().map(|run| Observation {
        settings: run
            .settings
            .iter()
            .filter(|(path, _)| belongs(path))
            .cloned()
            .collect(),
        channels: run
            .channels
            .iter()
            .filter(|c| {
                let own = c.column.split_once('.').is_some_and(|(of, _)| of == name);
                own || shares(c)
            })
            .cloned()
            .collect(),
        ..run.clone()
    });
    ThrowAlone {
        problem: Problem {
            tree,
            parameters: own.collect(),
            runs: runs.filter(|run| !run.channels.is_empty()).collect(),
            crank: CrankMotion::Recorded,
            meter: problem.meter.clone(),
        },
        parameters,
    }
}

/// The effects of a machine that one throw feels, by their indices.
struct Effects(Vec<usize>);

impl Effects {
    fn new(tree: &Value, name: &str) -> Self {
        let effects = tree.get("effects").and_then(Value::as_array);
        let all = effects.into_iter().flatten().enumerate();
        let felt = all.filter(|(_, item)| acts_on(item, name));
        Self(felt.map(|(i, _)| i).collect())
    }

    /// A path where only these effects are left; none where it belongs to one of the others.
    fn renamed(&self, path: &str) -> Option<String> {
        let indexed = path
            .strip_prefix("effects.")
            .and_then(|rest| rest.split_once('.'))
            .and_then(|(index, key)| Some((index.parse::<usize>().ok()?, key)));
        let Some((index, key)) = indexed else {
            return Some(path.to_owned());
        };
        let place = self.0.iter().position(|felt| *felt == index)?;
        Some(format!("effects.{place}.{key}"))
    }
}

/// Whether an effect, a section by its name, acts on a throw.
fn acts_on(effect: &Value, name: &str) -> bool {
    throw_of(effect).is_none_or(|of| of == name)
}

/// The throw that an effect acts on; none where it names none.
fn throw_of(effect: &Value) -> Option<&str> {
    let mut sections = effect.as_object().into_iter().flatten();
    sections.find_map(|(_, section)| word(section, "throw"))
}

fn keep(tree: &mut Value, list: &str, whether: impl Fn(&Value) -> bool) {
    if let Some(Value::Array(items)) = tree.get_mut(list) {
        items.retain(whether);
    }
}

fn word<'a>(item: &'a Value, key: &str) -> Option<&'a str> {
    item.get(key).and_then(Value::as_str)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn effects_of_other_throws_are_left_out_and_the_others_counted_anew() {
        let at = |throw: &str| json!({"valve_loss": {"throw": throw}});
        let tree = json!({"effects": [at("one"), {"mains_hum": {}}, at("two")]});
        let effects = Effects::new(&tree, "two");
        let renamed = |path| effects.renamed(path);
        assert_eq!(renamed("effects.0.valve_loss.suction"), None);
        assert_eq!(renamed("effects.1.a.b").as_deref(), Some("effects.0.a.b"));
        assert_eq!(renamed("effects.2.a.b").as_deref(), Some("effects.1.a.b"));
        assert_eq!(renamed("speed").as_deref(), Some("speed"));
    }
}
