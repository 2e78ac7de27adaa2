//! `README.md` of a dataset: what is in it, for people, and the front matter by which Hugging Face
//! `datasets` finds its tables.

mod columns;
mod front_matter;
#[cfg(test)]
mod tests;
mod text;

use crate::{Licence, Schema};
use std::collections::BTreeMap;
use std::fmt::{self, Display, Formatter};
use text::{code, plain};

/// The column of the fault.
const FAULT: &str = "fault";

/// What the card of a dataset says; [`Display`] writes it.
#[derive(Clone, Debug)]
pub struct DatasetCard {
    /// Title, in a few words.
    pub title: String,
    /// What the dataset is, in a paragraph.
    pub summary: String,
    /// The licence; none where its publisher has still to choose one.
    pub licence: Option<Licence>,
    /// What it is for, a line each.
    pub uses: Vec<String>,
    /// What it does not hold or show, a line each.
    pub limits: Vec<String>,
    /// Words by which to find it.
    pub tags: Vec<String>,
    /// The machine: names and values, in the order in which to show them.
    pub machine: Vec<(String, String)>,
    /// Rows by split, then by fault: `rows["train"]["big_end"]`, the same in every table. Splits
    /// without rows are shown but not offered: `datasets` refuses a dataset that has one.
    pub rows: BTreeMap<String, BTreeMap<String, u64>>,
    /// The tables; the first is the one that is loaded when none is named.
    pub subsets: Vec<Subset>,
    /// Tables that are not divided into splits, in files `NAME/*.parquet`.
    pub unsplit: Vec<Subset>,
    /// One MCAP file, where there are such: `mcap/CASE.mcap`.
    pub mcap_example: Option<String>,
    /// The command that makes the dataset again.
    pub command: String,
    /// Version of the program that made it.
    pub version: String,
}

/// One table of a dataset, in files `NAME/SPLIT-*.parquet` or `NAME/*.parquet`.
#[derive(Clone, Debug)]
pub struct Subset {
    /// `signals`, `features`.
    pub name: String,
    /// The columns.
    pub schema: Schema,
}

impl Display for DatasetCard {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        self.front_matter(f)?;
        writeln!(f, "\n# {}\n\n{}", plain(&self.title), plain(&self.summary))?;
        self.list(f, "Intended use", &self.uses)?;
        self.list(f, "Limits", &self.limits)?;
        self.machine(f)?;
        self.counts(f)?;
        self.loading(f)?;
        self.columns(f)?;
        writeln!(
            f,
            "\n## How it was made\n\nBy version {} of the program:\n",
            plain(&self.version)
        )?;
        writeln!(f, "```sh\n{}\n```\n", self.command)?;
        writeln!(
            f,
            "`sweep.yaml` holds the machine, the sweep and the seed: running it again gives the \
             same bytes.\n`manifest.json` lists the files with their checksums, and the cases that \
             failed.\n`croissant.json` describes the dataset to programs (Croissant 1.0)."
        )?;
        writeln!(f, "\n## Licence\n")?;
        match self.licence {
            Some(licence) => writeln!(f, "[{}]({})", licence.spdx, licence.url()),
            None => writeln!(
                f,
                "None is chosen: `licence: CC-BY-4.0` in the sweep file chooses one."
            ),
        }
    }
}

impl DatasetCard {
    fn list(&self, f: &mut Formatter, title: &str, lines: &[String]) -> fmt::Result {
        if lines.is_empty() {
            return Ok(());
        }
        writeln!(f, "\n## {title}\n")?;
        lines.iter().try_for_each(|line| writeln!(f, "- {line}"))
    }

    /// The faults that have rows: `none` first, then by name.
    pub(crate) fn faults(&self) -> Vec<&str> {
        let mut faults: Vec<&str> = self
            .rows
            .values()
            .flat_map(BTreeMap::keys)
            .map(String::as_str)
            .collect();
        faults.sort_by_key(|fault| (*fault != "none", *fault));
        faults.dedup();
        faults
    }

