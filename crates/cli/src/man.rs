//! `crosshead man`: the manual pages.

use crate::Failure;
use crate::output::{hint, make_folder};
use clap::{Args, Command};
use clap_mangen::Man;
use recordings::WholeFile;
use std::path::{Path, PathBuf};

#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  crosshead man --out ~/.local/share/man/man1
  crosshead man --out man && man -l man/crosshead-simulate.1")]
pub struct Arguments {
    /// Folder to write into: a page for each program and verb; pages that are there are replaced
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

pub(crate) fn run(
    arguments: &Arguments,
    commands: impl IntoIterator<Item = Command>,
) -> Result<(), Failure> {
    let out = &arguments.out;
    make_folder(out)?;
    let mut written = 0;
    for mut command in commands {
        command.build();
        written += write(&command, out)?;
    }
    println!("{}: {written} pages", out.display());
    hint(format_args!("man -l {}", out.join("crosshead.1").display()));
    Ok(())
}

/// The page of a command and those of its verbs; how many they are.
fn write(command: &Command, out: &Path) -> Result<usize, Failure> {
    let name = command.get_display_name().unwrap_or(command.get_name());
    let page = Man::new(command.clone());
    let path = out.join(page.get_filename());
    let mut text = Vec::new();
    let rendered = page.title(name.to_uppercase()).render(&mut text);
    rendered.map_err(|error| Failure::unwritten(&path, error))?;
    WholeFile::write(&path, &String::from_utf8_lossy(&text))?;
    let verbs = command.get_subcommands().filter(|verb| {
        // The verb `help` says what the pages say.
        !verb.is_hide_set() && verb.get_name() != "help"
    });
    let below = verbs.map(|verb| write(verb, out));
    Ok(1 + below.sum::<Result<usize, Failure>>()?)
}
