//! Every combination of the levels of several axes, the last axis fastest.

/// Number of combinations; none where it exceeds 2^64 − 1.
pub fn count(sizes: &[u64]) -> Option<u64> {
    sizes.iter().try_fold(1_u64, |n, &size| n.checked_mul(size))
}

/// Which level each axis has in combination `index`, which must be below [`count`].
pub fn levels(index: u64, sizes: &[u64]) -> Vec<usize> {
    let mut rest = index;
    let mut levels: Vec<usize> = sizes
        .iter()
        .rev()
        .map(|&size| {
            let level = rest % size;
            rest /= size;
            level as usize
        })
        .collect();
    levels.reverse();
    levels
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_combinations_come_once_and_in_order() {
        let sizes = [2, 3, 2];
        assert_eq!(count(&sizes), Some(12));
        let all: Vec<Vec<usize>> = (0..12).map(|i| levels(i, &sizes)).collect();
        assert_eq!(all[0], [0, 0, 0]);
        assert_eq!(all[1], [0, 0, 1]);
        assert_eq!(all[11], [1, 2, 1]);
        assert!(all.is_sorted_by(|a, b| a < b));
    }

    #[test]
    fn sizes_at_the_edges() {
        assert_eq!(count(&[]), Some(1));
        assert_eq!(count(&[3, 0]), Some(0));
        assert_eq!(count(&[u64::MAX, 2]), None);
        assert!(levels(0, &[]).is_empty());
    }
}
