//! The machine that recordings are of, as far as an indicator needs it.

use super::units::{Role, Scaled};
use input::Resolved;
use input::bundle::Bundle;
use input::bundle_channel::{Channel, Meaning, meaning};
use simulate::Chamber;
use std::path::Path;
use std::sync::Arc;

/// The chambers of a machine.
#[derive(Clone, Debug)]
pub struct KnownMachine {
    chambers: Arc<Vec<Chamber>>,
    throws: Vec<String>,
}

impl KnownMachine {
    /// The machine of a machine file.
    ///
    /// # Errors
    /// A file that cannot be read, or that describes no machine.
    pub fn read(path: &Path) -> Result<Self, input::Error> {
        Ok(Self::from_resolved(
            &input::machine_file::read(path)?.resolve()?,
        ))
    }

    /// This machine.
    pub fn from_resolved(machine: &Resolved) -> Self {
        let machine = &machine.machine;
        Self {
            chambers: Arc::new(Chamber::of_machine(machine)),
            throws: machine.throws.iter().map(|t| t.name.clone()).collect(),
        }
    }

    /// The machine of a run of a bundle, or why its section gives none; none where the bundle has no section.
    pub(super) fn of_run(bundle: &Bundle, index: usize) -> Option<Result<Self, String>> {
        let machine = input::machine_of_run(bundle, index).transpose()?;
        Some(match machine {
            Ok(machine) => Ok(Self::from_resolved(&machine)),
            Err(error) => Err(error.to_string().replace('\n', "; ")),
        })
    }

    /// The names of its throws; one empty name for a machine of one.
    pub(super) fn throws(&self) -> &[String] {
        &self.throws
    }

    /// The chambers whose pressures are among these channels of a file, each under the name of its
    /// channel.
    pub(super) fn chambers_of(&self, channels: &[Scaled]) -> Vec<Chamber> {
        let throws: Vec<&str> = self.throws.iter().map(String::as_str).collect();
        let measured = channels.iter().filter(|c| c.role == Role::Measured);
        let pressures = measured.filter(|c| c.unit == "Pa");
        let chamber = |channel: &Scaled| {
            let stated = channel.column.clone();
            let column = stated.or_else(|| by_name(&channel.name, &throws))?;
            let chamber = self.chambers.iter().find(|c| c.column == column)?;
            Some(chamber.named(&channel.name))
        };
        pressures.filter_map(chamber).collect()
    }
}

/// The model's column of a pressure with this name, in words or as this program writes it.
fn by_name(name: &str, throws: &[&str]) -> Option<String> {
    let channel = |column: String| Channel {
        name: name.to_owned(),
        column,
        file: None,
        unit: "Pa".to_owned(),
        offset: None,
        crank_angle_rad: None,
    };
    // The name comes without its unit, the model's columns end in theirs.
    [format!("{name}_pa"), name.to_owned()]
        .into_iter()
        .find_map(|column| match meaning(&channel(column), throws) {
            Ok(Meaning::Measured { column, .. }) => Some(column),
            _ => None,
        })
}
