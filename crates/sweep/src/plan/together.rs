//! Unknowns that are drawn together, made ready.

use input::{Error, paths};
use rand::Rng;
use scalar::random::Stream;
use serde_json::Value;

use super::sampler::{Scale, gaussian};
use crate::design::hash::unit;
use crate::distribution::Gaussian;
use crate::normal::quantile;
use crate::sweep_file;

/// Unknowns that are drawn together.
#[derive(Clone, Debug)]
pub(super) struct Together {
    parameters: Vec<(String, Gaussian, Scale)>,
    /// Lower triangle: row i has i + 1 numbers.
    root: Vec<Vec<f64>>,
}

/// What rounding may leave of a pivot that should be 0.
const PIVOT: f64 = 1e-9;

impl Together {
    /// What the entry of the sweep file says; `machine` is the machine file's tree.
    pub(super) fn new(entry: &sweep_file::Together, machine: &Value) -> Result<Self, Error> {
        let mut parameters = Vec::new();
        for (path, spread) in &entry.parameters.0 {
            let given =
                paths::get(machine, path).map_err(|e| Error::new(path, e.problem().clone()));
            let read = given.and_then(|given| gaussian(spread, given).map_err(|e| e.under(path)));
            let (gaussian, scale) = read.map_err(|e| e.under("parameters"))?;
            parameters.push((path.clone(), gaussian, scale));
        }
        let rows: Vec<Vec<f64>> = entry
            .correlations
            .iter()
            .map(|row| row.iter().map(|number| number.get()).collect())
            .collect();
        // They are those of the parameters as they stand.
        let wrong = |e: Error| e.under("correlations").against("parameters.*.*.*.*.*.*");
        check(&rows, parameters.len()).map_err(wrong)?;
        Ok(Self {
            parameters,
            root: root(&rows).map_err(wrong)?,
        })
    }

    /// The paths that are drawn.
    pub(super) fn paths(&self) -> impl Iterator<Item = &str> {
        self.parameters.iter().map(|(path, ..)| path.as_str())
    }

    /// Each path with two values that it may have.
    pub(super) fn representatives(&self) -> impl Iterator<Item = (&str, Vec<Value>)> {
        let parameters = self.parameters.iter();
        parameters.map(|(path, gaussian, scale)| {
            let values = [-1.0, 1.0].map(|deviate| scale.value(gaussian.value(deviate)));
            (path.as_str(), values.into())
        })
    }

    /// A value of each unknown: independent normal deviates times the root of the correlations.
    pub(super) fn draw(&self, random: &mut Stream) -> Vec<(&str, Value)> {
        let independent: Vec<f64> = self
            .parameters
            .iter()
            .map(|_| quantile(unit(random.next_u64())))
            .collect();
        let parameters = self.parameters.iter().zip(&self.root);
        parameters
            .map(|((path, gaussian, scale), row)| {
                let deviate = row.iter().zip(&independent).map(|(l, z)| l * z).sum();
                (path.as_str(), scale.value(gaussian.value(deviate)))
            })
            .collect()
    }
}

/// Checks that the rows are a symmetric matrix with ones on its diagonal.
fn check(rows: &[Vec<f64>], count: usize) -> Result<(), Error> {
    let wrong = |key: String, found: String| {
        let expected =
            format_args!("a symmetric matrix with ones on its diagonal, {count} rows of {count}");
        Err(Error::unexpected(key, found, expected))
    };
    if rows.len() != count {
        return wrong(String::new(), format!("{} rows", rows.len()));
    }
    for (i, row) in rows.iter().enumerate() {
        if row.len() != count {
            return wrong(i.to_string(), format!("{} numbers", row.len()));
        }
        for (j, value) in row.iter().enumerate() {
            let expected = if i == j {
                1.0
            } else {
                rows[j].get(i).copied().unwrap_or(*value)
            };
            if (value - expected).abs() > PIVOT {
                return wrong(format!("{i}.{j}"), value.to_string());
            }
        }
    }
    Ok(())
}

/// The lower triangle L with L Lᵀ equal to the matrix (Cholesky). A pivot of 0, as two unknowns of
/// correlation 1 have, gives a column of zeros.
fn root(rows: &[Vec<f64>]) -> Result<Vec<Vec<f64>>, Error> {
    let mut root: Vec<Vec<f64>> = Vec::new();
    for (i, row) in rows.iter().enumerate() {
        let mut new: Vec<f64> = Vec::new();
        for j in 0..=i {
            let known: f64 = (0..j)
                .map(|k| new[k] * if j == i { new[k] } else { root[j][k] })
                .sum();
            let left = row[j] - known;
            new.push(match j == i {
                true if left < -PIVOT => return Err(contradiction()),
                true => left.max(0.0).sqrt(),
                false if root[j][j] > PIVOT => left / root[j][j],
                false if left.abs() > PIVOT.sqrt() => return Err(contradiction()),
                false => 0.0,
            });
        }
        root.push(new);
    }
    Ok(root)
}

fn contradiction() -> Error {
    let expected = "those of some distribution: a matrix without negative eigenvalues";
    Error::unexpected("", "correlations that contradict each other", expected)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_root_gives_the_matrix_again() {
        // An unknown that is twice there, and a third with the correlation 0.6 to both.
        let rows = [[1.0, 1.0, 0.6], [1.0, 1.0, 0.6], [0.6, 0.6, 1.0]].map(Vec::from);
        let root = root(&rows).unwrap();
        assert_eq!(root, [vec![1.0], vec![1.0, 0.0], vec![0.6, 0.0, 0.8]]);
        let opposed = [[1.0, 0.9, 0.9], [0.9, 1.0, -0.9], [0.9, -0.9, 1.0]].map(Vec::from);
        assert!(super::root(&opposed).is_err());
        let twins = [[1.0, 1.0, 0.6], [1.0, 1.0, 0.5], [0.6, 0.5, 1.0]].map(Vec::from);
        assert!(super::root(&twins).is_err());
    }
}
