//! `crosshead completions`: a script with which a shell completes verbs, options and their values.

use crate::Failure;
use crate::output::bytes;
use clap::{Args, Command};
use clap_complete::{Shell, generate};

#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  crosshead completions bash > ~/.local/share/bash-completion/completions/crosshead
  crosshead completions zsh > ~/.zfunc/_crosshead
  crosshead completions fish > ~/.config/fish/completions/crosshead.fish
  crosshead completions bash --program gen-dataset \\
      > ~/.local/share/bash-completion/completions/gen-dataset")]
pub struct Arguments {
    /// The shell
    shell: Shell,
    /// The program
    #[arg(long, default_value = "crosshead", value_parser = ["crosshead", "gen-dataset"])]
    program: String,
}

pub(crate) fn run(
    arguments: &Arguments,
    commands: impl IntoIterator<Item = Command>,
) -> Result<(), Failure> {
    let name = &arguments.program;
    let command = commands.into_iter().find(|c| c.get_name() == name);
    let mut command =
        command.ok_or_else(|| Failure::input(format!("--program: there is no {name}")))?;
    let mut script = Vec::new();
    generate(arguments.shell, &mut command, name, &mut script);
    bytes(&script);
    Ok(())
}
