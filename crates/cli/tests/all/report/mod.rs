//! `crosshead report` on small datasets that are simulated here.

mod operating_points;
mod refusals;

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
    fn with_sweep(sweep: &str, format: Format) -> Self {
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
    let dataset = Dataset::with_sweep(GRID, Format::Parquet);
    let output = dataset.report(&[]);
    assert!(output.status.success());
    let html = dataset.html();
    stands_alone(&html);
    // An example of each of three classes; by clearance for two sets, across sets, two portraits; the features that say most.
    assert_eq!(html.matches("<figcaption>").count(), 3 + 2 + 1 + 2 + 1);
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
    let dataset = Dataset::with_sweep(GRID, Format::Parquet);
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
    let dataset = Dataset::with_sweep(CHAOS, Format::Parquet);
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
            assert!(
                read(&format!("figures/{name}")).starts_with("<svg"),
                "{name}"
            );
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
    let dataset = Dataset::with_sweep(RANDOM, Format::Parquet);
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
    // Two examples, the histograms, four scatters, a trend over the speed and a waterfall, the features that say most, and what
    // the baseline confuses.
    assert_eq!(html.matches("<figcaption>").count(), 2 + 1 + 4 + 2 + 2);
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
    let dataset = Dataset::with_sweep(GRID, Format::Mcap);
    assert!(dataset.report(&[]).status.success());
    let html = dataset.html();
    assert!(html.contains("The recordings of this dataset are MCAP files"));
    assert!(html.contains("The larger the clearance, the higher the amplitude"));
    // Features need no recordings.
    assert_eq!(html.matches("<figcaption>").count(), 1);
    // What is simulated again needs no recording.
    let chaos = fs::read_to_string(dataset.path().join("chaos.html")).unwrap();
    assert!(
        chaos.contains("Portraits of the crosshead")
            && chaos.contains("the format has to be parquet")
    );
}

#[test]
fn the_page_is_the_same_each_time_and_takes_the_place_of_the_last() {
    let dataset = Dataset::with_sweep(RANDOM, Format::Parquet);
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
    let dataset = Dataset::with_sweep(GRID, Format::Parquet);
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
