//! The bundles that settings name, and their runs.

use super::settings::Settings;
use crate::bundle;
use crate::error::Error;
use crate::observation::Run;
use input::bundle::Bundle;
use input::bundle_channel::Meaning;
use serde_json::Value;

/// A bundle, and what its runs are called in front.
pub(super) struct Listed {
    pub(super) bundle: Bundle,
    prefix: String,
}

/// The bundles in the order of the settings.
///
/// # Errors
/// A bundle that cannot be read, or several with the same name or of different machines.
pub(super) fn read(settings: &Settings) -> Result<Vec<Listed>, Error> {
    let paths = settings.calibration.bundles();
    let mut listed: Vec<Listed> = Vec::new();
    for path in paths {
        let mut bundle = Bundle::read(&settings.base.join(path))?;
        bundle.allow_outside = settings.allow_outside;
        let name = path
            .file_name()
            .unwrap_or(path.as_os_str())
            .to_string_lossy();
        let prefix = match paths.len() {
            1 => String::new(),
            _ => format!("{name}/"),
        };
        let bundle_file = |b: &Bundle| b.folder.join(input::bundle::FILE).display().to_string();
        if listed.iter().any(|other| other.prefix == prefix) {
            return Err(Error::Refused(format!(
                "two bundles are called {name}: give their folders different names"
            )));
        }
        if let Some(first) = listed.first()
            && !settings.has_machine_file()
            && first.bundle.machine != bundle.machine
        {
            return Err(Error::Refused(format!(
                "{} and {} have different machine sections: give the machine file that holds for both",
                bundle_file(&first.bundle),
                bundle_file(&bundle)
            )));
        }
        listed.push(Listed { bundle, prefix });
    }
    Ok(listed)
}

impl Listed {
    /// The runs, each with what its channels are.
    ///
    /// # Errors
    /// A run that cannot be read, or a name that no run has.
    pub(super) fn runs(
        &self,
        settings: &Settings,
        tree: &Value,
    ) -> Result<Vec<(Run, Vec<Meaning>)>, Error> {
        let known: Vec<&str> = self.bundle.runs.iter().map(|run| run.id.as_str()).collect();
        let named = settings.calibration.leave_out.iter();
        let own = named.filter_map(|id| id.strip_prefix(&self.prefix));
        let own: Vec<String> = own.map(str::to_owned).collect();
        if let Some(unknown) = own.iter().find(|id| !known.contains(&id.as_str())) {
            let error = input::Error::unknown_name("leave_out", unknown, &known);
            return Err((settings.locate)(error).into());
        }
        let kept = (0..known.len()).filter(|i| !own.iter().any(|id| id == known[*i]));
        let runs = bundle::runs(&self.bundle, tree, &own)?;
        let runs = runs.into_iter().zip(kept).map(|(mut run, i)| {
            run.id = format!("{}{}", self.prefix, run.id);
            Ok((run, self.bundle.meanings(i, tree)?))
        });
        runs.collect()
    }
}
