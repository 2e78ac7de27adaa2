//! A tree that is grown leaf by leaf, always where the loss falls most (Ke et al. 2017, LightGBM).

use crate::Matrix;
use crate::bins::{BINS, Bins};
use rayon::prelude::*;

/// Leaves of a tree.
const LEAVES: usize = 31;

/// Fewest rows of a leaf.
const ROWS: usize = 20;

/// Smallest second derivative of a leaf: below it a step would be unbounded.
const CURVATURE: f64 = 1e-3;

/// Slope and curvature of the loss at a row, by its score.
#[derive(Clone, Copy, Debug, Default)]
pub struct Derivatives {
    pub slope: f64,
    pub curvature: f64,
}

/// What stands at a place of a tree.
#[derive(Clone, Debug)]
enum Node {
    /// Rows with a value above the threshold go to `above`; others, and those without a value, to `below`.
    Split {
        column: usize,
        threshold: f64,
        below: usize,
        above: usize,
    },
    /// What is added to the score.
    Leaf(f64),
}

/// Trees of thresholds.
#[derive(Clone, Debug)]
pub struct Tree {
    nodes: Vec<Node>,
}

/// Rows that are in a leaf so far, and how they are best split.
struct Growing {
    node: usize,
    rows: Vec<u32>,
    sum: Sum,
    split: Option<Split>,
}

/// Sums over rows.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    slope: f64,
    curvature: f64,
    rows: usize,
}

#[derive(Clone, Copy, Debug)]
struct Split {
    gain: f64,
    column: usize,
    /// The last bin of those below.
    bin: usize,
}

impl Sum {
    fn add(&mut self, at: Derivatives) {
        self.slope += at.slope;
        self.curvature += at.curvature;
        self.rows += 1;
    }

    fn plus(self, other: Self) -> Self {
        Self {
            slope: self.slope + other.slope,
            curvature: self.curvature + other.curvature,
            rows: self.rows + other.rows,
        }
    }

    fn minus(self, other: Self) -> Self {
        Self {
            slope: self.slope - other.slope,
            curvature: self.curvature - other.curvature,
            rows: self.rows - other.rows,
        }
    }

    /// Twice what the loss falls by with one step of Newton's method.
    fn score(self) -> f64 {
        self.slope * self.slope / self.curvature
    }

    fn is_enough(self) -> bool {
        self.rows >= ROWS && self.curvature >= CURVATURE
    }
}

impl Tree {
    /// Grows a tree on all rows, and adds `rate` times its values to their `scores`.
    pub fn grow(bins: &Bins, derivatives: &[Derivatives], rate: f64, scores: &mut [f64]) -> Self {
        let all: Vec<u32> = (0..bins.rows as u32).collect();
        let mut nodes = vec![Node::Leaf(0.0)];
        let mut leaves = vec![Growing::new(0, all, bins, derivatives)];
        while leaves.len() < LEAVES {
            let Some((place, split)) = best(&leaves) else {
                break;
            };
            let leaf = leaves.swap_remove(place);
            let column = &bins.columns[split.column];
            let (below, above): (Vec<u32>, Vec<u32>) = leaf
                .rows
                .iter()
                .partition(|row| usize::from(column[**row as usize]) <= split.bin);
            let places = (nodes.len(), nodes.len() + 1);
            nodes.extend([Node::Leaf(0.0), Node::Leaf(0.0)]);
            nodes[leaf.node] = Node::Split {
                column: split.column,
                // Only missing values are below the first edge.
                threshold: match split.bin {
                    0 => f64::NEG_INFINITY,
                    bin => bins.edges[split.column][bin - 1],
                },
                below: places.0,
                above: places.1,
            };
            leaves.push(Growing::new(places.0, below, bins, derivatives));
            leaves.push(Growing::new(places.1, above, bins, derivatives));
        }
        for leaf in leaves {
            let value = match leaf.sum.curvature > 0.0 {
                true => -rate * leaf.sum.slope / leaf.sum.curvature,
                false => 0.0,
            };
            nodes[leaf.node] = Node::Leaf(value);
            leaf.rows
                .iter()
                .for_each(|row| scores[*row as usize] += value);
        }
        Self { nodes }
    }

    /// What it adds to the score of a row, given the value of each column.
    pub fn value(&self, of: impl Fn(usize) -> f64) -> f64 {
        let mut place = 0;
        loop {
            match &self.nodes[place] {
                Node::Leaf(value) => return *value,
                Node::Split {
                    column,
                    threshold,
                    below,
                    above,
                } => {
                    let value = of(*column);
                    place = if value.is_finite() && value > *threshold {
                        *above
                    } else {
                        *below
                    };
                }
            }
        }
    }

    /// The columns that it looks at.
    pub fn columns(&self) -> impl Iterator<Item = usize> {
        self.nodes.iter().filter_map(|node| match node {
            Node::Split { column, .. } => Some(*column),
            Node::Leaf(_) => None,
        })
    }

    /// What it adds to the score of each row.
    pub fn values(&self, matrix: &Matrix) -> Vec<f64> {
        (0..matrix.rows())
            .map(|row| self.value(|column| matrix.value(row, column)))
            .collect()
    }
}

impl Growing {
    fn new(node: usize, rows: Vec<u32>, bins: &Bins, derivatives: &[Derivatives]) -> Self {
        let mut sum = Sum::default();
        rows.iter()
            .for_each(|row| sum.add(derivatives[*row as usize]));
        let split = match rows.len() >= 2 * ROWS {
            true => split(&rows, sum, bins, derivatives),
            false => None,
        };
        Self {
            node,
            rows,
            sum,
            split,
        }
    }
}

/// The leaf whose split gains most, the first of equal ones.
fn best(leaves: &[Growing]) -> Option<(usize, Split)> {
    let splits = leaves.iter().enumerate();
    let splits = splits.filter_map(|(place, leaf)| Some((place, leaf.node, leaf.split?)));
    let best = splits.max_by(|a, b| a.2.gain.total_cmp(&b.2.gain).then(b.1.cmp(&a.1)));
    best.map(|(place, _, split)| (place, split))
}

/// The split of rows that gains most, the first column of equal ones.
fn split(rows: &[u32], sum: Sum, bins: &Bins, derivatives: &[Derivatives]) -> Option<Split> {
    let columns = (0..bins.columns.len()).into_par_iter();
    let splits: Vec<Option<Split>> = columns
        .map(|column| split_of(column, rows, sum, bins, derivatives))
        .collect();
    let splits = splits.into_iter().flatten();
    splits.max_by(|a, b| a.gain.total_cmp(&b.gain).then(b.column.cmp(&a.column)))
}

fn split_of(
    column: usize,
    rows: &[u32],
    sum: Sum,
    bins: &Bins,
    derivatives: &[Derivatives],
) -> Option<Split> {
    let mut histogram = [Sum::default(); BINS];
    let of_row = &bins.columns[column];
    for row in rows {
        histogram[usize::from(of_row[*row as usize])].add(derivatives[*row as usize]);
    }
    let mut below = Sum::default();
    let mut best: Option<Split> = None;
    for (bin, own) in histogram
        .iter()
        .enumerate()
        .take(bins.edges[column].len() + 1)
    {
        if own.rows == 0 {
            continue;
        }
        below = below.plus(*own);
        let above = sum.minus(below);
        if !below.is_enough() || !above.is_enough() {
            continue;
        }
        let gain = below.score() + above.score() - sum.score();
        if gain > best.map_or(0.0, |split| split.gain) {
            best = Some(Split { gain, column, bin });
        }
    }
    best
}
