//! The tables of the pages follow from the declarations.

use input::effects::{CATALOGUE, Entry};
use mechanism::joints::contact::CONTACT_LAWS;
use mechanism::joints::materials::MATERIALS;
use serde_json::Value;
use simulate::sensors::SENSORS;
use std::fs;
use std::path::Path;
use std::sync::Mutex;

/// Most keys that a cell lists one by one.
const LISTED: usize = 6;

#[test]
fn the_table_of_effects_is_current() {
    let mut table = String::from(
        "| effect | law | amplitudes | other keys | where | after |\n|---|---|---|---|---|---|\n",
    );
    for entry in CATALOGUE.iter() {
        table.push_str(&row(entry));
    }
    check("crates/mechanism/LAWS.md", "effects", &table);
}

#[test]
fn the_table_of_contact_laws_is_current() {
    let mut table = String::from("| law | what it is | keys |\n|---|---|---|\n");
    for law in CONTACT_LAWS {
        let declared = &law.declaration;
        let own = declared.parameters.iter();
        let own = own.map(|parameter| match parameter.default {
            None => format!("`{}`", parameter.key),
            Some(_) => format!("(`{}`)", parameter.key),
        });
        let stiffness = declared.stiffness.map(|_| "`stiffness`".to_owned());
        let keys: Vec<String> = stiffness.into_iter().chain(own).collect();
        let keys = keys.join(", ");
        table.push_str(&format!(
            "| `{}` | {} | {keys} |\n",
            law.name, declared.about
        ));
    }
    check("crates/mechanism/LAWS.md", "contact laws", &table);
}

#[test]
fn the_table_of_sensors_is_current() {
    let mut table = String::from("| sensor | what it measures | columns |\n|---|---|---|\n");
    for sensor in SENSORS {
        let declared = &sensor.declaration;
        let columns = declared.channels.iter().map(|channel| channel.column);
        let columns = listed(columns);
        let name = sensor.name;
        table.push_str(&format!("| `{name}` | {} | {columns} |\n", declared.about));
    }
    check("crates/simulate/SENSORS.md", "sensors", &table);
}

#[test]
fn the_table_of_synonyms_is_current() {
    let mut rows: Vec<((&str, &str), Vec<String>)> = Vec::new();
    for (key, name, states) in input::synonyms() {
        let name = format!("`{name}`");
        match rows.iter_mut().find(|(row, _)| *row == (key, states)) {
            Some((_, names)) => names.push(name),
            None => rows.push(((key, states), vec![name])),
        }
    }
    let mut table = String::from("| key | names | which state |\n|---|---|---|\n");
    for ((key, states), names) in rows {
        table.push_str(&format!("| `{key}` | {} | {states} |\n", names.join(", ")));
    }
    check("crates/input/DATA-SHEETS.md", "synonyms", &table);
}

#[test]
fn the_table_of_materials_is_current() {
    let mut table = String::from("| name | material | E | ν |\n|---|---|---|---|\n");
    for entry in MATERIALS {
        let of = entry.material;
        let modulus = of.youngs_modulus / 1e9;
        table.push_str(&format!(
            "| `{}` | {} | {modulus} GPa | {} |\n",
            entry.name, entry.words, of.poisson_ratio
        ));
    }
    check("crates/input/MATERIALS.md", "materials", &table);
}

/// Every key at the top of the four files is explained.
#[test]
fn the_tables_of_keys_are_current() {
    for (file, schema) in [
        ("machine", "machine"),
        ("sweep", "sweep"),
        ("recordings", "bundle"),
        ("calibration", "calibration"),
    ] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../../data/schema")
            .join(format!("{schema}.schema.json"));
        let schema: Value = serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap();
        let mut table = String::from("| key | what it is |\n|---|---|\n");
        for (key, property) in schema["properties"].as_object().unwrap() {
            let words = property["description"].as_str();
            let words = words.unwrap_or_else(|| panic!("{file}.yaml: {key} is not explained"));
            let words = words.split_whitespace().collect::<Vec<_>>().join(" ");
            let needed = schema["required"].as_array().into_iter().flatten();
            let is_needed = needed.into_iter().any(|needed| needed == key);
            let mark = if is_needed { " (required)" } else { "" };
            table.push_str(&format!("| `{key}`{mark} | {words} |\n"));
        }
        check(
            "crates/input/KEYS.md",
            &format!("keys of {file}.yaml"),
            &table,
        );
    }
}

fn row(entry: &Entry) -> String {
    let keys = |amplitude: bool| {
        let keys = entry.parameters.iter();
        let keys = keys.filter(|parameter| parameter.absent.is_some() == amplitude);
        listed(keys.map(|parameter| parameter.key))
    };
    let place = match entry.places {
        [] => "machine".to_owned(),
        places => listed(places.iter().map(|choice| choice.key)),
    };
    format!(
        "| `{}` | {} | {} | {} | {place} | {} |\n",
        entry.name,
        entry.law(),
        keys(true),
        keys(false),
        entry.source(),
    )
}

fn listed<'a>(keys: impl Iterator<Item = &'a str>) -> String {
    let keys: Vec<String> = keys.map(|key| format!("`{key}`")).collect();
    match &keys[..] {
        [first, .., last] if keys.len() > LISTED => format!("{first} … {last} ({})", keys.len()),
        all => all.join(", "),
    }
}

/// Fails where the table called `name` in `page` is not `table`; with UPDATE=1 it is rewritten.
fn check(page: &str, name: &str, table: &str) {
    // Two tables of one page are rewritten one after the other.
    static PAGES: Mutex<()> = Mutex::new(());
    let _alone = PAGES.lock();
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .join(page);
    let text = fs::read_to_string(&path).unwrap();
    let start = format!("<!-- table: {name} -->\n");
    let (before, rest) = text.split_once(&start).unwrap();
    let (committed, after) = rest.split_once("<!-- end of table -->").unwrap();
    if std::env::var_os("UPDATE").is_some() {
        let updated = format!("{before}{start}{table}<!-- end of table -->{after}");
        fs::write(&path, updated).unwrap();
    } else {
        assert!(
            committed == table,
            "the table of {name} in {page} is stale; rewrite it with\n    \
             UPDATE=1 cargo test -p crosshead-input --test all tables"
        );
    }
}
