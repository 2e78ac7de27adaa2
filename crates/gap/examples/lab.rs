use std::ops::ControlFlow;
use std::path::Path;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let bundle = std::fs::canonicalize(&a[1]).unwrap();
    let calibration = input::calibration::Calibration::with_defaults(vec![bundle]);
    let asked = gap::Asked { calibration: &calibration, base: Path::new(""), allow_outside: false, locate: &|e| e };
    let out = Path::new(&a[2]);
    let _ = std::fs::remove_dir_all(out);
    let t = std::time::Instant::now();
    let verbose = std::env::var("VERBOSE").is_ok();
    let r = gap::into_folder(&asked, out, &|s| if verbose { eprintln!("{:.1} {} {:.2}", t.elapsed().as_secs_f64(), s.words, s.misfit) }, &|| ControlFlow::Continue(()));
    match r {
        Err(e) => println!("error {e}"),
        Ok(r) => {
            println!("{} {:.0}s cost {}M gap {:.2} -> {:.2} held {:?} -> {:?}", r.verdict.name(), t.elapsed().as_secs_f64(), r.cost / 1_000_000, r.gap.before, r.gap.after, r.gap.heldout_before, r.gap.heldout_after);
            for e in &r.effects {
                println!("  {} p={:.2} {:?}", e.label, e.probability, e.parameters.iter().map(|(k, p)| format!("{k}={:.3e}", p.value)).collect::<Vec<_>>());
                for o in &e.rivals { println!("     rival {} p={:.2} leaves {:.2} / {:?}", o.label, o.probability, o.leaves, o.evidence.heldout_misfit); }
            }
            for c in &r.corrections { println!("  {c:?}"); }
            for o in &r.refused { println!("  refused {} p={:.2} leaves {:.2} / {:?}", o.label, o.probability, o.leaves, o.evidence.heldout_misfit); }
        }
    }
}
