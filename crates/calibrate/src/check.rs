//! All mistakes of the files that say what is calibrated to which recordings.

use crate::bundle::wrong_columns;
use crate::check_settings;
use input::Error;
use input::bundle::{self, Bundle};
use input::calibration::{self, Calibration};
use input::file_kind::FileKind;
use input::schema::bundle_schema;
use input::yaml::Document;
use std::path::{Path, PathBuf};

/// recordings.yaml.
pub const BUNDLE: FileKind = FileKind {
    name: "bundle",
    file: bundle::FILE,
    content: "a bundle of measured runs",
    words: "a bundle of recordings",
    schema: bundle_schema,
    check: |folder, document| check_bundle(folder, &document),
    recordings: |path| Bundle::read(path).map_or(Vec::new(), |bundle| recordings(&bundle)),
};

/// calibration.yaml.
pub const CALIBRATION: FileKind = FileKind {
    name: "calibration",
    file: "calibration.yaml",
    content: "what is fitted to a bundle",
    words: "settings of a calibration",
    schema: calibration::schema,
    check: check_calibration,
    recordings: |path| {
        Calibration::read(path).map_or(Vec::new(), |(settings, _)| bundles(path, &settings))
    },
};

/// Checks a `recordings.yaml`, and whether the recordings that are there have the columns that it names.
fn check_bundle(folder: &Path, document: &Document) -> Result<(), Error> {
    input::check_bundle(folder, document)?;
    let bundle = Bundle::new(folder, document.clone())?;
    Error::all(wrong_columns(&bundle)).map_or(Ok(()), Err)
}

/// Checks settings of a calibration, and the machine and the recordings that they name.
fn check_calibration(folder: &Path, document: Document) -> Result<(), Error> {
    let settings = Calibration::checked(&document, check_settings)?;
    let machine = settings.machine.as_ref().map(|path| {
        let read = input::machine_file::read(&folder.join(path));
        read.and_then(|machine| machine.resolve()).err()
    });
    let bundles = settings.bundles().iter().map(|path| folder.join(path));
    let bundles = bundles.filter(|path| Bundle::is_at(path)).map(|path| {
        let document = Document::open(&path.join(bundle::FILE));
        document.and_then(|own| check_bundle(&path, &own)).err()
    });
    let wrong = machine.into_iter().chain(bundles).flatten();
    Error::all(wrong).map_or(Ok(()), Err)
}

fn recordings(bundle: &Bundle) -> Vec<PathBuf> {
    let files = bundle.runs.iter().flat_map(|run| run.recordings());
    files.map(|(file, _)| bundle.folder.join(file)).collect()
}

fn bundles(path: &Path, settings: &Calibration) -> Vec<PathBuf> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let bundles = settings.bundles().iter();
    bundles.map(|bundle| folder.join(bundle)).collect()
}
