//! What a dataset says of its columns, faults and licence: to people, to programs, in words that others use.

use crate::toy::{self, plan, run};
use recordings::{Manifest, Role};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use sweep::dataset::Tables;
use sweep::fault_words::Fault;
use sweep::{Existing, Plan};

/// The fault, its type, its location and its level in each case.
fn words(plan: &Plan) -> BTreeSet<(String, String, String, u64)> {
    let joined = |faults: &[Fault], word: fn(&Fault) -> &str| {
        let words: Vec<&str> = faults.iter().map(word).collect();
        words.join("+")
    };
    let cases = (0..plan.cases()).map(|i| plan.case(i).unwrap().labels);
    let words = cases.map(|labels| {
        let types = joined(&labels.faults, |fault| fault.kind);
        let places = joined(&labels.faults, |fault| &fault.location);
        (
            labels.fault.clone(),
            types,
            places,
            plan.severity_level(&labels),
        )
    });
    words.collect()
}

const HEAD: &str = "name: test\nmachine: single-stage.yaml\nrun: {revolutions: 4, transient: 2}\n";

#[test]
fn faults_have_the_words_and_ranks_of_other_datasets() {
    let rest = "cases:
  - grid: {joints: [[], [big_end], [big_end, small_end], [guide]], clearance: [0.1 mm, 300 um, 0.3 mm, 0.2 mm]}
  - grid: {effects.ring_leakage.area: [0 mm^2, 2 mm^2, 1 mm^2], effects.rotating_unbalance.eccentricity: [0 mm, 0.5 mm]}
";
    let found = words(&plan(&format!("{HEAD}{rest}")));
    let case = |fault: &str, kind: &str, place: &str, level| {
        (fault.to_owned(), kind.to_owned(), place.to_owned(), level)
    };
    let mut expected = BTreeSet::from([
        case("none", "", "", 0),
        case("rotating_unbalance", "unbalance", "frame", 1),
        // The ranks of the leak, whatever the unbalance.
        case("ring_leakage", "other", "cylinder", 1),
        case("ring_leakage", "other", "cylinder", 2),
        case(
            "ring_leakage+rotating_unbalance",
            "other+unbalance",
            "cylinder+frame",
            1,
        ),
        case(
            "ring_leakage+rotating_unbalance",
            "other+unbalance",
            "cylinder+frame",
            2,
        ),
    ]);
    // One length in two units is one rank.
    for level in 1..=3 {
        expected.insert(case("big_end", "bearing", "big_end", level));
        expected.insert(case("guide", "other", "guide", level));
        let both = "big_end+small_end";
        expected.insert(case(both, "bearing+bearing", both, level));
    }
    assert_eq!(found, expected);
}

#[test]
fn the_table_has_these_words_and_the_load() {
    use recordings::formats::parquet;
    let folder = tempfile::tempdir().unwrap();
    run(&plan(toy::SWEEP), folder.path(), Existing::Refuse, 2).unwrap();
    let path = folder.path().join("features/train-00000-of-00005.parquet");
    let table = parquet::read_table(&path).unwrap();
    let texts = |name: &str| table.values::<String>(name).unwrap().to_vec();
    let [fault, kind, place] = ["fault", "fault_type", "fault_location"].map(texts);
    let level = table.values::<i64>("fault_severity_level").unwrap();
    assert!(table.rows() > 4);
    for row in 0..table.rows() {
        match fault[row].as_deref().unwrap() {
            "none" => {
                assert_eq!(kind[row].as_deref(), Some("normal"));
                assert_eq!(place[row].as_deref(), Some("none"));
                assert_eq!(level[row], Some(0));
            }
            fault => {
                assert_eq!(place[row].as_deref(), Some(fault));
                assert!(matches!(level[row], Some(1 | 2)));
            }
        }
    }
    // π r² (pd − ps) of the machine file.
    let gas = std::f64::consts::PI * 0.05 * 0.05 * (0.393e6 - 0.105e6);
    let load = table.values::<f64>("load").unwrap();
    assert!((load[0].unwrap() - gas).abs() < 1e-6 * gas, "{:?}", load[0]);
    let column = &table.schema().columns()[table.schema().position("load").unwrap()];
    assert_eq!(column.unit.as_deref(), Some("N"));
    assert_eq!(column.role, Some(Role::Condition));
}

