//! Files to fill in: right as they stand, with the words of the schema.

use input::MachineFile;
use input::schema::{bundle_schema, machine_schema};
use input::template::{Asked, bundle, calibration, machine};
use serde_json::Value;

fn asked(throws: Option<usize>, double_acting: bool) -> String {
    machine(&Asked {
        like: None,
        throws,
        double_acting,
    })
    .unwrap()
}

/// Comments as one text, without line breaks.
fn comments(text: &str) -> String {
    let lines = text.lines().map(str::trim_start);
    let words = lines
        .filter_map(|line| line.strip_prefix('#'))
        .map(str::trim);
    words.collect::<Vec<_>>().join(" ")
}

#[test]
fn a_machine_has_what_is_asked_for() {
    for throws in [None, Some(1), Some(2), Some(3), Some(6)] {
        for double_acting in [false, true] {
            let text = asked(throws, double_acting);
            let machine = MachineFile::from_yaml(&text, "m.yaml").and_then(|file| file.resolve());
            let machine = machine.unwrap_or_else(|e| panic!("{e}\n{text}")).machine;
            assert_eq!(machine.throws.len(), throws.unwrap_or(1));
            let has_end = |t: &mechanism::Throw| t.cylinder.crank_end.is_some();
            assert!(machine.throws.iter().all(|t| has_end(t) == double_acting));
        }
    }
}

#[test]
fn the_comments_are_the_words_of_the_schema() {
    /// The descriptions of the keys that `tree` has, as far as `schema` leads to them.
    fn words(tree: &Value, schema: &Value, root: &Value, all: &mut Vec<String>) {
        let target = schema["$ref"]
            .as_str()
            .and_then(|r| root.pointer(r.trim_start_matches('#')));
        if let Some(target) = target {
            return words(tree, target, root, all);
        }
        let (Some(section), Some(properties)) =
            (tree.as_object(), schema["properties"].as_object())
        else {
            return;
        };
        for (key, value) in section {
            let property = &properties[key];
            all.push(
                property["description"]
                    .as_str()
                    .unwrap_or_else(|| panic!("{key}"))
                    .to_owned(),
            );
            words(value, property, root, all);
        }
    }
    let files = [
        (asked(Some(2), true), machine_schema()),
        (bundle(&[]).unwrap(), bundle_schema()),
        (calibration("b").unwrap(), input::calibration::schema()),
    ];
    for (text, schema) in files {
        let tree = input::yaml::Document::parse(&text, "f.yaml").unwrap().tree;
        let said = comments(&text);
        let mut all = Vec::new();
        words(&tree, &schema, &schema, &mut all);
        assert!(all.len() >= 2);
        for words in all {
            let words = words.split_whitespace().collect::<Vec<_>>().join(" ");
            assert!(said.contains(&words), "'{words}' is not in\n{text}");
        }
    }
}

#[test]
fn the_comments_say_what_people_ask() {
    let said = comments(&asked(Some(2), true));
    for words in [
        "Radial clearance: half the difference of the diameters",
        "crosshead, crosshead pin, piston rod, piston and rings",
        "Or twice this, as data sheets have it: stroke",
        "Or in % of the swept volume: clearance_volume",
        "Also: connecting_rod",
        "ambient_pressure",
    ] {
        assert!(said.contains(words), "{words}\n{said}");
    }
}

#[test]
fn a_machine_like_another_has_its_values() {
    let text = "name: a\nrpm: 740\nstroke: 150 mm\nrod: {length: 600 mm, mass: 12 kg, centre_of_mass: 220 mm, inertia: 0.6 kg m^2}\n\
                crosshead: {mass: 18 kg}\n\
                cylinder: {bore: 100 mm, suction: 1 bar, discharge: 4 bar, back: 0 Pa, exponent: 1.4, clearance_volume: 16 %}\n";
    let like = MachineFile::from_yaml(text, "m.yaml").unwrap();
    let asked = Asked {
        like: Some(&like),
        ..Asked::default()
    };
    let again = MachineFile::from_yaml(&machine(&asked).unwrap(), "n.yaml").unwrap();
    assert_eq!(again.resolve().unwrap(), like.resolve().unwrap());
}

/// A file with its suggestions taken: keys that are commented out with a usual value.
fn with_suggestions(text: &str) -> (String, usize) {
    let mut taken = 0;
    let lines = text.lines().map(|line| {
        let indent = line.len() - line.trim_start().len();
        let suggested = line.trim_start().strip_prefix("# ").and_then(|rest| {
            let (key, _) = rest.split_once(": ")?;
            let is_key = key.chars().all(|c| c.is_ascii_lowercase() || c == '_');
            is_key.then_some(rest)
        });
        match suggested {
            Some(rest) => {
                taken += 1;
                format!("{}{rest}", &line[..indent])
            }
            None => line.to_owned(),
        }
    });
    let text = lines.collect::<Vec<_>>().join("\n") + "\n";
    (text, taken)
}

#[test]
fn what_is_suggested_is_right_too() {
    for text in [asked(None, false), asked(Some(2), true)] {
        assert!(text.contains("# ambient_pressure: 1.013 bar"), "{text}");
        let (text, taken) = with_suggestions(&text);
        assert!(taken >= 4, "{text}");
        let machine = MachineFile::from_yaml(&text, "m.yaml").and_then(|file| file.resolve());
        machine.unwrap_or_else(|e| panic!("{e}\n{text}"));
    }
    let (text, taken) = with_suggestions(&calibration("recordings").unwrap());
    assert!(taken >= 4, "{text}");
    let document = input::yaml::Document::parse(&text, "c.yaml").unwrap();
    input::calibration::Calibration::from_document(&document)
        .unwrap_or_else(|e| panic!("{e}\n{text}"));
}

#[test]
fn nothing_is_suggested_that_every_throw_states() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../data/machines/two-stage.yaml"
    );
    let like = input::machine_file::read(std::path::Path::new(path)).unwrap();
    let asked = Asked {
        like: Some(&like),
        ..Asked::default()
    };
    let text = machine(&asked).unwrap();
    for key in ["piston_radius", "suction", "discharge", "head_clearance"] {
        assert!(!text.contains(&format!("# {key}: ")), "{key}\n{text}");
    }
}
