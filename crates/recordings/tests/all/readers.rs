//! Small datasets, written by this crate and read by the libraries that their users have.

use crate::venv;

use recordings::formats::mcap::{self, Channel, Recording};
use recordings::formats::parquet::TableWriter;
use recordings::{
    CaseWarning, Column, ColumnEntry, Counts, DatasetCard, FailedCase, FileEntry, FileRecord, Kind,
    Licence, Manifest, Schema, Subset, Value, WholeFile, croissant,
};
use serde_json::{Map, Value as Json, json};
use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

const SWEEP: &str = "seed: 7\nmachine: {}\n";

/// Name of each case, its split, its fault, and its samples.
const CASES: [(&str, &str, &str, usize); 5] = [
    ("case-0", "train", "none", 1000),
    ("case-1", "train", "big_end", 1003),
    ("case-2", "train", "throw1.big_end+guide", 0),
    ("case-3", "test", "none", 1000),
    ("case-4", "test", "big_end", 7),
];

#[test]
fn a_dataset_of_tables_opens_everywhere() {
    let mut dataset = Dataset::new();
    let signals = dataset.tables("signals", &signals_schema(), signals_row);
    let features = dataset.tables("features", &features_schema(), features_row);
    dataset.finish(vec![signals, features], None);
    dataset.read();
}

#[test]
fn a_dataset_of_mcap_files_opens_everywhere() {
    let mut dataset = Dataset::new();
    let features = dataset.tables("features", &features_schema(), features_row);
    for (case, (_, _, _, samples)) in CASES.iter().enumerate() {
        dataset.mcap(case, (*samples).max(2));
    }
    dataset.finish(vec![features], Some("mcap/case-0.mcap".into()));
    dataset.read();
}

/// A check that cannot fail checks nothing: every one of these changes must be found.
#[test]
fn a_difference_is_found() {
    let mut dataset = Dataset::new();
    let features = dataset.tables("features", &features_schema(), features_row);
    dataset.mcap(0, 100);
    dataset.finish(vec![features], Some("mcap/case-0.mcap".into()));
    let path = "features/test-00000-of-00001.parquet";
    let changes = [
        (
            vec!["tables", path, "rms_m_s2"],
            json!([1.5, 2.5]),
            "column rms_m_s2, row 0",
        ),
        (
            vec!["tables", path, "lyapunov_per_s"],
            json!([0.5, 0.5]),
            "column lyapunov_per_s, row 1",
        ),
        (vec!["units", "rms_m_s2"], json!("g"), "units"),
        (
            vec![
                "mcap",
                "mcap/case-0.mcap",
                "channels",
                "cylinder_pressure_pa",
            ],
            json!(vec![0.5; 100]),
            "column cylinder_pressure_pa",
        ),
        (
            vec!["mcap", "mcap/case-0.mcap", "labels", "fault"],
            json!("guide"),
            "labels",
        ),
    ];
    let mut told = Vec::new();
    for (place, value, message) in changes {
        let mut expected = dataset.expected.clone();
        let place = place.iter().fold(&mut expected, |json, key| &mut json[key]);
        *place = value;
        told.push((dataset.place(), expected, message));
    }
    let damaged = dataset.copy("damaged");
    let file = damaged.join(path);
    let mut bytes = fs::read(&file).unwrap();
    bytes[100] ^= 1;
    fs::write(&file, bytes).unwrap();
    told.push((damaged, dataset.expected.clone(), "sha256"));

    let read: Vec<_> = told
        .iter()
        .map(|(place, value, _)| (place.as_path(), value))
        .collect();
    let output = venv::output(&mut dataset.command(&read));
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let output = String::from_utf8(output.stderr).unwrap();
    let lines: Vec<&str> = output
        .lines()
        .filter(|line| line.starts_with("read_dataset.py: "))
        .collect();
    assert_eq!(lines.len(), told.len(), "{output}");
    for (line, (_, _, message)) in lines.iter().zip(&told) {
        assert!(line.contains(message), "{message}: {line}");
    }
}

