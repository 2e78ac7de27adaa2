//! Nearest neighbours among delay vectors, with temporally close ones left out.
//!
//! The k-d tree is the crate `kiddo`'s, whose dimension is a constant of the type. Everything
//! else asks for a dimension at run time, so this file chooses among the types.

use kiddo::{ImmutableKdTree, SquaredEuclidean};
use scalar::Scalar;
use std::num::NonZero;

/// Largest dimension that can be searched.
pub const LARGEST_DIMENSION: usize = 10;

/// Delay vectors `(x[i], x[i + delay], ..., x[i + (dimension - 1) delay])` (Takens 1981).
#[derive(Clone, Copy, Debug)]
pub struct Delays<'a> {
    /// The signal.
    pub signal: &'a [f64],
    /// Coordinates of a vector, 1 to [`LARGEST_DIMENSION`].
    pub dimension: usize,
    /// Samples between coordinates, at least 1.
    pub delay: usize,
}

impl Delays<'_> {
    /// Samples from the first to the last coordinate.
    pub fn span(&self) -> usize {
        self.dimension.saturating_sub(1).saturating_mul(self.delay)
    }

    /// Number of vectors.
    pub fn count(&self) -> usize {
        self.signal.len().saturating_sub(self.span())
    }

    /// Coordinate `axis` of vector `index`.
    pub fn at(&self, index: usize, axis: usize) -> f64 {
        self.signal[index + axis * self.delay]
    }

    /// Squared Euclidean distance of two vectors.
    pub fn squared_distance(&self, a: usize, b: usize) -> f64 {
        (0..self.dimension)
            .map(|axis| (self.at(a, axis) - self.at(b, axis)).powi(2))
            .sum()
    }

    /// The same of vector `a` and each vector from `first` on, one per element of `into`.
    pub(crate) fn squared_distances(&self, a: usize, first: usize, into: &mut [f64]) {
        f64::vectorised(
            #[inline(always)]
            || {
                into.fill(0.0);
                for axis in 0..self.dimension {
                    let here = self.at(a, axis);
                    let there = &self.signal[first + axis * self.delay..];
                    for (sum, there) in into.iter_mut().zip(there) {
                        *sum += (here - there) * (here - there);
                    }
                }
            },
        );
    }
}

/// A neighbour of a vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbour {
    /// Index of the neighbouring vector.
    pub index: usize,
    /// Euclidean distance.
    pub distance: f64,
}

/// A search tree over the first vectors of an embedding.
pub struct Neighbours {
    tree: Box<dyn Search + Send + Sync>,
    count: usize,
    theiler: usize,
}

impl Neighbours {
    /// A tree over the first `count` vectors. Vectors `theiler` or fewer samples apart are no
    /// neighbours of each other (Theiler 1986). `None` for a dimension or count out of range.
    pub fn new(delays: &Delays, count: usize, theiler: usize) -> Option<Self> {
        let count = count.min(delays.count());
        let tree = match delays.dimension {
            1 => tree::<1>(delays, count),
            2 => tree::<2>(delays, count),
            3 => tree::<3>(delays, count),
            4 => tree::<4>(delays, count),
            5 => tree::<5>(delays, count),
            6 => tree::<6>(delays, count),
            7 => tree::<7>(delays, count),
            8 => tree::<8>(delays, count),
            9 => tree::<9>(delays, count),
            10 => tree::<10>(delays, count),
            _ => None,
        }?;
        Some(Self {
            tree,
            count,
            theiler,
        })
    }

    /// The `wanted` nearest vectors of vector `index` in order of distance; fewer where there
    /// are not so many.
    pub fn nearest(&self, index: usize, wanted: usize) -> Vec<Neighbour> {
        // The window hides at most so many; mostly far fewer, so a small search comes first.
        let most = (wanted + 2 * self.theiler + 1).min(self.count);
        let mut asked = (wanted + 4).min(most);
        loop {
            let mut found = self.tree.nearest(index, asked);
            found.retain(|n| n.index.abs_diff(index) > self.theiler);
            found.truncate(wanted);
            if found.len() == wanted || asked == most {
                return found;
            }
            asked = (asked * 2).min(most);
        }
    }

    /// The nearest vector of each `step`-th vector in order, `None` where the window leaves no vector.
    ///
    /// As many samples after a vector's neighbour there mostly is a near one of the next vector. Its distance
    /// bounds the search, which then costs a third of one without a bound.
    pub fn nearest_of_each(&self, step: usize) -> Vec<Option<Neighbour>> {
        let mut last: Option<Neighbour> = None;
        (0..self.count)
            .step_by(step)
            .map(|index| {
                let guess = last.map(|n| n.index + step).filter(|g| *g < self.count);
                last = match guess {
                    Some(guess) => Some(self.tree.nearest_from(index, guess, self.theiler)),
                    None => self.nearest(index, 1).first().copied(),
                };
                last
            })
            .collect()
    }
}

