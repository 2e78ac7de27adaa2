//! What datasets and diagrams may be called: their names are those of folders and files.

use input::Error;

/// Longest name, in characters: file systems allow 255 bytes, and a character takes up to four.
const LONGEST: usize = 60;

/// Checks the name of a dataset: it is a folder in `datasets/` on any system.
pub(super) fn check_dataset(name: &str) -> Result<(), Error> {
    let inner = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | '.' | ' ');
    let is_sound = name.starts_with(char::is_alphanumeric)
        && !name.ends_with(['.', ' '])
        && name.chars().all(inner)
        && name.chars().count() <= LONGEST;
    if is_sound {
        return Ok(());
    }
    let found = format_args!("'{}'", name.escape_debug());
    let expected = format_args!(
        "the name of a folder: a letter or digit, then letters, digits, '-', '_', '.' and spaces, \
         {LONGEST} characters at most, e.g. bearing-faults"
    );
    Err(Error::unexpected("name", found, expected))
}

/// Checks the name of a bifurcation diagram, which is part of file names and of object keys.
pub(super) fn check_diagram(name: &str) -> Result<(), Error> {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    if !name.is_empty() && name.chars().all(plain) {
        return Ok(());
    }
    let found = format_args!("'{name}'");
    let expected = "letters, digits, '-' and '_', e.g. big-end-clearance";
    Err(Error::unexpected("name", found, expected))
}
