//! Parts of a sample that are tested by what the others train.

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;

/// The stream of random numbers that belongs to a seed and a number.
pub fn random(seed: u64, number: u64) -> ChaCha8Rng {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(number);
    random
}

/// A fold for each row: rows of one group stand in one fold, and groups of each side are spread evenly, in random order.
///
/// `groups` has the name of each row's group, `sides` which of the two samples it is from; a group has one side.
pub fn folds(groups: &[String], sides: &[bool], folds: usize, seed: u64) -> Vec<usize> {
    let mut of_group: BTreeMap<(bool, &str), usize> = BTreeMap::new();
    for side in [false, true] {
        let names = groups.iter().zip(sides).filter(|(_, of)| **of == side);
        let mut names: Vec<&str> = names.map(|(group, _)| group.as_str()).collect();
        names.sort_unstable();
        names.dedup();
        names.shuffle(&mut random(seed, u64::from(side)));
        let places = names.into_iter().enumerate();
        of_group.extend(places.map(|(place, name)| ((side, name), place % folds)));
    }
    let rows = groups.iter().zip(sides);
    rows.map(|(group, side)| of_group[&(*side, group.as_str())])
        .collect()
}
