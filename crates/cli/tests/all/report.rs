//! `crosshead report` on small datasets that are simulated here.

use report::chaos_page::ChaosPage;
use report::dataset_page::{DatasetPage, Design};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::atomic::AtomicBool;
use sweep::dataset::{Existing, Options, generate};
use sweep::sweep_file::Format;
use sweep::{Plan, simulate_cases};
use tempfile::TempDir;

/// Two sets of joints at two clearances, and the ideal machine.
const GRID: &str = "
study: paper2
run: {revolutions: 3, transient: 1, tolerance: 1e-7, chaos: false}
splits: {train: 100 %}
cases:
  - grid:
      joints: [[], [big_end], [big_end, small_end]]
      clearance: [0.1 mm, 0.3 mm]
      speed: [500 rpm]
";

/// Eight cases, two windows each.
const RANDOM: &str = "
run: {revolutions: 4, transient: 1, tolerance: 1e-7, chaos: false}
windows: {count: 2, revolutions: 2}
splits: {train: 50 %, test: 50 %}
cases:
  - random:
      count: 8
      axes:
        joints: [[], [big_end]]
        clearance: {uniform: [0.1 mm, 0.3 mm]}
        speed: {uniform: [450 rpm, 550 rpm]}
vary:
  crosshead.mass: {lognormal: {factor: 1.02}}
";

/// Two clearances with exponents from the equations, and a bifurcation diagram.
const CHAOS: &str = "
run: {revolutions: 4, transient: 2, tolerance: 1e-7, lyapunov: {revolutions: 20, transient: 5}}
splits: {train: 100 %}
cases:
  - grid:
      joints: [[big_end], [small_end]]
      clearance: [0.02 mm, 0.3 mm]
      speed: [500 rpm]
bifurcations:
  - name: small-end
    path: clearance
    joints: [small_end]
    from: 0.1 mm
    to: 0.3 mm
    steps: 3
    transient: 2
    revolutions: 3
";

/// A dataset in a folder that goes with it.
struct Dataset {
    folder: TempDir,
}

impl Dataset {
    fn of(sweep: &str, format: Format) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let machine = single_stage();
        let text = format!(
            "name: small\nmachine: {}\nseed: 5{sweep}",
            machine.display()
        );
        fs::write(folder.path().join("small.yaml"), text).unwrap();
        let dataset = Self { folder };
        dataset.generate(format, Existing::Refuse);
        dataset
    }

    /// Simulates the sweep of the folder.
    fn generate(&self, format: Format, existing: Existing) {
        let plan = Plan::read(&self.folder.path().join("small.yaml")).unwrap();
        let options = Options {
            existing,
            threads: 2,
            cancel: &AtomicBool::new(false),
            retry_failed: false,
            trial: None,
        };
        let plan = plan.with_format(format).unwrap();
        generate(&plan, &self.path(), &options, &simulate_cases, &mut ()).unwrap();
    }

    fn path(&self) -> PathBuf {
        self.folder.path().join("dataset")
    }

    fn report(&self, more: &[&str]) -> Output {
        report(&self.path(), more)
    }

    fn read(&self) -> sweep::reader::Dataset {
        sweep::reader::Dataset::read(&self.path()).unwrap()
    }

    fn page(&self) -> DatasetPage {
        DatasetPage::from_dataset(&self.read()).unwrap()
    }

    fn html(&self) -> String {
        fs::read_to_string(self.path().join("report.html")).unwrap()
    }

    /// Status and message of the verb, the folder of the test being `T`.
    fn refusal(&self, more: &[&str]) -> (i32, String) {
        refusal(self.folder.path(), &self.report(more))
    }
}

fn single_stage() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines/single-stage.yaml")
}

fn report(folder: &Path, more: &[&str]) -> Output {
    let verb = Command::new(env!("CARGO_BIN_EXE_crosshead"))
        .arg("report")
        .arg(folder)
        .args(more)
        .output();
    verb.unwrap()
}

fn refusal(root: &Path, output: &Output) -> (i32, String) {
    let message = String::from_utf8(output.stderr.clone()).unwrap();
    assert!(output.stdout.is_empty());
    (
        output.status.code().unwrap(),
        message
            .replace(root.to_str().unwrap(), "T")
            .trim()
            .to_owned(),
    )
}

