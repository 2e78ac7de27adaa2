//! Features of files: what bundles say of them, and what looks wrong.

use features::recorded::{CrankReference, Row, Said, Table, WindowLength, inputs, row};
use recordings::Value;
use recordings::measured::Options;
use std::path::Path;

fn said() -> Said {
    Said {
        options: Options::default(),
        speed_rpm: None,
        unit: None,
        crank: CrankReference::default(),
        machine: None,
        allow_outside: false,
        motion: false,
    }
}

/// The names of the columns and the first row.
fn first_row(path: &Path) -> (Vec<String>, Row) {
    let said = said();
    let inputs = inputs(&[path.to_owned()], &said).unwrap();
    let table = Table::new(&inputs, &said).unwrap();
    let names = table.schema().columns().iter();
    let names = names.map(|column| column.name.clone()).collect();
    let mut jobs = table.windows(WindowLength::parse("10 revolutions").unwrap());
    (names, row(&jobs.next().unwrap().unwrap()))
}

fn number(names: &[String], row: &Row, column: &str) -> f64 {
    let place = names.iter().position(|name| name == column).unwrap();
    match row.values[place] {
        Value::Real(number) => number,
        ref other => panic!("{column}: {other:?}, {:?}", row.warning()),
    }
}

fn shipped() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/recordings/example-single-stage")
}

#[test]
fn the_machine_of_a_bundle_gives_the_indicated_power() {
    let (names, row) = first_row(&shipped());
    let power = number(&names, &row, "cylinder_pressure.indicated_power_w");
    assert!((1000.0..3000.0).contains(&power), "{power}");
}

#[test]
fn a_machine_of_a_bundle_that_is_not_used_says_why() {
    let folder = tempfile::tempdir().unwrap();
    let bundle = std::fs::read_to_string(shipped().join("recordings.yaml")).unwrap();
    let bundle = bundle.replace("  rod_length_m: 0.6\n", "");
    std::fs::write(folder.path().join("recordings.yaml"), bundle).unwrap();
    for file in std::fs::read_dir(shipped()).unwrap() {
        let file = file.unwrap().path();
        if file.extension().is_some_and(|ending| ending == "parquet") {
            let name = file.file_name().unwrap().to_owned();
            std::fs::copy(file, folder.path().join(name)).unwrap();
        }
    }
    let warning = first_row(folder.path()).1.warning().unwrap();
    assert!(
        warning.contains("the bundle's machine is not used") && warning.contains("rod_length_m"),
        "{warning}"
    );
}

/// A file of one channel over the time.
fn csv(folder: &Path, samples: usize, cell: impl Fn(usize) -> String) -> std::path::PathBuf {
    let path = folder.join("a.csv");
    let lines = (0..samples).map(|i| format!("{:.4},{},1\n", i as f64 / 1000.0, cell(i)));
    let text = format!("time [s],acc [m/s^2],u [V]\n{}", lines.collect::<String>());
    std::fs::write(&path, text).unwrap();
    path
}

/// The warning of the only window of a file of so many samples.
fn warned(samples: usize, cell: fn(usize) -> String) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = csv(folder.path(), samples, cell);
    let said = said();
    let inputs = inputs(&[path], &said).unwrap();
    let table = Table::new(&inputs, &said).unwrap();
    let mut jobs = table.windows(WindowLength::Default);
    row(&jobs.next().unwrap().unwrap()).warning().unwrap()
}

#[test]
fn a_channel_without_features_is_warned_of() {
    let few = warned(50, |i| (i % 7).to_string());
    assert!(few.contains("acc: no features, 50 samples"), "{few}");
    let none = warned(500, |_| "NaN".to_owned());
    assert!(
        none.contains("acc: no features, 500 of 500 samples are no numbers"),
        "{none}"
    );
}

#[test]
fn a_crank_angle_that_counts_on_keeps_its_accuracy() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    let line = |i: u32| {
        let angle = 3.6e7 + 2.7 * f64::from(i);
        let acc = (3.0 * angle.to_radians()).sin();
        format!("{:.4},{angle:.4},{acc:.6}\n", f64::from(i) / 1000.0)
    };
    let lines: String = (0..2000).map(line).collect();
    let heading = "time [s],crank_angle_deg,acc [m/s^2]\n";
    std::fs::write(&path, format!("{heading}{lines}")).unwrap();
    let (names, row) = first_row(&path);
    assert_eq!(row.warning(), None);
    let order = number(&names, &row, "acc.order_03_m_s2");
    assert!((order - 1.0).abs() < 1e-4, "{order}");
    let residual = number(&names, &row, "acc.residual_rms_m_s2");
    assert!(residual < 1e-4, "{residual}");
}

#[test]
fn what_float32_rounds_off_or_cannot_hold_is_warned_of() {
    let offset = warned(500, |i| format!("{}", 1e6 + (i as f64 * 0.1).sin()));
    let expected = "acc: its values vary by 2.000e0, of which float32 rounds off";
    assert!(
        offset.contains(expected) && !offset.contains("clipped"),
        "{offset}"
    );
    let huge = warned(500, |i| format!("{}e40", 1 + i % 3));
    assert!(
        huge.contains("500 of 500 samples are no numbers up to 3.4e38"),
        "{huge}"
    );
}
