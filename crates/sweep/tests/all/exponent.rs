//! The exponent from the equations as a column of a real dataset.

use input::yaml::Document;
use recordings::formats::parquet::read_table;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use sweep::{Existing, Options, Plan, generate, simulate_cases};

const SWEEP: &str = "
name: exponents
machine: MACHINE
run: {revolutions: 1, transient: 1, tolerance: 1e-7, lyapunov: {revolutions: 20, transient: 10, spectrum: true, convergence: true}}
splits: {train: 100 %}
cases:
  - grid: {joints: [[], [big_end, small_end]], clearance: [0.1 mm]}
";

#[test]
fn a_sweep_that_asks_for_exponents_has_them() {
    let machine = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../data/machines/single-stage.yaml"
    );
    let text = SWEEP.replace("MACHINE", machine);
    let document = Document::parse(&text, "sweep.yaml").unwrap();
    let plan = Plan::new(&document, Path::new("")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let options = Options {
        existing: Existing::Refuse,
        threads: 2,
        cancel: &AtomicBool::new(false),
        retry_failed: false,
        trial: None,
    };
    generate(&plan, folder.path(), &options, &simulate_cases, &mut ()).unwrap();
    for name in ["signals", "features"] {
        let path = folder
            .path()
            .join(format!("{name}/train-00000-of-00001.parquet"));
        let table = read_table(&path).unwrap();
        let exponents: &[Option<f64>] = table.values("lyapunov_true_per_s").unwrap();
        // The ideal machine cannot be perturbed; both ends at 0.1 mm contract by 7.234 a
        // revolution of 0.12 s (the independent reference).
        assert_eq!(exponents[0], None);
        let worn = exponents[1].unwrap();
        assert!((worn * 0.12 / -7.2342 - 1.0).abs() < 1e-3, "{worn}");
        let each = table.values::<f64>("lyapunov_true_per_revolution").unwrap();
        assert!((each[1].unwrap() - worn * 0.12).abs() < 1e-12);

        let regimes = table.values::<String>("regime_true").unwrap();
        assert!(regimes.iter().all(|r| r.as_deref() == Some("periodic")));
        let periods = table.values::<i64>("period_true_revolutions").unwrap();
        assert_eq!(periods, [Some(1), Some(1)]);
        let multipliers = table.values::<f64>("floquet_multiplier_true").unwrap();
        assert_eq!(multipliers[0], None);
        assert!((multipliers[1].unwrap().ln() + 7.2342).abs() < 1e-3);

        let list = |name: &str| table.values::<Vec<f32>>(name).unwrap()[1].clone().unwrap();
        let spectrum = list("lyapunov_spectrum_true_per_s");
        assert_eq!(spectrum.len(), 8);
        assert_eq!(spectrum[0], worn as f32);
        let course = list("lyapunov_convergence_true_per_s");
        assert_eq!((course.len(), course[19]), (20, worn as f32));
    }
}
