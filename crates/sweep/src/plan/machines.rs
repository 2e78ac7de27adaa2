//! The machine files that a sweep names, each read once.

use input::yaml::Document;
use input::{Error, MachineFile, Resolved};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// What a sweep names as its machine.
pub(super) struct Machines {
    /// The folder that paths start from.
    pub(super) folder: PathBuf,
    /// What the sweep file says of its machine.
    stated: Value,
    /// The file that was read, and the machine that it describes: without its mistakes, if it has some.
    read: Option<(String, Option<(MachineFile, Resolved)>)>,
    mistakes: Option<Error>,
}

impl Machines {
    /// The machine files of a sweep in `folder` whose file says `stated` of its machine.
    pub(super) fn new(folder: &Path, stated: &Value) -> Self {
        Self {
            folder: folder.to_owned(),
            stated: stated.clone(),
            read: None,
            mistakes: None,
        }
    }

    /// The machine of the file at `path`. Its mistakes are put aside, so that the sweep can be checked against what
    /// is right in it.
    pub(super) fn at(&mut self, path: &str) -> Result<(MachineFile, Resolved), Error> {
        // Nobody wrote another path: it stands for one that is missing.
        if self.stated.as_str() != Some(path) {
            return Err(Error::missing("machine"));
        }
        if self.read.as_ref().is_none_or(|(read, _)| read != path) {
            let document = Document::open(&self.folder.join(path))?;
            let (machine, mistakes) = MachineFile::checked(document);
            self.read = Some((path.to_owned(), machine));
            self.mistakes = mistakes;
        }
        let machine = self.read.as_ref().and_then(|(_, machine)| machine.clone());
        machine.ok_or_else(|| {
            let none = || Error::clash("machine", "a machine file without mistakes");
            self.mistakes().unwrap_or_else(none)
        })
    }

    /// The mistakes of the machine file.
    pub(super) fn mistakes(&self) -> Option<Error> {
        self.mistakes.clone()
    }
}