fn stands_alone(html: &str) {
    assert!(html.len() < 5_000_000, "{} bytes", html.len());
    // The script comes last, after the data for it.
    let (content, script) = html.rsplit_once("<script>").unwrap();
    assert!(!script.contains("import(") && !script.contains("src="));
    let places = content.replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
    for outside in ["http:", "https:", "src=", "url(", "<link", "<img"] {
        assert!(!places.contains(outside), "{outside}");
    }
}

#[test]
fn a_grid_is_compared_and_its_claims_are_printed() {
    let dataset = Dataset::of(GRID, Format::Parquet);
    let output = dataset.report(&[]);
    assert!(output.status.success());
    let html = dataset.html();
    stands_alone(&html);
    // An example of each of three classes; by clearance for two sets, across sets, two portraits.
    assert_eq!(html.matches("<figcaption>").count(), 3 + 2 + 1 + 2);
    for said in [
        "<h3>Healthy</h3>",
        "<h3>Clearance in big end + small end</h3>",
        "<h3>Sets of joints at 0.3\u{a0}mm</h3>",
        "500\u{a0}rpm, discharge pressure 393\u{a0}kPa",
        "case-000000 in signals/train-00000-of-00001.parquet",
        "3\u{a0}revolutions, 3600\u{a0}samples",
    ] {
        assert!(html.contains(said), "{said}");
    }
    let printed = String::from_utf8(output.stdout).unwrap();
    let lines: Vec<&str> = printed.lines().collect();
    assert!(lines[0].ends_with("report.html"));
    // The table of the five cases, then that of the seven claims.
    assert_eq!(lines.len(), 1 + 1 + (2 + 5) + 1 + (2 + 7));
    assert!(
        lines[6].starts_with("| big end | 0.3 mm | "),
        "{}",
        lines[6]
    );
    assert!(lines[12].starts_with("| The larger the clearance, the higher the amplitude | holds"));
}

/// The levels of the page are those of the samples themselves.
#[test]
fn levels_are_those_of_the_recordings() {
    let dataset = Dataset::of(GRID, Format::Parquet);
    let page = dataset.page();
    let Design::Grid(grids) = &page.design else {
        panic!("a grid")
    };
    let [grid] = grids.grids.as_slice() else {
        panic!("one operating point, one sensor")
    };
    assert_eq!(grid.levels.len(), 5);
    let ideal = grid.ideal.as_ref().unwrap();
    let responses = grid.joint_sets.iter().flat_map(|set| &set.responses);
    let responses = std::iter::once(ideal).chain(responses.map(|(_, response)| response));
    for (level, response) in grid.levels.iter().zip(responses) {
        let samples = &response.acceleration_m_s2;
        let count = samples.len() as f64;
        let rms = (samples.iter().map(|a| a * a).sum::<f64>() / count).sqrt();
        let peak = samples.iter().fold(0.0_f64, |peak, a| peak.max(a.abs()));
        assert!((level.rms.value / rms - 1.0).abs() < 1e-9);
        assert!((level.peak.value / peak - 1.0).abs() < 1e-9);
        assert!(level.high_rms.value < level.rms.value && level.high_share < 0.5);
        // Three revolutions of a motion that repeats itself: the noise, 1 % of the rms.
        assert!(level.peak.spread > 0.0 && level.peak.spread < 0.05 * peak);
    }
    // v = −r ω (sin θ + λ/2 sin 2θ) of the ideal machine, but for terms in λ³ = 1/125.
    let speed = 500.0 * std::f64::consts::PI / 30.0;
    for (angle, velocity) in ideal.crank_angle_rad.iter().zip(&ideal.velocity_m_s) {
        let nominal = -0.12 * speed * (angle.sin() + 0.1 * (2.0 * angle).sin());
        assert!(
            (velocity - nominal).abs() < 0.05,
            "{angle}: {velocity}, {nominal}"
        );
    }
}

