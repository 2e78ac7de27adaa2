//! The labels of a case: which joints are faulty, and how large each clearance is.

use input::Resolved;
use mechanism::Machine;

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
    /// The faulty joints, joined by `+` in the order of [`joints`]; `none` where there is none.
    pub fault: String,
    /// How many joints are faulty.
    pub faulty_joints: usize,
    /// Clearance of every joint in the order of [`joints`], m; 0 for an ideal one.
    pub clearances_m: Vec<f64>,
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
    /// Its clearance in `case`, and the one up to which it is healthy, m.
    fn clearances(&self, case: &Resolved) -> [f64; 2] {
        let (machine, normal) = (&case.machine, &case.normal_clearance);
        let revolute = |joint: &mechanism::joints::revolute::Revolute| {
            joint.clear().map_or(0.0, |c| c.clearance)
        };
        match self.place {
            Place::Main => [revolute(&machine.main), normal.main],
            Place::BigEnd(i) => [
                revolute(&machine.throws[i].big_end),
                normal.throws[i].big_end,
            ],
            Place::SmallEnd(i) => [
                revolute(&machine.throws[i].small_end),
                normal.throws[i].small_end,
            ],
            Place::Guide(i) => [
                machine.throws[i].guide.clear().map_or(0.0, |c| c.clearance),
                normal.throws[i].guide,
            ],
        }
    }
}

/// The labels of `case`, a machine with these `joints`. A joint is faulty where its clearance
/// exceeds the normal one.
pub fn labels(joints: &[Joint], case: &Resolved) -> Labels {
    let clearances: Vec<[f64; 2]> = joints.iter().map(|joint| joint.clearances(case)).collect();
    let faulty: Vec<&str> = joints
        .iter()
        .zip(&clearances)
        .filter(|(_, [clearance, normal])| clearance > normal)
        .map(|(joint, _)| joint.name.as_str())
        .collect();
    Labels {
        fault: match faulty.as_slice() {
            [] => "none".into(),
            faulty => faulty.join("+"),
        },
        faulty_joints: faulty.len(),
        clearances_m: clearances
            .into_iter()
            .map(|[clearance, _]| clearance)
            .collect(),
    }
}
