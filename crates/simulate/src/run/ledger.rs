//! The ledger of a run's energy, and the checks that it closes.

use super::Run;
use crate::error::{Error, MOST_MISSING};

/// Energy and works at an instant, J.
pub(crate) struct Ledger {
    energy: f64,
    works: [f64; 4],
    /// What the gas holds for the pistons; none where effects act on it.
    gas: Option<f64>,
}

impl Run<f64> {
    /// Where energy and works stand.
    pub(crate) fn ledger(&mut self) -> Ledger {
        let y = self.integrator.state().to_vec();
        self.dynamics.evaluate(self.integrator.time(), &y);
        let mut works = [0.0; 4];
        if let Some(i) = self.dynamics.layout().ledger {
            works.copy_from_slice(&y[i..i + 4]);
        }
        Ledger {
            energy: self.dynamics.energy().total(),
            works,
            gas: self.dynamics.gas_energy(),
        }
    }

    /// Goes on with the ledger for a revolution from where this run stands, which stays there: what the
    /// ledger misses, over the energy turned over.
    ///
    /// # Errors
    /// Where that is too much, the gas did more work than it held, or the revolution cannot be integrated.
    pub(crate) fn audit(&self, tolerance: f64) -> Result<f64, Error> {
        let at = self.standing();
        let mut state = at.state.clone();
        state.extend([0.0; 4]);
        let machine = self.dynamics.machine().clone();
        let mut run = Self::resume(machine, &at, &state, tolerance, true);
        let before = run.ledger();
        run.turn(1)?;
        run.balance(&before)
    }

    /// What the ledger misses since `before`, at least a revolution ago, over the energy turned over.
    ///
    /// # Errors
    /// Where that is too much, or the gas did more work than it held.
    pub(crate) fn balance(&mut self, before: &Ledger) -> Result<f64, Error> {
        self.ledger().balance(before)
    }

    /// The same, with the works (J) since then, which have not been integrated along.
    ///
    /// # Errors
    /// As [`balance`](Self::balance).
    pub(crate) fn balance_of(&mut self, works: [f64; 4], before: &Ledger) -> Result<f64, Error> {
        let now = self.ledger();
        Ledger { works, ..now }.balance(before)
    }
}

impl Ledger {
    fn balance(&self, before: &Self) -> Result<f64, Error> {
        self.check_gas(before)?;
        self.residual(before)
    }

    /// What the ledger misses since `before`, over the energy turned over.
    ///
    /// # Errors
    /// Where that is too much.
    fn residual(&self, before: &Self) -> Result<f64, Error> {
        let [gas, drive, friction, damping] = self.works_since(before);
        let missing = self.energy - before.energy - (gas + drive - friction - damping);
        let missing = over(missing, self.turned_since(before));
        match missing.abs() <= MOST_MISSING {
            true => Ok(missing),
            false => Err(Error::EnergyMissing {
                missing: missing.abs(),
            }),
        }
    }

    /// Checks that the gas has done no more work since `before`, at least a revolution ago, than it held.
    /// The work is the integral of force times piston speed. What the gas holds follows from pressure and
    /// volume alone. So neither can hide an error of the other. Within a stroke clearances blur this, as
    /// the dead centres set the gas by the place of the ideal piston.
    ///
    /// # Errors
    /// Where it has.
    fn check_gas(&self, before: &Self) -> Result<(), Error> {
        let Some(held) = before.gas.zip(self.gas).map(|(before, now)| before - now) else {
            return Ok(());
        };
        let [work, ..] = self.works_since(before);
        let gained = over(work - held, self.turned_since(before));
        match gained <= MOST_MISSING {
            true => Ok(()),
            false => Err(Error::EnergyFromGas { gained }),
        }
    }

    fn works_since(&self, before: &Self) -> [f64; 4] {
        std::array::from_fn(|i| self.works[i] - before.works[i])
    }

    /// Energy turned over, J.
    fn turned_since(&self, before: &Self) -> f64 {
        self.works_since(before).iter().map(|work| work.abs()).sum()
    }
}

/// A share of a whole; 0 of nothing.
fn over(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { part / whole } else { 0.0 }
}
