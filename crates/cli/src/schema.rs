//! `crosshead schema`: the JSON Schema of a file that people write.

use crate::Failure;
use crate::output::hint;
use clap::{Args, ValueEnum};

/// Arguments of `crosshead schema`.
#[derive(Args, Debug)]
#[command(after_help = "Example:\n  crosshead schema machine > machine.schema.json")]
pub struct Arguments {
    /// Which file
    file: File,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum File {
    /// machine.yaml: a compressor
    Machine,
    /// sweep.yaml: the cases of a dataset
    Sweep,
    /// recordings.yaml: a bundle of measured runs
    Bundle,
    /// calibration.yaml: what is fitted to a bundle
    Calibration,
    /// hidden-effects.yaml: a test bench of effects hidden in recordings
    HiddenEffects,
}

/// Prints the schema.
///
/// # Errors
/// None in practice: a schema is always writable as JSON.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let schema = match arguments.file {
        File::Machine => input::schema::machine_schema(),
        File::Sweep => sweep::sweep_file::schema(),
        File::Bundle => input::schema::bundle_schema(),
        File::Calibration => input::calibration::schema(),
        File::HiddenEffects => bench::settings::schema(),
    };
    let text = serde_json::to_string_pretty(&schema).map_err(Failure::work)?;
    println!("{text}");
    hint(format_args!(
        "save it, and begin your file with `# yaml-language-server: $schema=FILE`"
    ));
    Ok(())
}