/// The pages beside the first, their figures as files, and the numbers of the dataset on them.
#[test]
fn chaos_and_features_have_pages_of_their_own() {
    let dataset = Dataset::of(CHAOS, Format::Parquet);
    fs::create_dir(dataset.path().join("figures")).unwrap();
    for name in ["chaos-99-gone.svg", "mine.svg"] {
        fs::write(dataset.path().join("figures").join(name), "").unwrap();
    }
    assert!(dataset.report(&[]).status.success());
    let read = |name: &str| fs::read_to_string(dataset.path().join(name)).unwrap();
    let chaos = read("chaos.html");
    stands_alone(&chaos);
    let pages = [chaos.clone(), read("report.html")];
    let mut figures: Vec<String> = Vec::new();
    for entry in fs::read_dir(dataset.path().join("figures")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if name != "mine.svg" {
            let page = &pages[usize::from(name.starts_with("dataset-"))];
            assert!(page.contains(&read(&format!("figures/{name}"))), "{name}");
            assert!(page.contains(&format!("figures/{name}\"")));
            figures.push(name);
        }
    }
    let all: usize = pages
        .iter()
        .map(|page| page.matches("<figcaption>").count())
        .sum();
    assert_eq!(figures.len(), all);

    // The page's numbers are those of the table.
    let table = dataset.path().join("features/train-00000-of-00001.parquet");
    let table = recordings::formats::parquet::read_table(&table).unwrap();
    let column = |name: &str| table.values::<f64>(name).unwrap().to_vec();
    let (exponents, errors) = (
        column("lyapunov_true_per_s"),
        column("lyapunov_true_standard_error_per_s"),
    );
    let page = ChaosPage::from_dataset(&dataset.read()).unwrap();
    assert_eq!(page.cases.len(), 4);
    for (i, case) in page.cases.iter().enumerate() {
        assert_eq!(
            case.exponent,
            Some([exponents[i].unwrap(), errors[i].unwrap()])
        );
        assert_eq!(case.clearance_m, [2e-5, 3e-4][i % 2]);
        assert!(case.regime.is_some());
        // Four revolutions are too few for an exponent from the signal: the table says why.
        assert!(!case.windows[0].reason.is_empty());
        assert_eq!(case.joints, ["big_end", "small_end"][i / 2]);
    }
    // Rows are joints and columns clearances, the one that counts as healthy too.
    let titles = page.motions.iter().map(|row| {
        let motions = row.motions.iter().flatten();
        (
            row.heading.as_str(),
            motions.map(|m| m.title.as_str()).collect::<Vec<_>>(),
        )
    });
    let clearances = vec!["0.02\u{a0}mm", "0.3\u{a0}mm"];
    assert_eq!(
        titles.collect::<Vec<_>>(),
        [("Big end", clearances.clone()), ("Small end", clearances)]
    );
    for motion in page.motions.iter().flat_map(|row| &row.motions).flatten() {
        assert_eq!(motion.strobe.len(), 4);
        assert_eq!(motion.joints.len(), 1);
        // The journal has nowhere else to go.
        let orbit = &motion.joints[0];
        let offsets = orbit.x_m.iter().zip(&orbit.y_m).map(|(x, y)| x.hypot(*y));
        let furthest = offsets.fold(0.0, f64::max);
        assert!(furthest > orbit.clearance_m && furthest < orbit.clearance_m + 1e-4);
    }
    let quantity = &page.bifurcations[0].quantities[0];
    assert_eq!((quantity.up.len(), quantity.down.len()), (9, 9));
    let last = quantity.up[8];
    assert!(
        (last[0] - 3e-4).abs() < 1e-12 && last[1] > 300.0,
        "{last:?}"
    );

    let features = read("features.html");
    stands_alone(&features);
    for said in ["order_01 … order_20", "lyapunov_true_per_s", "√(Σx²/n)"] {
        assert!(features.contains(said), "{said}");
    }
}

#[test]
fn random_cases_have_distributions() {
    let dataset = Dataset::of(RANDOM, Format::Parquet);
    let out = dataset.folder.path().join("page.html");
    let output = dataset.report(&["--out", out.to_str().unwrap()]);
    assert_eq!(
        String::from_utf8(output.stdout).unwrap(),
        format!("{}\n", out.display())
    );
    assert!(!dataset.path().join("report.html").exists());
    let html = fs::read_to_string(out).unwrap();
    stands_alone(&html);
    for said in [
        "clearance of big end (mm)",
        "crosshead mass (kg)",
        "<h3>Kurtosis against largest clearance</h3>",
        "against largest clearance for 16\u{a0}windows",
        "No clearance, ",
        "trained on 8 windows of the split for training and tested on 8",
    ] {
        assert!(html.contains(said), "{said}");
    }
    // Two examples, the histograms, four scatters, a trend over the speed and a waterfall.
    assert_eq!(html.matches("<figcaption>").count(), 2 + 1 + 4 + 2);
    assert!(html.contains("<h3>Waterfall over the speed, healthy</h3>"));
    let page = dataset.page();
    let counts = page
        .faults
        .iter()
        .map(|count| (count.fault.as_str(), count.windows));
    assert_eq!(counts.collect::<Vec<_>>(), [("none", 8), ("big_end", 8)]);
}