/// A dataset under way, and what must be found in it.
struct Dataset {
    folder: tempfile::TempDir,
    files: Vec<FileEntry>,
    expected: Json,
}

impl Dataset {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        for name in ["signals", "features", "mcap"] {
            fs::create_dir_all(folder.path().join("dataset").join(name)).unwrap();
        }
        Self {
            folder,
            files: Vec::new(),
            expected: json!({"units": {}, "tables": {}, "mcap": {}}),
        }
    }

    /// Starts a file of the dataset.
    fn create(&self, path: &str) -> WholeFile {
        let folder = self.folder.path();
        WholeFile::create(
            &folder.join("next.part"),
            &folder.join("dataset").join(path),
        )
        .unwrap()
    }

    fn add(&mut self, path: &str, record: FileRecord, rows: Option<u64>) {
        self.files.push(FileEntry {
            path: path.to_owned(),
            bytes: record.bytes,
            sha256: record.sha256,
            rows,
        });
    }

    fn text(&mut self, path: &str, text: &str) {
        let mut file = self.create(path);
        file.write_all(text.as_bytes()).unwrap();
        self.add(path, file.commit().unwrap(), None);
    }

    /// The files of one subset; one of train, and the only one of validation, have no rows.
    fn tables(&mut self, subset: &str, schema: &Schema, row: fn(usize) -> Vec<Value>) -> Subset {
        let files = [
            ("train-00000-of-00003", 0..0),
            ("train-00001-of-00003", 0..2),
            ("train-00002-of-00003", 2..3),
            ("validation-00000-of-00001", 3..3),
            ("test-00000-of-00001", 3..5),
        ];
        for (name, cases) in files {
            let path = format!("{subset}/{name}.parquet");
            let mut columns: BTreeMap<&str, Vec<Json>> = BTreeMap::new();
            let mut table = TableWriter::new(self.create(&path), schema, 1).unwrap();
            for case in cases {
                let values = row(case);
                for (column, value) in schema.columns().iter().zip(&values) {
                    columns
                        .entry(&column.name)
                        .or_default()
                        .push(json_of(value));
                }
                table.write(values).unwrap();
            }
            let rows = table.rows();
            let record = table.finish().unwrap().commit().unwrap();
            self.add(&path, record, Some(rows));
            let in_order = schema.columns().iter().map(|column| {
                let values = columns.remove(column.name.as_str()).unwrap_or_default();
                (column.name.clone(), Json::from(values))
            });
            self.expected["tables"][path] = Json::Object(in_order.collect::<Map<_, _>>());
        }
        for column in schema.columns() {
            if let Some(unit) = &column.unit {
                self.expected["units"][&column.name] = json!(unit);
            }
        }
        Subset {
            name: subset.to_owned(),
            schema: schema.clone(),
        }
    }

    fn mcap(&mut self, case: usize, samples: usize) {
        let name = CASES[case].0;
        let path = format!("mcap/{name}.mcap");
        let columns = labels().into_iter().map(|column| column.name);
        let known = columns
            .zip(label_values(case))
            .filter(|(_, value)| *value != Value::Missing);
        let mut labels: BTreeMap<_, _> =
            known.map(|(name, value)| (name, text_of(&value))).collect();
        labels.insert("sample_rate_hz".into(), "24000".into());
        let (acceleration, pressure) = (noise(case, samples), noise(case + 7, samples));
        let recording = Recording {
            sample_rate_hz: 24_000.0,
            channels: &[
                Channel {
                    name: "throw1.acceleration_m_s2",
                    unit: "m/s^2",
                    samples: &acceleration,
                },
                Channel {
                    name: "cylinder_pressure_pa",
                    unit: "Pa",
                    samples: &pressure,
                },
            ],
            labels: &labels,
            sweep_yaml: SWEEP,
        };
        let file = mcap::write(self.create(&path), &recording).unwrap();
        self.add(&path, file.commit().unwrap(), None);
        self.expected["mcap"][path] = json!({
            "sample_rate_hz": 24_000.0,
            "labels": labels,
            "units": {"throw1_acceleration_m_s2": "m/s^2", "cylinder_pressure_pa": "Pa"},
            "channels": {"throw1_acceleration_m_s2": acceleration, "cylinder_pressure_pa": pressure},
        });
    }

    /// The files that say what the dataset is.
    fn finish(&mut self, subsets: Vec<Subset>, mcap_example: Option<String>) {
        let mut counts = Counts {
            cases: 6,
            failed: 1,
            ..Counts::default()
        };
        for split in ["train", "validation", "test"] {
            counts.rows.insert(split.into(), BTreeMap::new());
        }
        for (_, split, fault, _) in CASES {
            *counts
                .rows
                .entry(split.into())
                .or_default()
                .entry(fault.into())
                .or_default() += 1;
        }
        let columns = subsets
            .iter()
            .map(|subset| {
                (
                    subset.name.clone(),
                    ColumnEntry::from_schema(&subset.schema),
                )
            })
            .collect();
        let card = DatasetCard {
            title: "Compressor: \"small\"".into(),
            summary: "Five cases.".into(),
            licence: Some(Licence::CC0),
            uses: vec!["Training.".into()],
            limits: vec!["Simulated.".into()],
            tags: vec!["condition-monitoring".into(), "yes".into()],
            machine: vec![("crank radius".into(), "120 mm".into())],
            rows: counts.rows.clone(),
            subsets,
            unsplit: Vec::new(),
            mcap_example,
            command: "gen-dataset sweep.yaml".into(),
            version: "0.1.0".into(),
        };
        self.text("README.md", &card.to_string());
        self.text("croissant.json", &croissant(&card, &self.files).unwrap());
        self.text("sweep.yaml", SWEEP);
        self.files.sort_by(|a, b| a.path.cmp(&b.path));
        let manifest = Manifest {
            version: "0.1.0".into(),
            seed: u64::MAX,
            counts,
            columns,
            files: self.files.clone(),
            failed: vec![FailedCase {
                case_id: "case-5".into(),
                reason: "the step is too small at 0.25 s".into(),
                command: "crosshead simulate machine.yaml".into(),
                died: false,
            }],
            warnings: vec![CaseWarning {
                case_id: "case-6".into(),
                warning: "big_end: too deep".into(),
            }],
        };
        let root = self.folder.path().join("dataset");
        let path = root.join("manifest.json");
        fs::write(&path, manifest.to_json().unwrap()).unwrap();
        assert_eq!(Manifest::read(&path).unwrap(), manifest);
        // A dataset has the folders that it fills.
        for name in ["signals", "features", "mcap"] {
            let _ = fs::remove_dir(root.join(name));
        }
    }

    fn place(&self) -> PathBuf {
        self.folder.path().join("dataset")
    }

    /// The same files in another folder.
    fn copy(&self, name: &str) -> PathBuf {
        let copy = self.folder.path().join(name);
        let status = Command::new("cp")
            .arg("-r")
            .args([&self.place(), &copy])
            .status();
        assert!(status.unwrap().success());
        copy
    }

    /// The script on datasets, each with the values that it must have.
    fn command(&self, datasets: &[(&Path, &Json)]) -> Command {
        let mut command = Command::new(venv::python());
        command.arg(venv::readers().join("read_dataset.py"));
        command.args(datasets.iter().map(|(place, _)| place));
        command.arg("--expected");
        for (i, (_, expected)) in datasets.iter().enumerate() {
            let path = self.folder.path().join(format!("expected-{i}.json"));
            fs::write(&path, expected.to_string()).unwrap();
            command.arg(path);
        }
        command
    }

    fn read(&self) {
        venv::run(&mut self.command(&[(&self.place(), &self.expected)]));
    }
}

