//! `crosshead schema`: the JSON Schema of a file that people write.

use crate::Failure;
use crate::choice::{KINDS, kind_of};
use crate::output::hint;
use clap::Args;
use input::file_kind::FileKind;

#[derive(Args, Debug)]
#[command(after_help = "Example:\n  crosshead schema machine > machine.schema.json")]
pub struct Arguments {
    /// Which file
    #[arg(value_parser = kind_of(KINDS.map(|kind| (kind, ()))))]
    file: (FileKind, ()),
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let schema = (arguments.file.0.schema)();
    println!("{}", serde_json::to_string_pretty(&schema)?);
    hint(format_args!(
        "save it, and begin your file with `# yaml-language-server: $schema=FILE`"
    ));
    Ok(())
}
