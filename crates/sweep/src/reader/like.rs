//! Features of recordings that are to stand beside those of a dataset: the same columns, from windows of the same rate and
//! length. A classifier that was trained on the one is then shown the same quantities of the other.

use super::{Dataset, Error, Subset};
use features::recorded::{KnownMachine, Row, Said, WindowLength};
use recordings::{Column, Role, Schema, Value};
use std::collections::BTreeSet;
use std::path::Path;

/// Largest difference between two sample rates that are meant to be one, as a share: clocks of recorders are that far off.
const RATE: f64 = 1e-3;

/// What the windows of a dataset are.
#[derive(Clone, Debug)]
pub struct Like {
    /// The features, in the order of the dataset.
    pub features: Vec<Column>,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Revolutions of the crank in a window.
    pub revolutions: u32,
    /// Whether the kind of motion is among the features.
    pub motion: bool,
    /// The machine, for the indicated power.
    pub machine: KnownMachine,
}

/// How recordings differ from a dataset.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Unlike {
    /// Channels of the dataset that they lack.
    #[error(
        "channels: found {}, expected {} as in the dataset: nothing gives {missing} of its features",
        listed(found),
        listed(expected)
    )]
    Channels {
        /// Theirs.
        found: Vec<String>,
        /// Those of the dataset.
        expected: Vec<String>,
        /// Features that they lack.
        missing: usize,
    },
    /// Another sample rate.
    #[error("{file}: sample rate: found {found} Hz, expected {expected} Hz as in the dataset")]
    Rate {
        /// The file.
        file: String,
        /// Its rate, Hz.
        found: f64,
        /// That of the dataset, Hz.
        expected: f64,
    },
    /// Windows of another length.
    #[error("{file}: window: found {found:.1} revolutions, expected {expected} as in the dataset")]
    Window {
        /// The file.
        file: String,
        /// Its revolutions.
        found: f64,
        /// Those of the dataset.
        expected: u32,
    },
}

fn listed(names: &[String]) -> String {
    match names {
        [] => "none".to_owned(),
        names => names.join(", "),
    }
}

impl Dataset {
    /// What its windows are.
    ///
    /// # Errors
    /// A table that cannot be read.
    pub fn like(&self) -> Result<Like, Error> {
        let mut features = self.columns(Subset::Features)?;
        features.retain(|column| column.role == Some(Role::Feature));
        Ok(Like {
            features,
            sample_rate_hz: self.plan.settings.sample_rate,
            revolutions: self.revolutions_per_window(),
            motion: self.plan.chaos,
            machine: KnownMachine::from_resolved(&self.plan.base),
        })
    }
}

impl Like {
    /// Of the dataset in `folder`.
    ///
    /// # Errors
    /// A folder that is no whole dataset.
    pub fn read(folder: &Path) -> Result<Self, Error> {
        Dataset::read(folder)?.like()
    }

    /// Says of recordings what the dataset knows: whether their motion is judged, and the machine where nobody names another.
    pub fn say(&self, said: &mut Said) {
        said.motion = self.motion;
        said.machine.get_or_insert_with(|| self.machine.clone());
    }

    /// How recordings are cut.
    pub fn length(&self) -> WindowLength {
        WindowLength::RevolutionsOrRows(self.revolutions.into())
    }

    /// The columns of a table of features that stays: what describes a window, then the features of the dataset. Each
    /// with its place in the table.
    ///
    /// # Errors
    /// [`Unlike::Channels`] where the table lacks some of these features.
    pub fn columns(&self, table: &Schema) -> Result<Vec<usize>, Unlike> {
        let columns = table.columns().iter().enumerate();
        let own = columns.filter(|(_, column)| column.role != Some(Role::Feature));
        let mut kept: Vec<usize> = own.map(|(i, _)| i).collect();
        let mut missing = 0;
        for feature in &self.features {
            match table.position(&feature.name) {
                Ok(position) => kept.push(position),
                Err(_) => missing += 1,
            }
        }
        match missing {
            0 => Ok(kept),
            missing => Err(Unlike::Channels {
                found: channels(table.columns()),
                expected: channels(&self.features),
                missing,
            }),
        }
    }

    /// Checks rate and length of a window by its row.
    ///
    /// # Errors
    /// [`Unlike::Rate`] and [`Unlike::Window`].
    pub fn check(&self, row: &Row) -> Result<(), Unlike> {
        let [
            Value::Text(file),
            _,
            _,
            Value::Real(duration),
            Value::Real(rate),
            speed,
            ..,
        ] = row.values.as_slice()
        else {
            return Ok(());
        };
        if (rate / self.sample_rate_hz - 1.0).abs() > RATE {
            return Err(Unlike::Rate {
                file: file.clone(),
                found: *rate,
                expected: self.sample_rate_hz,
            });
        }
        let Value::Real(rpm) = speed else {
            return Ok(());
        };
        let revolutions = duration * rpm.abs() / 60.0;
        if (revolutions - f64::from(self.revolutions)).abs() > 0.5 {
            return Err(Unlike::Window {
                file: file.clone(),
                found: revolutions,
                expected: self.revolutions,
            });
        }
        Ok(())
    }
}

/// The channels that features are of, by what stands before the last point of their names.
fn channels(columns: &[Column]) -> Vec<String> {
    let features = columns.iter().filter(|c| c.role == Some(Role::Feature));
    let names = features.filter_map(|column| column.name.rsplit_once('.'));
    let names: BTreeSet<&str> = names.map(|(channel, _)| channel).collect();
    names.into_iter().map(str::to_owned).collect()
}