fn labels() -> Vec<Column> {
    vec![
        Column::new("case_id", Kind::Text, "name of the case"),
        Column::new("split", Kind::Text, "train, validation or test"),
        Column::new("fault", Kind::Text, "the worn joints"),
        Column::new("faulty_joints", Kind::Integer, "how many joints are worn"),
        Column::new("clearance_big_end_m", Kind::Real, "radial | measured").unit("m"),
        Column::new("lyapunov_true_per_s", Kind::Real, "from the equations")
            .unit("1/s")
            .optional(),
    ]
}

fn label_values(case: usize) -> Vec<Value> {
    let (name, split, fault, _) = CASES[case];
    let lyapunov = (case != 1).then_some(-0.1 * case as f64);
    let faults = fault.split('+').filter(|fault| *fault != "none").count() as i64;
    vec![
        name.into(),
        split.into(),
        fault.into(),
        faults.into(),
        (1e-4 / 3.0).into(),
        lyapunov.into(),
    ]
}

fn signals_schema() -> Schema {
    let mut columns = labels();
    columns.push(Column::new("sample_rate_hz", Kind::Real, "samples per second").unit("Hz"));
    columns.push(
        Column::new(
            "throw1.acceleration_m_s2",
            Kind::Samples,
            "of the crosshead",
        )
        .unit("m/s^2"),
    );
    columns.push(
        Column::new("cylinder_pressure_pa", Kind::Samples, "absolute")
            .unit("Pa")
            .optional(),
    );
    let metadata = BTreeMap::from([("note".to_owned(), "Überdruck, 2 × p₀".to_owned())]);
    Schema::new(columns).unwrap().with_metadata(metadata)
}

