//! Values of an argument, each with its help.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use input::file_kind::{FileKind, MACHINE_FILE};

/// The kinds of files that people write. A file of unknown keys is taken for the first.
pub(crate) const KINDS: [FileKind; 5] = [
    MACHINE_FILE,
    sweep::calibration::SWEEP_FILE,
    calibrate::check::BUNDLE,
    calibrate::check::CALIBRATION,
    bench::settings::HIDDEN_EFFECTS,
];

/// One of `choices`: the name, what the help says of it, and the value.
pub(crate) fn one_of<T: Clone + Send + Sync + 'static>(
    choices: impl IntoIterator<Item = (&'static str, impl Into<String>, T)>,
) -> impl TypedValueParser<Value = T> {
    let (names, values): (Vec<_>, Vec<_>) = choices
        .into_iter()
        .map(|(name, help, value)| (PossibleValue::new(name).help(help.into()), (name, value)))
        .unzip();
    PossibleValuesParser::new(names).try_map(move |name| {
        let chosen = values.iter().find(|(own, _)| *own == name);
        chosen.map(|(_, value)| value.clone()).ok_or("no choice")
    })
}

/// One of `kinds` of files, each with a value.
pub(crate) fn kind_of<T: Clone + Send + Sync + 'static>(
    kinds: impl IntoIterator<Item = (FileKind, T)>,
) -> impl TypedValueParser<Value = (FileKind, T)> {
    one_of(kinds.into_iter().map(|(kind, value)| {
        let help = format!("{}: {}", kind.file, kind.content);
        (kind.name, help, (kind, value))
    }))
}
