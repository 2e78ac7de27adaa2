//! The labels of a case: which joints are faulty, how large each clearance is, and which of the
//! effects that the sweep varies it has.

use input::{Resolved, paths};
use mechanism::Machine;
use serde_json::Value;

use crate::effects::VariedEffect;
use crate::fault_words::Fault;
use crate::sweep_file::Amount;

/// The label of a case without any fault.
pub const NONE: &str = "none";

/// Relative tolerance within which a clearance equals the normal one. One length in two units, 30
/// um and 0.03 mm, differs by rounding, 1e-16.
const ROUNDING: f64 = 1e-9;

/// A joint of the machine, by the name that labels and sweeps give it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Joint {
    /// `main`, `big_end`, `small_end` or `guide`; with the throw before it in a machine of
    /// several: `throw1.big_end`.
    pub name: String,
    /// The path of its clearance in the machine file.
    pub clearance_path: String,
    place: Place,
}

/// Where a joint is. Throws are counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    Main,
    BigEnd(usize),
    SmallEnd(usize),
    Guide(usize),
}

/// The labels of one case.
#[derive(Clone, Debug, PartialEq)]
pub struct Labels {
    /// The faulty joints in the order of [`joints`], then the effects, joined by `+`; `none` where
    /// there is neither.
    pub fault: String,
    /// How many joints are faulty.
    pub faulty_joints: usize,
    /// Clearance of every joint in the order of [`joints`], m; 0 for an ideal one.
    pub clearances_m: Vec<f64>,
    /// The faults one by one: joints and effects, in the order of `fault`.
    pub faults: Vec<Fault>,
}

/// The joints of `machine`: the main bearing, then big end, small end and guide of each throw.
pub fn joints(machine: &Machine) -> Vec<Joint> {
    let main = Joint {
        name: "main".into(),
        clearance_path: "joints.main.clearance".into(),
        place: Place::Main,
    };
    let throws = machine.throws.iter().enumerate().flat_map(|(i, throw)| {
        let (prefix, section) = match throw.name.as_str() {
            "" => (String::new(), String::new()),
            name => (format!("{name}."), format!("throws.{name}.")),
        };
        let places = [
            ("big_end", Place::BigEnd(i)),
            ("small_end", Place::SmallEnd(i)),
            ("guide", Place::Guide(i)),
        ];
        places.map(|(joint, place)| Joint {
            name: format!("{prefix}{joint}"),
            clearance_path: format!("{section}joints.{joint}.clearance"),
            place,
        })
    });
    std::iter::once(main).chain(throws).collect()
}

impl Joint {
    /// Its clearance in `case`, and the one up to which it is healthy where the file states that, m.
    fn clearances(&self, case: &Resolved) -> (f64, Option<f64>) {
        let (machine, normal) = (&case.machine, &case.normal_clearance);
        let revolute = |joint: &mechanism::joints::revolute::Revolute| {
            joint.clear().map_or(0.0, |c| c.clearance)
        };
        match self.place {
            Place::Main => (revolute(&machine.main), normal.main),
            Place::BigEnd(i) => (
                revolute(&machine.throws[i].big_end),
                normal.throws[i].big_end,
            ),
            Place::SmallEnd(i) => (
                revolute(&machine.throws[i].small_end),
                normal.throws[i].small_end,
            ),
            Place::Guide(i) => (
                machine.throws[i].guide.clear().map_or(0.0, |c| c.clearance),
                normal.throws[i].guide,
            ),
        }
    }

    /// The clearance that the machine file `tree` gives it, before any effect changes it, m.
    fn stated_clearance(&self, tree: &Value) -> f64 {
        let value = paths::get(tree, &self.clearance_path).ok().flatten();
        value
            .and_then(Amount::from_value)
            .map_or(0.0, |amount| amount.si)
    }

    /// Whether it is faulty in the case with the machine file `tree`, which is `resolved`. `own` is
    /// the sweep's machine file with the values that are drawn from a calibration.
    ///
    /// Where no normal clearance is stated, the one of `own` is normal. Both are
    /// then compared as the files state them: what an effect adds to a clearance (warmth, say) is
    /// part of the machine, or a label of its own.
    fn is_faulty(&self, tree: &Value, resolved: &Resolved, own: &Value) -> bool {
        let (clearance, normal) = match self.clearances(resolved) {
            (clearance, Some(normal)) => (clearance, normal),
            (_, None) => (self.stated_clearance(tree), self.stated_clearance(own)),
        };
        clearance > normal * (1.0 + ROUNDING)
    }
}

/// The labels of the case with the machine file `tree`, which is `resolved`: a machine with these
/// `joints` in a sweep that varies these `effects` of the machine file `own`.
pub(crate) fn labels(
    joints: &[Joint],
    effects: &[VariedEffect],
    tree: &Value,
    resolved: &Resolved,
    own: &Value,
) -> Labels {
    let faulty: Vec<&Joint> = joints
        .iter()
        .filter(|joint| joint.is_faulty(tree, resolved, own))
        .collect();
    let there: Vec<&VariedEffect> = effects.iter().filter(|e| e.is_in(tree)).collect();
    let mut names: Vec<&str> = faulty.iter().map(|joint| joint.name.as_str()).collect();
    for effect in &there {
        if !names.contains(&effect.label.as_str()) {
            names.push(&effect.label);
        }
    }
    let worn = faulty.iter().map(|joint| {
        let (clearance, _) = joint.clearances(resolved);
        Fault::of_joint(&joint.name, clearance)
    });
    Labels {
        fault: match names.as_slice() {
            [] => NONE.into(),
            names => names.join("+"),
        },
        faulty_joints: faulty.len(),
        clearances_m: joints.iter().map(|j| j.clearances(resolved).0).collect(),
        faults: worn.chain(there.iter().map(|e| e.fault(tree))).collect(),
    }
}
