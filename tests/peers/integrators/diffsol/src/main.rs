//! diffsol on the machine: `with-diffsol METHOD TOLERANCE REVOLUTIONS FILE`.
//!
//! METHOD is tsit45, bdf, esdirk34 or tr_bdf2. Products with the Jacobian by dual numbers; output by
//! the solver's interpolation; nalgebra's vectors and dense matrices. Events are not
//! located (tests/peers/README.md).

mod dual;
mod machine;

use diffsol::{NalgebraLU, NalgebraMat, NalgebraVec, OdeBuilder, OdeEquations, OdeSolverMethod};
use dual::Dual;
use machine::{COMPONENTS, Machine, REVOLUTION, SAMPLES, SCALES};
use std::error::Error;

type Matrix = NalgebraMat<f64>;
type Solver = NalgebraLU<f64>;

/// Steps through all samples and writes them.
fn record<'a, E: OdeEquations<T = f64, V = NalgebraVec<f64>> + 'a>(
    mut solver: impl OdeSolverMethod<'a, E>,
    machine: &Machine,
    samples: &mut [f64],
) -> Result<(), Box<dyn Error>> {
    let mut y = solver.state().y.clone();
    let mut rates = [0.0; COMPONENTS];
    let time = |sample: usize| sample as f64 * REVOLUTION / SAMPLES as f64;
    let mut next = 0;
    solver.set_stop_time(time(samples.len()))?;
    while next < samples.len() {
        solver.step()?;
        while next < samples.len() && time(next) <= solver.state().t {
            solver.interpolate_inplace(time(next), &mut y)?;
            samples[next] = machine.derivative(time(next), y.batch_as_slice(0), &mut rates);
            next += 1;
        }
    }
    Ok(())
}

fn run(method: &str, tolerance: f64, count: usize) -> Result<Vec<f64>, Box<dyn Error>> {
    let machine = Machine::new();
    let problem = OdeBuilder::<Matrix>::new()
        .rtol(tolerance)
        .atol(SCALES.map(|scale| tolerance * scale))
        .rhs_implicit(
            |y, _p, t, dy| {
                machine.derivative(t, y, dy);
            },
            |y, _p, t, v, product| {
                let point: [Dual; COMPONENTS] = std::array::from_fn(|i| Dual(y[i], v[i]));
                let mut rates = [Dual(0.0, 0.0); COMPONENTS];
                machine.derivative(t, &point, &mut rates);
                for (product, rate) in product.iter_mut().zip(rates) {
                    *product = rate.1;
                }
            },
        )
        .init(|_p, _t, y| y.fill(0.0), COMPONENTS)
        .build()?;
    let mut samples = vec![0.0; count];
    match method {
        "tsit45" => record(problem.tsit45()?, &machine, &mut samples)?,
        "bdf" => record(problem.bdf::<Solver>()?, &machine, &mut samples)?,
        "esdirk34" => record(problem.esdirk34::<Solver>()?, &machine, &mut samples)?,
        "tr_bdf2" => record(problem.tr_bdf2::<Solver>()?, &machine, &mut samples)?,
        _ => return Err(format!("{method} is not known").into()),
    }
    Ok(samples)
}

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [method, tolerance, revolutions, path] = &words[..] else {
        return Err("METHOD TOLERANCE REVOLUTIONS FILE".into());
    };
    let count = SAMPLES * revolutions.parse::<usize>()?;
    let (mut runs, mut spent) = (0, 0.0);
    let mut samples = Vec::new();
    let start = thread_time()?;
    while spent < 0.2 {
        samples = run(method, tolerance.parse()?, count)?;
        spent = thread_time()? - start;
        runs += 1;
    }
    let bytes: Vec<u8> = samples.iter().flat_map(|x| x.to_le_bytes()).collect();
    std::fs::write(path, bytes)?;
    println!(
        "{:.6}",
        1e3 * spent / f64::from(runs) * SAMPLES as f64 / count as f64
    );
    Ok(())
}

/// CPU time of this thread so far, s, as Linux counts it.
fn thread_time() -> Result<f64, Box<dyn Error>> {
    let counts = std::fs::read_to_string("/proc/thread-self/schedstat")?;
    let nanoseconds = counts.split(' ').next().ok_or("an empty schedstat")?;
    Ok(nanoseconds.parse::<f64>()? * 1e-9)
}