trait Search {
    fn nearest(&self, index: usize, count: usize) -> Vec<Neighbour>;

    /// The nearest vector outside the window, which is `guess` or nearer than it.
    fn nearest_from(&self, index: usize, guess: usize, theiler: usize) -> Neighbour;
}

struct Tree<const K: usize> {
    tree: ImmutableKdTree<f64, K>,
    points: Vec<[f64; K]>,
}

fn tree<const K: usize>(delays: &Delays, count: usize) -> Option<Box<dyn Search + Send + Sync>> {
    let points: Vec<[f64; K]> = (0..count)
        .map(|i| std::array::from_fn(|axis| delays.at(i, axis)))
        .collect();
    let tree = ImmutableKdTree::new_from_slice(&points).ok()?;
    Some(Box::new(Tree { tree, points }))
}

impl<const K: usize> Search for Tree<K> {
    fn nearest(&self, index: usize, count: usize) -> Vec<Neighbour> {
        let Some(count) = NonZero::new(count) else {
            return Vec::new();
        };
        let found = self
            .tree
            .query(&self.points[index])
            .nearest_n::<SquaredEuclidean<f64>>(count)
            .execute();
        found
            .into_iter()
            .map(|n| Neighbour {
                index: n.item as usize,
                distance: n.distance.sqrt(),
            })
            .collect()
    }

    fn nearest_from(&self, index: usize, guess: usize, theiler: usize) -> Neighbour {
        let here = &self.points[index];
        let differences = here.iter().zip(&self.points[guess]).map(|(a, b)| a - b);
        let (mut nearest, mut square) = (guess, differences.map(|d| d * d).sum());
        self.tree
            .query(here)
            .within::<SquaredEuclidean<f64>>(square)
            .unsorted()
            .visit(|n| {
                let item = n.item as usize;
                if n.distance < square && item.abs_diff(index) > theiler {
                    (nearest, square) = (item, n.distance);
                }
            });
        Neighbour {
            index: nearest,
            distance: square.sqrt(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_systems::{Noise, Regular, System};

    fn brute_force(delays: &Delays, index: usize, wanted: usize, theiler: usize) -> Vec<f64> {
        let mut distances: Vec<f64> = (0..delays.count())
            .filter(|j| j.abs_diff(index) > theiler)
            .map(|j| delays.squared_distance(index, j).sqrt())
            .collect();
        distances.sort_by(f64::total_cmp);
        distances.truncate(wanted);
        distances
    }

    #[test]
    fn neighbours_are_those_of_brute_force_in_every_dimension() {
        let repeated: Vec<f64> = (0..700).map(|i| f64::from(i % 7)).collect();
        for signal in [
            System::Lorenz.samples(700, 1),
            Noise::White.samples(700, 1),
            Regular::KnockTrain.samples(700, 1),
            repeated,
        ] {
            for dimension in 1..=LARGEST_DIMENSION {
                let delays = Delays {
                    signal: &signal,
                    dimension,
                    delay: 3,
                };
                let found = Neighbours::new(&delays, delays.count(), 12).unwrap();
                let each = found.nearest_of_each(1);
                let some = found.nearest_of_each(97);
                for index in (0..delays.count()).step_by(97) {
                    let near = found.nearest(index, 9);
                    assert!(near.iter().all(|n| n.index.abs_diff(index) > 12));
                    let expected = brute_force(&delays, index, 9, 12);
                    assert_eq!(near.len(), expected.len());
                    assert_eq!(each[index].unwrap().distance, near[0].distance);
                    assert_eq!(some[index / 97].unwrap().distance, near[0].distance);
                    for (n, e) in near.iter().zip(expected) {
                        assert!((n.distance - e).abs() <= 1e-12 * e.max(1.0), "{n:?} {e}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_window_as_long_as_the_signal_leaves_nobody() {
        let signal = Noise::White.samples(200, 1);
        let delays = Delays {
            signal: &signal,
            dimension: 2,
            delay: 1,
        };
        let found = Neighbours::new(&delays, 199, 200).unwrap();
        assert!(found.nearest(50, 3).is_empty());
        assert!(found.nearest_of_each(1).iter().all(Option::is_none));
        let wide = Delays {
            dimension: 11,
            ..delays
        };
        assert!(Neighbours::new(&wide, 100, 0).is_none());
    }
}