#[test]
fn every_column_has_a_role_in_tables_manifest_and_card() {
    let folder = tempfile::tempdir().unwrap();
    let plan = plan(toy::SWEEP);
    run(&plan, folder.path(), Existing::Refuse, 2).unwrap();
    let tables = Tables::new(&plan).unwrap();
    let manifest = Manifest::read(&folder.path().join("manifest.json")).unwrap();
    let card = fs::read_to_string(folder.path().join("README.md")).unwrap();
    assert_eq!(manifest.columns.len(), 2);
    for (name, schema) in [("signals", &tables.signals), ("features", &tables.features)] {
        let listed = &manifest.columns[name];
        assert_eq!(listed.len(), schema.columns().len());
        for (column, entry) in schema.columns().iter().zip(listed) {
            let role = column.role.map(Role::name);
            assert!(role.is_some(), "{name}: {}", column.name);
            assert_eq!(entry.role.as_deref(), role, "{}", column.name);
            assert_eq!((&entry.name, &entry.unit), (&column.name, &column.unit));
            if column.role != Some(Role::Feature) {
                let row = format!("\n| `{}` | {} |", column.name, role.unwrap());
                assert!(card.contains(&row), "{row}");
            }
        }
    }
    // A row for each quantity, not for each of the columns.
    let (_, features) = card.split_once("### Features in `features`").unwrap();
    let rows = features
        .lines()
        .filter(|line| line.starts_with("| `"))
        .count();
    let columns = tables.features.columns().iter();
    let columns = columns.filter(|c| c.role == Some(Role::Feature)).count();
    assert!(3 * rows < columns, "{rows} rows for {columns} columns");
}

#[test]
fn croissant_has_every_file_of_a_table_and_every_column() {
    let folder = tempfile::tempdir().unwrap();
    let [whole, licensed] = ["whole", "licensed"].map(|name| folder.path().join(name));
    let sweep = plan(toy::SWEEP);
    run(&sweep, &whole, Existing::Refuse, 2).unwrap();
    let read = |root: &std::path::Path| -> Value {
        serde_json::from_slice(&fs::read(root.join("croissant.json")).unwrap()).unwrap()
    };
    let manifest = Manifest::read(&whole.join("manifest.json")).unwrap();
    let croissant = read(&whole);
    assert_eq!(
        croissant["conformsTo"],
        "http://mlcommons.org/croissant/1.0"
    );
    assert_eq!(croissant.get("license"), None);
    let listed: BTreeSet<(&str, &str)> = croissant["distribution"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|resource| resource["@type"] == "cr:FileObject")
        .map(|file| {
            let text = |key: &str| file[key].as_str().unwrap();
            (text("contentUrl"), text("sha256"))
        })
        .collect();
    let tables = manifest.files.iter().filter(|file| file.rows.is_some());
    let expected: BTreeSet<(&str, &str)> = tables
        .map(|f| (f.path.as_str(), f.sha256.as_str()))
        .collect();
    assert_eq!(listed.len(), 2 * 2 * 5);
    assert_eq!(listed, expected);
    for (set, name) in croissant["recordSet"]
        .as_array()
        .unwrap()
        .iter()
        .zip(["signals", "features"])
    {
        assert_eq!(set["name"], name);
        let fields = set["field"].as_array().unwrap();
        let columns: Vec<&str> = fields
            .iter()
            .map(|f| f["source"]["extract"]["column"].as_str().unwrap())
            .collect();
        let names: Vec<&str> = manifest.columns[name]
            .iter()
            .map(|column| column.name.as_str())
            .collect();
        assert_eq!(columns, names);
    }
    // It is one of the dataset's files.
    assert!(
        manifest
            .files
            .iter()
            .any(|file| file.path == "croissant.json")
    );

    // The licence is in all that is published, and makes another dataset.
    let text = toy::SWEEP.replace("seed: 3", "seed: 3\nlicence: CC-BY-4.0");
    let free = plan(&text);
    assert_ne!(free.id, sweep.id);
    run(&free, &licensed, Existing::Refuse, 2).unwrap();
    assert_eq!(
        read(&licensed)["license"],
        "https://spdx.org/licenses/CC-BY-4.0"
    );
    let card = fs::read_to_string(licensed.join("README.md")).unwrap();
    assert!(card.contains("\nlicense: \"cc-by-4.0\"\n"), "{card}");
    let path = licensed.join("signals/train-00000-of-00005.parquet");
    let table = recordings::formats::parquet::read_table(&path).unwrap();
    assert_eq!(table.schema().metadata()["license"], "CC-BY-4.0");
}
