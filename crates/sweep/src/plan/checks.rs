//! A plan is checked before anything is run.

use input::{Error, Problem};

use super::case::Case;
use super::{MOST_CASES, Plan, channels};
use crate::labels::joints;

impl Plan {
    /// Checks that the sweep is not too large to be run.
    ///
    /// # Errors
    /// [`crate::Error::TooManyCases`] if it has more than [`MOST_CASES`] cases.
    pub fn check_size(&self) -> Result<(), crate::Error> {
        let (cases, most) = (self.cases(), MOST_CASES);
        if cases > most {
            return Err(crate::Error::TooManyCases { cases, most });
        }
        Ok(())
    }

    /// Tries cases that between them have every value that the file names, so that a mistake is
    /// found before anything is run.
    pub(super) fn try_cases(&self) -> Result<(), Error> {
        let mut start = 0;
        for (position, block) in self.blocks.iter().enumerate() {
            for inside in block.probes() {
                let case = self.case_before_splits((start + inside) * self.repeats);
                if let Err(error) = case.and_then(|case| self.check_columns(&case)) {
                    let keys = block.keys(inside, &self.frame());
                    return Err(self.blame(error, keys, position, inside));
                }
            }
            start += block.count();
        }
        Ok(())
    }

    /// All rows of a table have the same columns, so all cases have the same joints and sensors.
    fn check_columns(&self, case: &Case) -> Result<(), Error> {
        if channels(&case.resolved, &self.throws) != self.channels() {
            let found = "sensors that measure something else";
            return Err(Error::unexpected(
                "sensors",
                found,
                "those of the machine file",
            ));
        }
        if joints(&case.resolved.machine) != self.joints {
            let found = "throws with other names";
            return Err(Error::unexpected(
                "throws",
                found,
                "those of the machine file",
            ));
        }
        Ok(())
    }

    /// `error` of a case, at the value of the sweep file that it comes from.
    fn blame(&self, error: Error, keys: Vec<(String, String)>, block: usize, case: u64) -> Error {
        let varied = self.varied().map(|(key, path)| (key, path.to_owned()));
        let within = |path: &str, other: &str| {
            let rest = path.strip_prefix(other);
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        };
        let mut sources = keys.into_iter().chain(varied);
        match sources.find(|(_, path)| within(path, error.key()) || within(error.key(), path)) {
            Some((key, _)) => Error::new(key, error.problem().clone()),
            None => {
                let problem = format!("case {case} of this block: {error}");
                Error::new(format!("cases.{block}"), Problem::Other(problem))
            }
        }
    }
}
