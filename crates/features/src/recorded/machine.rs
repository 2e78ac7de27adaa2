//! The machine that recordings are of, as far as an indicator needs it.

use super::units::{Role, Scaled};
use input::bundle::Bundle;
use input::bundle_channel::{Channel, Meaning, meaning};
use input::{MachineFile, Resolved};
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
        Self::new(&input::machine_file::read(path)?)
    }

    /// This machine.
    pub fn from_resolved(machine: &Resolved) -> Self {
        let machine = &machine.machine;
        Self {
            chambers: Arc::new(Chamber::of_machine(machine)),
            throws: machine.throws.iter().map(|t| t.name.clone()).collect(),
        }
    }

    /// The machine section of a bundle. One that is missing, or does not say enough for a simulation, is
    /// no mistake here: only the indicated power needs it.
    pub(super) fn of_bundle(bundle: &Bundle) -> Option<Self> {
        let tree = input::from_bundle(&bundle.machine).ok()?;
        Self::new(&MachineFile::from_tree(&tree).ok()?).ok()
    }

    fn new(file: &MachineFile) -> Result<Self, input::Error> {
        Ok(Self::from_resolved(&file.resolve()?))
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
