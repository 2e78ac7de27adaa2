//! Scratch.
#![allow(missing_docs, clippy::all)]
use crate::amendment::Amendment;
use crate::fitter::Fitter;
use crate::hypothesis::start;
use calibrate::Problem;
use calibrate::energies::Energies;
use calibrate::prior::{DESIGN, Prior, WithPriors};
use calibrate::region::Region;
use calibrate::optimiser::LeastSquares;

pub(crate) fn scratch(fitter: &Fitter, problem: &Problem, spec: &str) {
    // kind:label-substring;path=value,...
    let parts: Vec<&str> = spec.split(';').collect();
    let few = fitter.few(problem).unwrap();
    let own = problem.parameters.len();
    let mut p = match parts[0] { "alike" => few.alike.clone(), "all" => problem.with_runs(|r| fitter.effort.fits(&r.id)), _ => few.different.clone() };
    eprintln!("runs {:?}", p.runs.iter().map(|r| r.id.clone()).collect::<Vec<_>>());
    let mut x = vec![0.0; own];
    for label in parts[1].split('+') {
        let all = Amendment::all(&p).unwrap();
        let one = all.iter().find(|a| a.label() == label).unwrap_or_else(|| panic!("{:?}", all.iter().map(|a| a.label()).collect::<Vec<_>>()));
        let (np, nx) = start(&p, &x, one, &one.effect().unwrap().usual()).unwrap();
        p = np; x = nx;
    }
    for q in &p.parameters { eprintln!("  {} {:?} box {:?} value0 {}", q.path, q.scale, q.box_bounds(), q.value(0.0)); }
    let mut truth = x.clone();
    for (i, q) in p.parameters.iter().enumerate() { if i < own { truth[i] = 0.0; }
        for pair in parts[2].split(',') { if let Some((path, v)) = pair.split_once('=') { if q.path == path { truth[i] = q.coordinate(v.parse().unwrap()); } } } }
    eprintln!("x {x:?}\ntruth {truth:?}");
    let p = p.metered();
    let e = Energies::new(&p);
    let half = |x: &[f64]| 0.5 * e.residuals(x).iter().map(|r| r * r).sum::<f64>();
    let priors: Vec<Prior> = (0..own).map(|place| Prior { place, spread: DESIGN }).collect();
    let c = WithPriors { inner: &e, priors: &priors };
    eprintln!("at start {} with none {} at truth {} ; steps {}", half(&x), half(&vec![0.0; x.len()]), half(&truth), p.meter.steps());
    for k in 0..=10 { let t = k as f64 / 10.0; let at: Vec<f64> = x.iter().zip(&truth).map(|(a, b)| a + t * (b - a)).collect(); eprint!("{:.0} ", half(&at)); }
    eprintln!();
    let r = e.residuals(&truth);
    for (i, c) in r.chunks(1).enumerate() { if c[0].abs() > 3.0 { eprint!("{i}:{:.1} ", c[0]); } }
    eprintln!("\n{} residuals", r.len());
    for seed in 0..parts[3].parse::<u64>().unwrap() {
        let half = 0.6;
        let ranges: Vec<(usize, [f64; 2])> = p.parameters.iter().enumerate().map(|(i, q)| if i < own { (i, [-half, half]) } else { (i, q.box_bounds()) }).collect();
        let region = Region::new(&c, &x, &ranges);
        for each in [25u64, 100, 300] {
            let before = p.meter.steps();
            let found = region.searched_seeded(each * region.dimensions() as u64, seed, &mut |_| std::ops::ControlFlow::Continue(())).unwrap();
            eprintln!("seed {seed} each {each}: cost {:.1} steps {} x {:?}", found.cost, p.meter.steps() - before, found.x.iter().map(|x| (x * 100.0).round() / 100.0).collect::<Vec<_>>());
        }
    }
}