#[test]
fn a_dataset_of_mcap_files_has_a_page_without_recordings() {
    let dataset = Dataset::of(GRID, Format::Mcap);
    assert!(dataset.report(&[]).status.success());
    let html = dataset.html();
    assert!(html.contains("The recordings of this dataset are MCAP files"));
    assert!(html.contains("The larger the clearance, the higher the amplitude"));
    assert_eq!(html.matches("<figcaption>").count(), 0);
    // What is simulated again needs no recording.
    let chaos = fs::read_to_string(dataset.path().join("chaos.html")).unwrap();
    assert!(
        chaos.contains("Portraits of the crosshead")
            && chaos.contains("the format has to be parquet")
    );
}

#[test]
fn the_page_is_the_same_each_time_and_takes_the_place_of_the_last() {
    let dataset = Dataset::of(RANDOM, Format::Parquet);
    fs::write(dataset.path().join("report.html"), "the last").unwrap();
    assert!(dataset.report(&[]).status.success());
    let first = dataset.html();
    assert!(dataset.report(&[]).status.success());
    assert_eq!(dataset.html(), first);
    assert!(!dataset.path().join("report.part").exists());
}

/// A page of cases that are no longer there would mislead.
#[test]
fn a_dataset_that_replaces_another_takes_its_page_away() {
    let dataset = Dataset::of(GRID, Format::Parquet);
    assert!(dataset.report(&[]).status.success());
    let mine = dataset.path().join("figures/mine.svg");
    fs::write(&mine, "").unwrap();
    dataset.generate(Format::Parquet, Existing::Overwrite);
    for page in ["report.html", "chaos.html", "features.html"] {
        assert!(!dataset.path().join(page).exists(), "{page}");
    }
    let figures = fs::read_dir(dataset.path().join("figures")).unwrap();
    assert!(mine.exists() && figures.count() == 1);
}

/// The machine of the tests with other throws and sensors, and a sweep of it.
fn with_sensors(throws: &str, sensors: &str, sweep: &str) -> Dataset {
    let folder = tempfile::tempdir().unwrap();
    let machine = fs::read_to_string(single_stage()).unwrap();
    let (head, _) = machine.split_once("\nsensors:").unwrap();
    let head = head.replace("\njoints:", &format!("\n{throws}\njoints:"));
    let sensors = format!("\nsensors:\n{sensors}");
    fs::write(folder.path().join("machine.yaml"), head + &sensors).unwrap();
    let text = format!("name: small\nmachine: machine.yaml\nseed: 5{sweep}");
    fs::write(folder.path().join("small.yaml"), text).unwrap();
    let dataset = Dataset { folder };
    dataset.generate(Format::Parquet, Existing::Refuse);
    dataset
}

