//! How the results of a verb are printed: a summary for people, or one JSON document for programs.

use crate::Failure;
use clap::Args;
use serde::Serialize;

/// The option of every verb that has results.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct ResultFormat {
    /// Print the results as one JSON document in place of the summary; messages stay on standard error
    #[arg(long)]
    json: bool,
}

impl ResultFormat {
    /// Prints `results` on standard output: as JSON, as the file of results has them, or by `summary`.
    ///
    /// # Errors
    /// Results that JSON cannot hold.
    pub(crate) fn print<T: Serialize>(
        self,
        results: &T,
        summary: impl FnOnce(&T),
    ) -> Result<(), Failure> {
        match self.json {
            true => {
                let text = serde_json::to_string_pretty(results).map_err(Failure::work)?;
                println!("{text}");
            }
            false => summary(results),
        }
        Ok(())
    }
}
