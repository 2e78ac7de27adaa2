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
        let mut widest_m = vec![0.0_f64; self.joints.len()];
        for (position, block) in self.blocks.iter().enumerate() {
            for inside in block.probes() {
                let case = self.case_before_splits((start + inside) * self.repeats);
                let case = case.and_then(|case| self.check_columns(&case).map(|()| case));
                let case = case.map_err(|error| {
                    let keys = block.keys(inside, &self.frame());
                    self.blame(error, keys, position, inside)
                })?;
                let wider = case.labels.clearances_m.iter().zip(&mut widest_m);
                wider.for_each(|(clearance, widest)| *widest = widest.max(*clearance));
            }
            start += block.count();
        }
        self.check_play(&widest_m)
    }

    /// Checks that the effects on joints can act in some case; `widest_m` are the widest clearances of the joints, m.
    fn check_play(&self, widest_m: &[f64]) -> Result<(), Error> {
        for effect in &self.effects {
            let Some(place) = effect.joint() else {
                continue;
            };
            let mut joints = self.joints.iter().zip(widest_m);
            if joints.any(|(joint, widest)| effect.is_at(&joint.name) && *widest > 0.0) {
                continue;
            }
            let name = format!("effects.{}", effect.name());
            let found = format!("{}, which acts on {place}", effect.name());
            let expected = format!(
                "a clearance of {place} in some case, e.g. by an axis joints: the joint is ideal in all of them, so that the \
                 effect does nothing"
            );
            let error = Error::unexpected(name, found, expected);
            return Err(match self.setting(effect.name()) {
                Some(key) => Error::new(key, error.problem().clone()),
                None => error.under("machine"),
            });
        }
        Ok(())
    }

    /// Key in the sweep file of the first value that sets something of the effect `name`.
    fn setting(&self, name: &str) -> Option<String> {
        let blocks = self.blocks.iter();
        let listed = blocks.flat_map(|block| {
            let probes = block.probes().into_iter();
            probes.flat_map(|inside| block.keys(inside, &self.frame()))
        });
        let varied = self.varied().map(|(key, path)| (key, path.to_owned()));
        let names = |path: &str| path == "effects" || path.split('.').any(|part| part == name);
        let mut all = listed.chain(varied);
        all.find(|(_, path)| names(path)).map(|(key, _)| key)
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
