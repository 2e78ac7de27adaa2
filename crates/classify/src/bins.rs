//! Numbers as places between edges: what a tree looks for a split in.

use crate::Matrix;
use rayon::prelude::*;

/// Bins of a column: one for missing values, the others between edges.
pub const BINS: usize = 256;

/// The rows of a matrix, each number as its bin. Bin 0 holds missing values.
pub struct Bins {
    /// Bin of each row, column after column.
    pub columns: Vec<Vec<u8>>,
    /// Edges of each column, ascending: bin b + 1 holds what is above edge b - 1 and not above edge b.
    pub edges: Vec<Vec<f64>>,
    /// Rows.
    pub rows: usize,
}

impl Bins {
    /// Bins with about as many rows in each.
    pub fn new(matrix: &Matrix) -> Self {
        let binned = matrix.columns().par_iter().map(|column| {
            let edges = edges(column);
            let bins = column.iter().map(|value| bin(&edges, *value)).collect();
            (bins, edges)
        });
        let (columns, edges) = binned
            .collect::<Vec<(Vec<u8>, Vec<f64>)>>()
            .into_iter()
            .unzip();
        Self {
            columns,
            edges,
            rows: matrix.rows(),
        }
    }
}

fn bin(edges: &[f64], value: f64) -> u8 {
    if !value.is_finite() {
        return 0;
    }
    let below = edges.partition_point(|edge| *edge < value);
    u8::try_from(below + 1).unwrap_or(u8::MAX)
}

/// Half way between neighbours: all of them where there are few, every so many-th otherwise.
fn edges(column: &[f64]) -> Vec<f64> {
    let mut values: Vec<f64> = column
        .iter()
        .copied()
        .filter(|value| value.is_finite())
        .collect();
    values.sort_by(f64::total_cmp);
    let between = |a: f64, b: f64| a + (b - a) / 2.0;
    let mut distinct = values.clone();
    distinct.dedup();
    if distinct.len() < BINS {
        return distinct
            .windows(2)
            .map(|pair| between(pair[0], pair[1]))
            .collect();
    }
    let parts = BINS - 1;
    let mut edges: Vec<f64> = (1..parts)
        .map(|part| part * values.len() / parts)
        .map(|place| between(values[place - 1], values[place]))
        .collect();
    edges.dedup();
    edges
}