fn signals_row(case: usize) -> Vec<Value> {
    let samples = CASES[case].3;
    let pressure = (!case.is_multiple_of(3)).then(|| noise(case + 7, samples));
    let mut row = label_values(case);
    row.extend([
        24_000.0.into(),
        noise(case, samples).into(),
        pressure.into(),
    ]);
    row
}

fn features_schema() -> Schema {
    let mut columns = labels();
    columns.push(Column::new("rms_m_s2", Kind::Real, "root mean square").unit("m/s^2"));
    columns.push(
        Column::new("lyapunov_per_s", Kind::Real, "largest exponent")
            .unit("1/s")
            .optional(),
    );
    columns.push(Column::new("lyapunov_reason", Kind::Text, "why there is none").optional());
    columns.push(Column::new(
        "settled",
        Kind::Flag,
        "whether the transient died away",
    ));
    Schema::new(columns).unwrap()
}

fn features_row(case: usize) -> Vec<Value> {
    let exponent = (case % 2 == 1).then_some(0.5);
    let reason = exponent
        .is_none()
        .then(|| "no scaling region: ε too small".to_owned());
    let mut row = label_values(case);
    row.extend([
        (case as f64).sqrt().into(),
        exponent.into(),
        reason.into(),
        (case != 2).into(),
    ]);
    row
}

/// Numbers of all sizes, with the odd ones first: negative zero, the smallest and the largest.
fn noise(seed: usize, samples: usize) -> Vec<f32> {
    let mut state = seed as u32;
    let odd = [-0.0, f32::from_bits(1), f32::MAX, f32::MIN_POSITIVE];
    let random = std::iter::repeat_with(|| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f32::from_bits(state & 0xbfff_ffff)
    });
    odd.into_iter().chain(random).take(samples).collect()
}

fn json_of(value: &Value) -> Json {
    match value {
        Value::Text(text) => json!(text),
        Value::Integer(integer) => json!(integer),
        Value::Real(real) => json!(real),
        Value::Flag(flag) => json!(flag),
        Value::Samples(samples) => json!(samples),
        Value::Missing => Json::Null,
    }
}

/// A label as text.
fn text_of(value: &Value) -> String {
    match json_of(value) {
        Json::String(text) => text,
        other => other.to_string(),
    }
}
