//! Exponents and regimes of all windows, as far as the table of features has them.

use super::{Dataset, Error};
use recordings::{Kind, Table};

/// The columns, each a value per window; a column that the table lacks has none at all.
#[derive(Default)]
pub struct Motions {
    true_exponent: Vec<Option<f64>>,
    true_error: Vec<Option<f64>>,
    true_regime: Vec<Option<String>>,
    true_period: Vec<Option<f64>>,
    exponent: Vec<Option<f64>>,
    low: Vec<Option<f64>>,
    high: Vec<Option<f64>>,
    reason: Vec<Option<String>>,
    regime: Vec<Option<String>>,
}

impl Dataset {
    /// Reads what the table says about the kind of motion.
    ///
    /// # Errors
    /// A table that cannot be read.
    pub fn motions(&self) -> Result<Motions, Error> {
        let mut motions = Motions::default();
        let files = &self.files;
        for path in &self.windows.files {
            let file = files.open(path)?;
            let columns = file.schema().columns().iter();
            let names = columns.map(|column| column.name.as_str());
            let names: Vec<&str> = names.filter(|name| motions.has(name)).collect();
            if !names.is_empty() {
                let rows = 0..file.rows();
                files.read(path, &file, &names, rows, |table| motions.append(table))?;
            }
        }
        Ok(motions)
    }
}

/// Where the values of a column go.
enum Values<'a> {
    Numbers(&'a mut Vec<Option<f64>>),
    Texts(&'a mut Vec<Option<String>>),
}

impl Motions {
    fn column(&mut self, name: &str) -> Option<Values<'_>> {
        Some(match name {
            "lyapunov_true_per_s" => Values::Numbers(&mut self.true_exponent),
            "lyapunov_true_standard_error_per_s" => Values::Numbers(&mut self.true_error),
            "period_true_revolutions" => Values::Numbers(&mut self.true_period),
            "regime_true" => Values::Texts(&mut self.true_regime),
            "lyapunov_per_s" => Values::Numbers(&mut self.exponent),
            "lyapunov_low_per_s" => Values::Numbers(&mut self.low),
            "lyapunov_high_per_s" => Values::Numbers(&mut self.high),
            "lyapunov_reason" => Values::Texts(&mut self.reason),
            "regime" => Values::Texts(&mut self.regime),
            _ => return None,
        })
    }

    fn has(&mut self, name: &str) -> bool {
        self.column(name).is_some()
    }

    fn append(&mut self, table: &Table) -> Result<(), recordings::Error> {
        for column in table.schema().columns() {
            match (self.column(&column.name), column.kind) {
                (None, _) => {}
                (Some(Values::Numbers(into)), Kind::Integer) => {
                    let values = table.values::<i64>(&column.name)?.iter();
                    into.extend(values.map(|value| value.map(|n| n as f64)));
                }
                (Some(Values::Numbers(into)), _) => {
                    into.extend_from_slice(table.values::<f64>(&column.name)?);
                }
                (Some(Values::Texts(into)), _) => {
                    into.extend_from_slice(table.values::<String>(&column.name)?);
                }
            }
        }
        Ok(())
    }

    /// Largest Lyapunov exponent from the equations with its standard error, 1/s.
    pub fn true_exponent(&self, window: usize) -> Option<[f64; 2]> {
        let error = number(&self.true_error, window).unwrap_or(0.0);
        Some([number(&self.true_exponent, window)?, error])
    }

    /// Regime from the equations, and its period in revolutions where it has one.
    pub fn true_regime(&self, window: usize) -> Option<(&str, Option<u32>)> {
        let period = number(&self.true_period, window).map(|period| period as u32);
        Some((text(&self.true_regime, window)?, period))
    }

    /// Largest Lyapunov exponent from the signal with the ends of its 95 % interval, 1/s.
    pub fn exponent(&self, window: usize) -> Option<[f64; 3]> {
        let [value, low, high] =
            [&self.exponent, &self.low, &self.high].map(|column| number(column, window));
        Some([value?, low?, high?])
    }

    /// Why the signal has no exponent.
    pub fn reason(&self, window: usize) -> Option<&str> {
        text(&self.reason, window)
    }

    /// Regime from the signal.
    pub fn regime(&self, window: usize) -> Option<&str> {
        text(&self.regime, window)
    }
}

fn number(column: &[Option<f64>], window: usize) -> Option<f64> {
    column.get(window).copied().flatten()
}

fn text(column: &[Option<String>], window: usize) -> Option<&str> {
    column.get(window)?.as_deref()
}