/// Faults of either throw, each judged by the sensor of its own; at the other throw's there is
/// nothing to see of them.
#[test]
fn a_fault_is_judged_by_the_sensor_of_its_own_throw() {
    let sweep = GRID.replace("study: paper2\n", "").replace(
        "joints: [[], [big_end], [big_end, small_end]]",
        "joints: [[], [front.small_end], [rear.small_end], [front.small_end, rear.small_end]]",
    );
    let throws = "throws: [{name: front}, {name: rear}]";
    let sensors = "
  - {measure: crosshead_acceleration, throw: front}
  - {measure: crosshead_acceleration, throw: rear}
";
    let dataset = with_sensors(throws, sensors, &sweep);
    let output = dataset.report(&[]);
    assert!(output.status.success());
    let html = dataset.html();
    stands_alone(&html);
    assert!(html.contains("front: front.crosshead_acceleration_m_s2; rear: rear.crosshead_"));
    assert!(html.contains("No sensor reads the crank angle"));
    let page = dataset.page();
    let Design::Grid(grids) = &page.design else {
        panic!("a grid")
    };
    let sensors: Vec<&str> = grids.grids.iter().map(|g| g.sensor.as_str()).collect();
    assert_eq!(
        sensors,
        [
            "front.crosshead acceleration",
            "rear.crosshead acceleration"
        ]
    );
    for (grid, own) in grids
        .grids
        .iter()
        .zip(["front.small_end", "rear.small_end"])
    {
        let sets: Vec<&str> = grid
            .joint_sets
            .iter()
            .map(|set| set.joints.as_str())
            .collect();
        assert_eq!(sets, [own, "front.small_end+rear.small_end"]);
        // Speed given, the throws are alike and do not know of one another: a fault of this throw is
        // as large as the fault of both, and larger than none.
        let peak = |at: usize| grid.levels[at].peak;
        assert_eq!(grid.levels[0].joints, "none");
        assert!(peak(2).value > 1.2 * peak(0).value, "{:?}", grid.levels);
        assert!(peak(2).against(peak(4)).is_eq());
    }
    // Features by class: two rows of the healthy, one of each fault of one throw.
    let rows = page
        .feature_rows
        .iter()
        .map(|row| (row.fault.as_str(), row.sensor.as_str()));
    let (front, rear) = (
        "front.crosshead_acceleration",
        "rear.crosshead_acceleration",
    );
    let both = "front.small_end+rear.small_end";
    assert_eq!(
        rows.collect::<Vec<_>>(),
        [
            ("none", front),
            ("none", rear),
            ("front.small_end", front),
            ("rear.small_end", rear),
            (both, front),
            (both, rear)
        ]
    );
    // Of a machine that repeats no study nothing is claimed.
    assert!(
        !html.contains("study") && !String::from_utf8(output.stdout).unwrap().contains("claim")
    );
}

#[test]
fn a_machine_with_a_frame_sensor_alone_has_figures() {
    let sensors = "
  - {measure: frame_acceleration, axis: x}
  - {measure: crank_angle}
";
    let dataset = with_sensors("", sensors, GRID);
    assert!(dataset.report(&[]).status.success());
    let html = dataset.html();
    assert!(html.contains("Figures show the channel frame_acceleration_x_m_s2"));
    assert_eq!(html.matches("<figcaption>").count(), 3 + 2 + 1 + 2);
    let chaos = fs::read_to_string(dataset.path().join("chaos.html")).unwrap();
    assert!(!chaos.contains("There are no recordings in tables"));
}

/// Two speeds: both are on the page, and what they differ in stands above them.
#[test]
fn every_operating_point_is_on_the_page() {
    let sweep = GRID.replace("[500 rpm]", "[500 rpm, 400 rpm]");
    let dataset = Dataset::of(&sweep, Format::Parquet);
    let output = dataset.report(&[]);
    assert!(output.status.success());
    let html = dataset.html();
    stands_alone(&html);
    for speed in ["500", "400"] {
        assert!(
            html.contains(&format!("<h2>Responses: {speed}\u{a0}rpm, discharge")),
            "{speed}"
        );
        assert!(
            html.contains(&format!("<summary>{speed}\u{a0}rpm, discharge")),
            "{speed}"
        );
    }
    // And what goes with the speed.
    assert_eq!(
        html.matches("<figcaption>").count(),
        3 + 2 * (2 + 1 + 2) + 2
    );
    // The claims have a row for each.
    let printed = String::from_utf8(output.stdout).unwrap();
    assert!(printed.contains("| 400 rpm | holds"), "{printed}");
}

/// A key of the joints is that of every joint that the sweep names, a stiffness by its formula too.
#[test]
fn settings_of_the_contacts_are_operating_points() {
    let sweep = GRID.replace(
        "speed: [500 rpm]",
        "contact.damping: [2e3 N s/m, 2e4 N s/m]
      contact.stiffness:
        - 24 GN/m^1.5
        - {from: eq5, youngs_modulus: 207 GPa, poisson_ratio: 0.3}",
    );
    let dataset = Dataset::of(&sweep, Format::Parquet);
    let page = dataset.page();
    let Design::Grid(grids) = &page.design else {
        panic!("a grid")
    };
    let settings: Vec<Vec<&str>> = grids
        .grids
        .iter()
        .map(|grid| {
            grid.settings
                .iter()
                .map(|(_, value)| value.as_str())
                .collect()
        })
        .collect();
    let formula = "from eq5, youngs modulus 207 GPa, poisson ratio 0.3";
    let (light, stiff) = ("2000\u{a0}N s/m", "24 GN/m^1.5");
    assert_eq!(settings[..2], [[light, stiff], [light, formula]]);
    assert_eq!(settings.len(), 4);
    assert_eq!(
        grids.grids[0].settings[0].0,
        "contact damping (big end, small end)"
    );
    for grid in &grids.grids {
        assert_eq!(grid.levels.len(), 5);
    }
}

