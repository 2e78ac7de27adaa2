//! The front matter of a data card: what Hugging Face `datasets` reads of it.

use super::text::yaml;
use super::{DatasetCard, FAULT, Subset};
use crate::{Column, Kind};
use std::fmt::{self, Formatter};

impl DatasetCard {
    /// YAML between two lines of dashes. Strings are quoted as in JSON, which YAML contains.
    pub(super) fn front_matter(&self, f: &mut Formatter) -> fmt::Result {
        writeln!(f, "---\npretty_name: {}", yaml(&self.title))?;
        let tags: Vec<_> = self.tags.iter().map(|tag| yaml(tag)).collect();
        let licence = self.licence.map_or("unknown", |licence| licence.hub);
        writeln!(f, "license: {}\ntags: [{}]", yaml(licence), tags.join(", "))?;
        writeln!(
            f,
            "size_categories: [{}]",
            yaml(size_category(self.total()))
        )?;
        // `datasets` refuses a configuration without rows.
        if !self.splits_with_rows().is_empty() {
            self.configurations(f)?;
            self.features(f)?;
        }
        writeln!(f, "---")
    }

    /// Which files are which table.
    fn configurations(&self, f: &mut Formatter) -> fmt::Result {
        for (i, subset) in self.subsets.iter().enumerate() {
            if i == 0 {
                writeln!(f, "configs:")?;
            }
            writeln!(f, "- config_name: {}", yaml(&subset.name))?;
            if i == 0 {
                writeln!(f, "  default: true")?;
            }
            writeln!(f, "  data_files:")?;
            for split in self.splits_with_rows() {
                let files = format!("{}/{split}-*.parquet", subset.name);
                writeln!(f, "  - split: {}\n    path: {}", yaml(split), yaml(&files))?;
            }
        }
        for subset in &self.unsplit {
            let files = format!("{}/*.parquet", subset.name);
            writeln!(f, "- config_name: {}", yaml(&subset.name))?;
            writeln!(f, "  data_files: {}", yaml(&files))?;
        }
        Ok(())
    }

    /// The types of the columns. `datasets` makes the fault a class with these names.
    fn features(&self, f: &mut Formatter) -> fmt::Result {
        writeln!(f, "dataset_info:")?;
        for Subset { name, schema } in self.subsets.iter().chain(&self.unsplit) {
            writeln!(f, "- config_name: {}\n  features:", yaml(name))?;
            for column in schema.columns() {
                let kind = match column.name.as_str() {
                    FAULT => self.class_label(),
                    _ => of_kind(column).to_owned(),
                };
                writeln!(f, "  - {{name: {}, {kind}}}", yaml(&column.name))?;
            }
        }
        Ok(())
    }

    fn class_label(&self) -> String {
        let faults = self.faults().into_iter().enumerate();
        let names: Vec<_> = faults
            .map(|(i, fault)| format!("\"{i}\": {}", yaml(fault)))
            .collect();
        format!(
            "dtype: {{class_label: {{names: {{{}}}}}}}",
            names.join(", ")
        )
    }
}

/// The type of a column. Lists have the key of `datasets` before version 4, which later ones read too.
fn of_kind(column: &Column) -> &'static str {
    match column.kind {
        Kind::Text => "dtype: string",
        Kind::Integer => "dtype: int64",
        Kind::Real => "dtype: float64",
        Kind::Flag => "dtype: bool",
        Kind::Samples => "sequence: float32",
    }
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
