//! The columns of a dataset in its card: what all tables have in common once, features by what they are.

use super::text::{code, plain};
use super::{DatasetCard, Subset};
use crate::{Column, Role};
use std::collections::BTreeSet;
use std::fmt::{self, Formatter};

/// Features that are the same quantity of several channels, orders or bands.
struct Alike<'a> {
    first: &'a Column,
    count: usize,
    units: BTreeSet<&'a str>,
}

impl DatasetCard {
    pub(super) fn columns(&self, f: &mut Formatter) -> fmt::Result {
        writeln!(f, "\n## Columns\n")?;
        for role in Role::ALL {
            writeln!(f, "- `{}`: {}", role.name(), meaning(role))?;
        }
        writeln!(
            f,
            "\n`manifest.json` and the metadata of the Parquet fields have role, unit and meaning of every column."
        )?;
        let shared = self.shared();
        if !shared.is_empty() {
            let names: Vec<_> = self.subsets.iter().map(|s| code(&s.name)).collect();
            writeln!(f, "\n### Columns of {}\n", names.join(" and "))?;
            table(f, &shared)?;
        }
        for Subset { name, schema } in self.subsets.iter().chain(&self.unsplit) {
            let own = schema.columns().iter().filter(|c| !shared.contains(c));
            let (features, own): (Vec<_>, Vec<_>) = own.partition(|c| is_feature(c));
            let only = if shared.is_empty() { "" } else { " alone" };
            if !own.is_empty() {
                writeln!(f, "\n### Columns of {}{only}\n", code(name))?;
                table(f, &own)?;
            }
            if !features.is_empty() {
                writeln!(f, "\n### Features in {}\n", code(name))?;
                grouped(f, &features)?;
            }
        }
        Ok(())
    }

    /// The columns that every split table has.
    fn shared(&self) -> Vec<&Column> {
        let Some((first, others)) = self.subsets.split_first() else {
            return Vec::new();
        };
        if others.is_empty() {
            return Vec::new();
        }
        let everywhere = |column: &&Column| {
            let mut others = others.iter();
            !is_feature(column) && others.all(|other| other.schema.columns().contains(column))
        };
        first.schema.columns().iter().filter(everywhere).collect()
    }
}

fn is_feature(column: &Column) -> bool {
    column.role == Some(Role::Feature)
}

fn meaning(role: Role) -> &'static str {
    match role {
        Role::Identifier => "names a row, or the rows that belong together",
        Role::Label => "what is to be found out: the fault, and how large it is",
        Role::Condition => "at what the machine ran, and what else was chosen",
        Role::Unknown => "what varied without being known",
        Role::Feature => "a number or a word computed from a recording",
        Role::Signal => "a recording",
    }
}

/// Columns by role, each a row.
fn table(f: &mut Formatter, columns: &[&Column]) -> fmt::Result {
    writeln!(
        f,
        "| column | role | holds | unit | meaning |\n|---|---|---|---|---|"
    )?;
    let mut columns = columns.to_vec();
    let place = |column: &&Column| Role::ALL.iter().position(|role| Some(*role) == column.role);
    columns.sort_by_key(|column| place(column).unwrap_or(Role::ALL.len()));
    for column in columns {
        let optional = if column.optional { ", or nothing" } else { "" };
        writeln!(
            f,
            "| {} | {} | {}{optional} | {} | {} |",
            code(&column.name),
            column.role.map(Role::name).unwrap_or_default(),
            column.kind,
            plain(column.unit.as_deref().unwrap_or_default()),
            plain(&column.description)
        )?;
    }
    Ok(())
}

/// Features of one meaning in a row, numbers in the meaning aside.
fn grouped(f: &mut Formatter, features: &[&Column]) -> fmt::Result {
    writeln!(
        f,
        "| for example | columns | unit | meaning |\n|---|---|---|---|"
    )?;
    let mut groups: Vec<(String, Alike)> = Vec::new();
    for feature in features {
        let key = without_numbers(&feature.description);
        let place = match groups.iter().position(|(other, _)| *other == key) {
            Some(place) => place,
            None => {
                let alike = Alike {
                    first: feature,
                    count: 0,
                    units: BTreeSet::new(),
                };
                groups.push((key, alike));
                groups.len() - 1
            }
        };
        let alike = &mut groups[place].1;
        alike.count += 1;
        alike.units.extend(feature.unit.as_deref());
    }
    for (_, alike) in groups {
        let units: Vec<_> = alike.units.into_iter().map(plain).collect();
        writeln!(
            f,
            "| {} | {} | {} | {} |",
            code(&alike.first.name),
            alike.count,
            units.join(", "),
            plain(&alike.first.description)
        )?;
    }
    Ok(())
}

/// A text in which every number is one `#`.
fn without_numbers(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        match c.is_ascii_digit() {
            true if shown.ends_with('#') => {}
            true => shown.push('#'),
            false => shown.push(c),
        }
    }
    shown
}