#[test]
fn what_is_no_dataset_is_refused() {
    let root = tempfile::tempdir().unwrap();
    let said = |folder: &str| refusal(root.path(), &report(&root.path().join(folder), &[]));
    assert_eq!(said("gone"), (2, "error: T/gone: no such folder".into()));
    fs::create_dir_all(root.path().join("half/_sweep")).unwrap();
    assert_eq!(
        said("half"),
        (
            2,
            "error: T/half: the dataset is not finished (no manifest.json): gen-dataset SWEEP.yaml --out T/half --resume \
             finishes it"
                .into()
        )
    );
    fs::create_dir(root.path().join("other")).unwrap();
    assert_eq!(
        said("other"),
        (2, "error: T/other: no dataset (no manifest.json)".into())
    );
    fs::write(root.path().join("other/manifest.json"), "{").unwrap();
    assert_eq!(
        said("other"),
        (
            2,
            "error: cannot read `T/other/manifest.json` as a manifest: EOF while parsing an object at line 1 column 1"
                .into()
        )
    );
}

#[test]
fn a_damaged_dataset_is_refused_and_the_last_page_left() {
    let dataset = Dataset::of(RANDOM, Format::Parquet);
    fs::write(dataset.path().join("report.html"), "the last").unwrap();
    let signals = dataset.path().join("signals/train-00000-of-00001.parquet");
    let features = dataset.path().join("features/train-00000-of-00001.parquet");
    let whole = fs::read(&features).unwrap();

    fs::write(&features, &whole[..whole.len() / 2]).unwrap();
    let (status, message) = dataset.refusal(&[]);
    assert_eq!(status, 2);
    assert_eq!(
        message,
        format!(
            "error: T/dataset/features/train-00000-of-00001.parquet has {} bytes instead of {}: `crosshead verify` names all such files",
            whole.len() / 2,
            whole.len()
        )
    );

    fs::write(&features, vec![0; whole.len()]).unwrap();
    let (status, message) = dataset.refusal(&[]);
    assert_eq!(status, 2);
    assert_eq!(
        message,
        "error: T/dataset/features/train-00000-of-00001.parquet has another checksum than when it was written: `crosshead verify` names all such files"
    );

    fs::remove_file(&features).unwrap();
    let (status, message) = dataset.refusal(&[]);
    assert_eq!(status, 2);
    assert_eq!(
        message,
        "error: T/dataset/features/train-00000-of-00001.parquet is missing: `crosshead verify` names all such files"
    );

    fs::write(&features, &whole).unwrap();
    fs::remove_file(&signals).unwrap();
    let (status, message) = dataset.refusal(&[]);
    assert_eq!(status, 2);
    assert!(
        message.contains("signals/train-00000-of-00001.parquet"),
        "{message}"
    );

    fs::remove_file(dataset.path().join("sweep.yaml")).unwrap();
    let (status, message) = dataset.refusal(&[]);
    assert_eq!(status, 2);
    assert!(message.contains("T/dataset/sweep.yaml"), "{message}");
    assert_eq!(dataset.html(), "the last");
}

/// The table of another sweep, with the manifest to match, lacks a column that this one has.
#[test]
fn a_missing_column_is_named() {
    let (random, grid) = (
        Dataset::of(RANDOM, Format::Parquet),
        Dataset::of(GRID, Format::Parquet),
    );
    for file in ["manifest.json", "features/train-00000-of-00001.parquet"] {
        fs::copy(grid.path().join(file), random.path().join(file)).unwrap();
    }
    assert_eq!(
        random.refusal(&[]),
        (
            2,
            "error: T/dataset/features/train-00000-of-00001.parquet: no column `crosshead.mass_kg`, which every dataset of \
             this sweep has"
                .into()
        )
    );
}

#[test]
fn a_page_that_cannot_be_written_is_failed_work() {
    let dataset = Dataset::of(RANDOM, Format::Parquet);
    let out = dataset.folder.path().join("gone/page.html");
    let (status, message) = dataset.refusal(&["--out", out.to_str().unwrap()]);
    assert_eq!(status, 1);
    assert!(message.starts_with("error: T/gone/figures: "), "{message}");
}
