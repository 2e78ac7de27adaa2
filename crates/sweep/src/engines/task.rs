//! The number of a shard without an argument: engines that run arrays of tasks set it in a
//! variable.

use super::Error;

/// The variable of each engine, and the number from which it counts at the least. LSF and Grid
/// Engine know no task 0: their task 1 is shard 0.
const VARIABLES: [(&str, u64); 6] = [
    ("SLURM_ARRAY_TASK_ID", 0),
    ("PBS_ARRAY_INDEX", 0),
    ("PBS_ARRAYID", 0),
    ("LSB_JOBINDEX", 1),
    ("SGE_TASK_ID", 1),
    ("JOB_COMPLETION_INDEX", 0),
];

/// The number that an engine's variable says; `variable` reads one.
///
/// # Errors
/// [`Error::NoIndex`] if no variable has a number.
pub fn index(variable: impl Fn(&str) -> Option<String>) -> Result<u64, Error> {
    // Outside an array, LSF says 0 and Grid Engine `undefined`.
    let index =
        |(name, first): &(&str, u64)| variable(name)?.parse::<u64>().ok()?.checked_sub(*first);
    VARIABLES.iter().find_map(index).ok_or_else(|| {
        let names = VARIABLES.map(|(name, _)| name).join(", ");
        Error::NoIndex(names)
    })
}

#[cfg(test)]
mod tests {

    fn index(name: &'static str, value: &'static str) -> Option<u64> {
        super::index(|asked| (asked == name).then(|| value.to_owned())).ok()
    }

    #[test]
    fn engines_count_from_where_they_do() {
        assert_eq!(index("SLURM_ARRAY_TASK_ID", "0"), Some(0));
        assert_eq!(index("PBS_ARRAY_INDEX", "7"), Some(7));
        assert_eq!(index("LSB_JOBINDEX", "1"), Some(0));
        assert_eq!(index("LSB_JOBINDEX", "0"), None);
        assert_eq!(index("SGE_TASK_ID", "12"), Some(11));
        assert_eq!(index("SGE_TASK_ID", "undefined"), None);
        assert_eq!(index("JOB_COMPLETION_INDEX", "3"), Some(3));
        assert_eq!(index("HOME", "3"), None);
    }
}