    fn machine(&self, f: &mut Formatter) -> fmt::Result {
        if self.machine.is_empty() {
            return Ok(());
        }
        writeln!(f, "\n## The machine\n\n| quantity | value |\n|---|---|")?;
        for (name, value) in &self.machine {
            writeln!(f, "| {} | {} |", plain(name), plain(value))?;
        }
        Ok(())
    }

    fn counts(&self, f: &mut Formatter) -> fmt::Result {
        let splits = in_order(self.rows.keys());
        writeln!(f, "\n## What is in it\n\nRows by fault and split:\n")?;
        let names: Vec<_> = splits.iter().map(|split| plain(split)).collect();
        writeln!(f, "| fault | {} | all |", names.join(" | "))?;
        writeln!(f, "|---|{}---|", "---|".repeat(splits.len()))?;
        for fault in self.faults() {
            let rows: Vec<_> = splits
                .iter()
                .map(|s| self.rows[*s].get(fault).copied().unwrap_or(0))
                .collect();
            writeln!(
                f,
                "| {} | {} | {} |",
                code(fault),
                join(&rows),
                rows.iter().sum::<u64>()
            )?;
        }
        let rows: Vec<_> = splits
            .iter()
            .map(|split| self.rows[*split].values().sum())
            .collect();
        writeln!(f, "| all | {} | {} |", join(&rows), self.total())
    }

    fn total(&self) -> u64 {
        self.rows.values().flat_map(BTreeMap::values).sum()
    }

    fn splits_with_rows(&self) -> Vec<&str> {
        let splits = self
            .rows
            .iter()
            .filter(|(_, faults)| faults.values().sum::<u64>() > 0);
        in_order(splits.map(|(split, _)| split))
    }

    fn loading(&self, f: &mut Formatter) -> fmt::Result {
        writeln!(
            f,
            "\n## How to load it\n\nFrom within this folder, in Python:"
        )?;
        if let Some(split) = self.splits_with_rows().first() {
            for Subset { name, .. } in &self.subsets {
                load(f, name, split, &format!("{split}-*.parquet"))?;
            }
            for Subset { name, .. } in &self.unsplit {
                // What has no splits is one split of this name to `datasets`.
                load(f, name, "train", "*.parquet")?;
            }
        }
        let Some(example) = &self.mcap_example else {
            return Ok(());
        };
        writeln!(
            f,
            "
```python
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
with open(\"{example}\", \"rb\") as file:
    reader = make_reader(file, decoder_factories=[DecoderFactory()])
    labels = next(record.metadata for record in reader.iter_metadata() if record.name == \"labels\")
    samples = [message for _, _, _, message in reader.iter_decoded_messages(topics=[\"{topic}\"])]
```

Foxglove opens the files of `mcap/` as they are: add a Plot panel and drag a channel of
`{topic}` into it. The labels are the metadata record `labels`.",
            topic = crate::formats::mcap::TOPIC,
        )
    }
}

/// How to load the table `name`, or of some readers a part of it.
fn load(f: &mut Formatter, name: &str, split: &str, files: &str) -> fmt::Result {
    writeln!(
        f,
        "
```python
import os, datasets, pandas, polars, pyarrow.dataset
{name} = datasets.load_dataset(os.getcwd(), \"{name}\")[\"{split}\"]
{name} = pandas.read_parquet(\"{name}\")      # every split; units in {name}.attrs[\"units\"]
{name} = polars.scan_parquet(\"{name}/{files}\").collect()
{name} = pyarrow.dataset.dataset(\"{name}\").to_table()
```"
    )
}

/// Splits in the order of use: train, validation, test, then any other by name.
fn in_order<'a>(splits: impl Iterator<Item = &'a String>) -> Vec<&'a str> {
    let known = ["train", "validation", "test"];
    let place = |split: &str| {
        known
            .iter()
            .position(|k| *k == split)
            .unwrap_or(known.len())
    };
    let mut splits: Vec<_> = splits.map(String::as_str).collect();
    splits.sort_by_key(|split| (place(split), *split));
    splits
}

fn join(numbers: &[u64]) -> String {
    let numbers: Vec<_> = numbers.iter().map(u64::to_string).collect();
    numbers.join(" | ")
}
