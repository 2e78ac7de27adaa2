//! `README.md` of a dataset: what is in it, for people, and the front matter by which Hugging Face
//! `datasets` finds its tables.

use crate::{Role, Schema};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt::{self, Display, Formatter};

/// What the card of a dataset says; [`Display`] writes it.
#[derive(Clone, Debug)]
pub struct DatasetCard {
    /// Title, in a few words.
    pub title: String,
    /// What the dataset is, in a paragraph.
    pub summary: String,
    /// Identifier of the licence: `cc0-1.0`, `cc-by-4.0`.
    pub license: String,
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
             failed."
        )
    }
}

impl DatasetCard {
    /// YAML between two lines of dashes. Strings are quoted as in JSON, which YAML contains.
    fn front_matter(&self, f: &mut Formatter) -> fmt::Result {
        writeln!(f, "---\npretty_name: {}", yaml(&self.title))?;
        writeln!(
            f,
            "license: {}\ntags: [{}]",
            yaml(&self.license),
            self.tags
                .iter()
                .map(|tag| yaml(tag))
                .collect::<Vec<_>>()
                .join(", ")
        )?;
        writeln!(
            f,
            "size_categories: [{}]",
            yaml(size_category(self.total()))
        )?;
        let splits = self.splits_with_rows();
        let offered = self.subsets.iter().filter(|_| !splits.is_empty());
        for (i, subset) in offered.enumerate() {
            if i == 0 {
                writeln!(f, "configs:")?;
            }
            writeln!(f, "- config_name: {}", yaml(&subset.name))?;
            if i == 0 {
                writeln!(f, "  default: true")?;
            }
            writeln!(f, "  data_files:")?;
            for split in &splits {
                let files = format!("{}/{split}-*.parquet", subset.name);
                writeln!(f, "  - split: {}\n    path: {}", yaml(split), yaml(&files))?;
            }
        }
        for subset in self.unsplit.iter().filter(|_| !splits.is_empty()) {
            let files = format!("{}/*.parquet", subset.name);
            writeln!(f, "- config_name: {}", yaml(&subset.name))?;
            writeln!(f, "  data_files: {}", yaml(&files))?;
        }
        writeln!(f, "---")
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
        let mut faults: Vec<_> = self.rows.values().flat_map(BTreeMap::keys).collect();
        faults.sort_by_key(|fault| (*fault != "none", *fault));
        faults.dedup();
        writeln!(f, "\n## What is in it\n\nRows by fault and split:\n")?;
        let names: Vec<_> = splits.iter().map(|split| plain(split)).collect();
        writeln!(f, "| fault | {} | all |", names.join(" | "))?;
        writeln!(f, "|---|{}---|", "---|".repeat(splits.len()))?;
        for fault in faults {
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

    fn columns(&self, f: &mut Formatter) -> fmt::Result {
        for subset in self.subsets.iter().chain(&self.unsplit) {
            let columns = subset.schema.columns();
            writeln!(
                f,
                "\n## Columns of {}\n\n| column | role | holds | unit | meaning |\n|---|---|---|---|---|",
                code(&subset.name)
            )?;
            for column in columns {
                let optional = if column.optional { ", or nothing" } else { "" };
                let unit = column.unit.as_deref().unwrap_or_default();
                let role = column.role.map(Role::name).unwrap_or_default();
                let (name, kind) = (code(&column.name), column.kind);
                writeln!(
                    f,
                    "| {name} | {role} | {kind}{optional} | {} | {} |",
                    plain(unit),
                    plain(&column.description)
                )?;
            }
        }
        Ok(())
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

/// Text that Markdown shows as it is, on one line and in any cell. What begins markup has a backslash before it
/// (CommonMark 0.31, 2.4), so that names from elsewhere bring neither links nor HTML.
fn plain(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.trim().chars() {
        match c {
            c if c.is_control() => shown.push(' '),
            '\\' | '`' | '*' | '[' | ']' | '<' | '>' | '&' | '|' | '~' | '!' | '$' => {
                shown.extend(['\\', c])
            }
            c => shown.push(c),
        }
    }
    shown
}

/// Text as code within a cell of a table: a character that would end the code or the cell becomes `?`.
fn code(text: &str) -> String {
    let shown = |c: char| if c.is_control() || c == '`' { '?' } else { c };
    let text: String = text.chars().map(shown).collect();
    format!("`{}`", text.replace('|', "\\|"))
}

/// Text in the quotation marks of YAML 1.2 (7.3.1): as in JSON, but what is not printable in YAML is written out.
fn yaml(text: &str) -> String {
    let mut shown = String::new();
    for c in Value::from(text).to_string().chars() {
        match c {
            '\u{7f}'..='\u{9f}'
            | '\u{2028}'
            | '\u{2029}'
            | '\u{feff}'
            | '\u{fffe}'
            | '\u{ffff}' => {
                shown += &format!("\\u{:04x}", u32::from(c));
            }
            c => shown.push(c),
        }
    }
    shown
}

fn join(numbers: &[u64]) -> String {
    let numbers: Vec<_> = numbers.iter().map(u64::to_string).collect();
    numbers.join(" | ")
}

/// The classes that Hugging Face sorts datasets into.
fn size_category(rows: u64) -> &'static str {
    match rows {
        0..1_000 => "n<1K",
        1_000..10_000 => "1K<n<10K",
        10_000..100_000 => "10K<n<100K",
        100_000..1_000_000 => "100K<n<1M",
        1_000_000..10_000_000 => "1M<n<10M",
        _ => "n>10M",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Column, Kind};

    fn card() -> DatasetCard {
        let column = Column::new("clearance_m", Kind::Real, "of a | joint")
            .unit("m")
            .role(Role::Label)
            .optional();
        let faults =
            |rows: &[(&str, u64)]| rows.iter().map(|(f, n)| ((*f).to_owned(), *n)).collect();
        let rows = [
            ("test", faults(&[("none", 1)])),
            ("train", faults(&[("big_end", 2), ("none", 30)])),
            ("validation", faults(&[])),
        ];
        DatasetCard {
            title: "Yes: no".into(),
            summary: "All of it.".into(),
            license: "cc0-1.0".into(),
            tags: vec!["a".into()],
            machine: vec![("stroke".into(), "240 mm".into())],
            rows: rows
                .map(|(split, faults)| (split.to_owned(), faults))
                .into(),
            subsets: ["signals", "features"]
                .map(|name| Subset {
                    name: name.into(),
                    schema: Schema::new(vec![column.clone()]).unwrap(),
                })
                .into(),
            unsplit: Vec::new(),
            mcap_example: None,
            command: "gen-dataset sweep.yaml".into(),
            version: "0.1.0".into(),
        }
    }

    #[test]
    fn the_front_matter_names_the_splits_that_have_rows() {
        let text = card().to_string();
        let front_matter = text.split("---\n").nth(1).unwrap();
        let expected = r#"pretty_name: "Yes: no"
license: "cc0-1.0"
tags: ["a"]
size_categories: ["n<1K"]
configs:
- config_name: "signals"
  default: true
  data_files:
  - split: "train"
    path: "signals/train-*.parquet"
  - split: "test"
    path: "signals/test-*.parquet"
- config_name: "features"
  data_files:
  - split: "train"
    path: "features/train-*.parquet"
  - split: "test"
    path: "features/test-*.parquet"
"#;
        assert_eq!(front_matter, expected);

        let mut empty = card();
        empty.rows.clear();
        assert!(!empty.to_string().contains("config"));
    }

    #[test]
    fn rows_are_counted_by_fault_and_split() {
        let text = card().to_string();
        let expected = "| fault | train | validation | test | all |
|---|---|---|---|---|
| `none` | 30 | 0 | 1 | 31 |
| `big_end` | 2 | 0 | 0 | 2 |
| all | 32 | 0 | 1 | 33 |
";
        assert!(text.contains(expected), "{text}");
        let column = r"| `clearance_m` | label | a real number, or nothing | m | of a \| joint |";
        assert_eq!(text.matches(column).count(), 2, "{text}");
    }

    /// Names come from files that others wrote; the card is published.
    #[test]
    fn names_are_no_markup() {
        let hostile = "<img src=x onerror=alert(1)> [a](b) `c` | d\n# e\u{85}---\n";
        let mut card = card();
        card.title = hostile.into();
        card.machine = vec![("machine".into(), hostile.into())];
        card.rows
            .insert("train".into(), [(hostile.to_owned(), 3)].into());
        card.subsets[0].schema =
            Schema::new(vec![Column::new(hostile, Kind::Real, hostile)]).unwrap();
        let text = card.to_string();
        let shown = r"\<img src=x onerror=alert(1)\> \[a\](b) \`c\` \| d # e ---";
        assert!(text.contains(&format!("\n# {shown}\n")), "{text}");
        assert!(text.contains(&format!("| machine | {shown} |\n")), "{text}");
        let code = r"`<img src=x onerror=alert(1)> [a](b) ?c? \| d?# e?---?`";
        assert_eq!(text.matches(code).count(), 2, "{text}");
        let name = r#"pretty_name: "<img src=x onerror=alert(1)> [a](b) `c` | d\n# e\u0085---\n""#;
        assert_eq!(text.lines().nth(1), Some(name));
        // Every heading is one of the card's own.
        let headings = text.lines().filter(|line| line.starts_with('#')).count();
        let mut plain = self::card();
        plain.title = "a".into();
        assert_eq!(
            headings,
            plain
                .to_string()
                .lines()
                .filter(|line| line.starts_with('#'))
                .count()
        );
    }
}
