//! How the results of a verb are printed: a summary for people, or one JSON document for programs.

use crate::Failure;
use crate::output::{hint, make_folder, refuse_existing, write_json};
use ::report::{Rendered, write_page};
use clap::Args;
use serde::Serialize;
use std::fmt::Display;
use std::path::{Path, PathBuf};

/// The option of every verb that has results.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct ResultFormat {
    /// Print the results as one JSON document in place of the summary; messages stay on standard error
    #[arg(long)]
    pub(crate) json: bool,
}

impl ResultFormat {
    /// Prints `results` on standard output: as JSON, as the file of results has them, or as `summary` has it.
    ///
    /// # Errors
    /// Results that JSON cannot hold.
    pub(crate) fn print(
        self,
        results: &impl Serialize,
        summary: impl Display,
    ) -> Result<(), Failure> {
        match self.json {
            true => println!("{}", serde_json::to_string_pretty(results)?),
            false => print!("{summary}"),
        }
        Ok(())
    }

    /// Prints what was found, which is `reused` where it was there before, and the two `files` to look at.
    ///
    /// # Errors
    /// Results that JSON cannot hold.
    pub(crate) fn print_found(
        self,
        results: &(impl Serialize + Display),
        reused: bool,
        files: [&Path; 2],
    ) -> Result<(), Failure> {
        let before = match reused {
            true => "nothing has changed since this was found:\n",
            false => "",
        };
        let [first, second] = files.map(Path::display);
        let summary = format_args!("{before}{results}{first}\n{second}\n");
        self.print(results, summary)
    }
}

/// The two files of results in a folder: NAME.json and the page NAME.html.
pub(crate) struct ResultFiles {
    json: PathBuf,
    page: PathBuf,
}

impl ResultFiles {
    /// In the folder `out`.
    ///
    /// # Errors
    /// Results that are there and may not be replaced.
    pub(crate) fn new(out: &Path, name: &str, overwrite: bool) -> Result<Self, Failure> {
        let json = out.join(name).with_extension("json");
        refuse_existing([&json], overwrite, "--out DIR")?;
        let page = json.with_extension("html");
        Ok(Self { json, page })
    }

    /// Writes results and page, and prints the results.
    ///
    /// # Errors
    /// Files that cannot be written.
    pub(crate) fn write(
        &self,
        results: &impl Serialize,
        page: &Rendered,
        format: ResultFormat,
        summary: &str,
    ) -> Result<(), Failure> {
        make_folder(self.json.parent().unwrap_or(Path::new("")))?;
        write_json(&self.json, results)?;
        write_page(&self.page, &page.html)?;
        let [json, page] = [&self.json, &self.page].map(|file| file.display());
        format.print(results, format_args!("{summary}{json}\n{page}\n"))?;
        hint(format_args!("open {page} in a browser"));
        Ok(())
    }
}
