//! The kinds of files that people write, and all mistakes of one of them.

use crate::bundle::{self, Bundle};
use crate::schema::{closest, machine_schema};
use crate::yaml::Document;
use crate::{Error, MachineFile, Problem};
use serde::Serialize;
use serde_json::Value;
use std::fmt::{self, Display, Formatter};
use std::path::{Path, PathBuf};

/// A kind of file that people write.
#[derive(Clone, Copy, Debug)]
pub struct FileKind {
    /// Its name.
    pub name: &'static str,
    /// What such a file is called.
    pub file: &'static str,
    /// What is in it.
    pub content: &'static str,
    /// The kind with an article, of a file of any name.
    pub words: &'static str,
    /// Its JSON Schema.
    pub schema: fn() -> Value,
    /// Finds all mistakes of a file with this content in this folder.
    pub check: fn(&Path, Document) -> Result<(), Error>,
    /// The recordings that the file at this path names.
    pub recordings: fn(&Path) -> Vec<PathBuf>,
}

/// machine.yaml.
pub const MACHINE_FILE: FileKind = FileKind {
    name: "machine",
    file: "machine.yaml",
    content: "a compressor",
    words: "a machine",
    schema: machine_schema,
    check: |_, document| MachineFile::from_document(document)?.resolve().map(drop),
    recordings: |_| Vec::new(),
};

/// What was found in a file; as text what is good of it, and what it names that is not there.
#[derive(Clone, Debug, Serialize)]
pub struct Checked {
    /// The file.
    pub file: PathBuf,
    /// What kind of file it is.
    pub kind: &'static str,
    /// All of them.
    pub mistakes: Vec<Mistake>,
    /// Recordings that it names and that are not there.
    pub not_there_yet: Vec<PathBuf>,
}

/// A mistake; as text the whole message.
#[derive(Clone, Debug, Serialize)]
pub struct Mistake {
    /// Another file where that is wrong which the file names.
    pub file: String,
    line: Option<u64>,
    column: Option<u64>,
    key: String,
    /// What was found and what was expected.
    problem: String,
    #[serde(skip)]
    message: String,
}

/// Checks the file at `path`, or the bundle in that folder. Its keys show which of `kinds` it is, the first where none
/// do.
///
/// # Errors
/// A file that cannot be read.
pub fn check_file(path: &Path, kinds: &[FileKind]) -> Result<Checked, Error> {
    let file = match path.is_dir() {
        true => path.join(bundle::FILE),
        false => path.to_owned(),
    };
    let (kind, error) = match Document::open(&file) {
        Ok(document) => {
            let kind = kind_of(&file, &document.tree, kinds);
            let folder = file.parent().unwrap_or(Path::new(""));
            (Some(kind), (kind.check)(folder, document).err())
        }
        Err(error) if matches!(error.problem(), Problem::Unreadable(_)) => return Err(error),
        Err(error) => (None, Some(error)),
    };
    let own = file.display().to_string();
    let mistakes = error.map_or(Vec::new(), Error::into_each).into_iter();
    let mistakes: Vec<Mistake> = mistakes.map(|error| Mistake::new(&error, &own)).collect();
    let mut not_there_yet = match kind {
        Some(kind) if mistakes.is_empty() => (kind.recordings)(&file),
        _ => Vec::new(),
    };
    not_there_yet.retain(|recording| !recording.exists());
    Ok(Checked {
        file,
        kind: kind.map_or("not YAML", |kind| kind.words),
        mistakes,
        not_there_yet,
    })
}

fn kind_of<'a>(file: &Path, tree: &Value, kinds: &'a [FileKind]) -> &'a FileKind {
    let named = kinds.iter().find(|kind| kind.file == bundle::FILE);
    named.filter(|_| Bundle::is_at(file)).unwrap_or_else(|| {
        let schemas: Vec<Value> = kinds.iter().map(|kind| (kind.schema)()).collect();
        &kinds[closest(tree, &schemas).unwrap_or(0)]
    })
}

impl Mistake {
    /// That of `error` in the file `own`, or in one that it names.
    fn new(error: &Error, own: &str) -> Self {
        Self {
            file: error.file().unwrap_or(own).to_owned(),
            line: error.place().map(|place| place.line),
            column: error.place().map(|place| place.column),
            key: error.key().to_owned(),
            problem: error.problem().to_string(),
            message: error.to_string(),
        }
    }
}

impl Display for Mistake {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl Display for Checked {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        if self.mistakes.is_empty() {
            writeln!(f, "{}: {}, no mistakes", self.file.display(), self.kind)?;
        }
        let mut missing = self.not_there_yet.iter();
        missing.try_for_each(|file| writeln!(f, "  {} is not there yet", file.display()))
    }
}
