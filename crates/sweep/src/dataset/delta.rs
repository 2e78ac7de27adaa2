//! A finished dataset as Delta tables: a log beside the Parquet files of each kind of table, which
//! stay as they are (protocol of Delta Lake, <https://github.com/delta-io/delta/blob/master/PROTOCOL.md>).
//!
//! The log follows from the dataset alone, times included, which are 0: exported again it is the same.

use std::fs;

use recordings::{Column, FileEntry, Kind, Manifest, Schema};
use serde::Serialize;
use sha2::{Digest, Sha256};

use super::diagrams::DiagramTable;
use super::layout::{DELTA_LOG, DIAGRAMS};
use super::output::Output;
use super::record::line;
use super::store::failed;
use super::tables::Tables;
use super::verify::faults_of;
use crate::{Error, Plan};

/// The first version of the log, which is the only one here.
pub(super) const VERSION: &str = "00000000000000000000.json";

/// A Delta table of a dataset.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DeltaTable {
    /// Its folder within the dataset.
    pub folder: &'static str,
    /// Its Parquet files.
    pub files: usize,
    /// Its rows.
    pub rows: u64,
}

/// Makes each folder of Parquet files of a finished dataset a Delta table, if all of them are as they
/// were written. Doing it again changes nothing.
///
/// # Errors
/// [`Error::NotFinalized`] without a manifest, [`Error::Faults`] for damaged files, [`Error::OtherDeltaTable`]
/// if there is the log of another table, and errors of files that cannot be written.
pub fn export_delta(output: &Output, plan: &Plan) -> Result<Vec<DeltaTable>, Error> {
    let manifest = manifest(output)?;
    let listed = manifest
        .files
        .iter()
        .filter(|file| file.path.ends_with(".parquet"));
    let faults = faults_of(&output.store, listed, &mut |_| {})?;
    if !faults.is_empty() {
        let path = output.root.clone();
        return Err(Error::Faults { path, faults });
    }
    let tables = Tables::new(plan)?;
    let diagrams = DiagramTable::new(plan)?;
    let tables = [
        ("signals", tables.signals),
        ("features", tables.features),
        (DIAGRAMS, diagrams.schema),
    ];
    let mut exported = Vec::new();
    for (folder, schema) in tables {
        let files = files(&manifest, folder);
        if files.is_empty() {
            continue;
        }
        write(output, folder, &log(plan, folder, &schema, &files)?)?;
        exported.push(DeltaTable {
            folder,
            files: files.len(),
            rows: rows(&files),
        });
    }
    Ok(exported)
}

fn manifest(output: &Output) -> Result<Manifest, Error> {
    let path = output.path("manifest.json");
    match output.store.read("manifest.json")? {
        Some(text) => Ok(Manifest::from_json(&text, &path)?),
        None => Err(Error::NotFinalized(output.root.clone())),
    }
}

/// The Parquet files of a folder, with their names there.
fn files<'a>(manifest: &'a Manifest, folder: &str) -> Vec<(&'a str, &'a FileEntry)> {
    let inside = |file: &'a FileEntry| {
        let name = file.path.strip_prefix(folder)?.strip_prefix('/')?;
        name.ends_with(".parquet").then_some((name, file))
    };
    manifest.files.iter().filter_map(inside).collect()
}

/// Rows of all files; a manifest that somebody changed may have any number of them.
fn rows(files: &[(&str, &FileEntry)]) -> u64 {
    let rows = files.iter().filter_map(|(_, file)| file.rows);
    rows.fold(0, u64::saturating_add)
}

/// Writes a log, or compares it with the one that is there.
fn write(output: &Output, folder: &str, log: &str) -> Result<(), Error> {
    let path = format!("{folder}/{DELTA_LOG}/{VERSION}");
    if output.store.folder().is_some()
        && let Some(folder) = output.path(&path).parent()
    {
        fs::create_dir_all(folder).map_err(|source| failed("create", folder, source))?;
    }
    match output.store.create_only(&path, log)? {
        Some(before) if before != log.as_bytes() => Err(Error::OtherDeltaTable(output.path(&path))),
        _ => Ok(()),
    }
}

/// A line of the log.
#[derive(Serialize)]
#[serde(rename_all = "camelCase", rename_all_fields = "camelCase")]
enum Action<'a> {
    Protocol {
        min_reader_version: u32,
        min_writer_version: u32,
    },
    MetaData {
        id: String,
        name: String,
        format: Format,
        schema_string: String,
        partition_columns: [&'a str; 0],
        configuration: Nothing,
        created_time: u64,
    },
    Add {
        path: &'a str,
        partition_values: Nothing,
        size: u64,
        modification_time: u64,
        data_change: bool,
        stats: String,
    },
}

/// An object without keys.
#[derive(Serialize)]
struct Nothing {}

#[derive(Serialize)]
struct Format {
    provider: &'static str,
    options: Nothing,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Stats {
    num_records: Option<u64>,
}

/// A struct of columns.
#[derive(Serialize)]
struct Struct<'a> {
    r#type: &'static str,
    fields: Vec<Field<'a>>,
}

#[derive(Serialize)]
struct Field<'a> {
    name: &'a str,
    r#type: Type,
    nullable: bool,
    metadata: Metadata<'a>,
}

#[derive(Serialize)]
#[serde(untagged, rename_all_fields = "camelCase")]
enum Type {
    Primitive(&'static str),
    Array {
        r#type: &'static str,
        element_type: &'static str,
        contains_null: bool,
    },
}

#[derive(Serialize)]
struct Metadata<'a> {
    comment: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    unit: Option<&'a str>,
}

/// The actions of the first version, a line each.
fn log(
    plan: &Plan,
    folder: &str,
    schema: &Schema,
    files: &[(&str, &FileEntry)],
) -> Result<String, Error> {
    let mut log = String::new();
    let mut action = |action: Action| -> Result<(), Error> {
        log += &line(&action)?;
        log.push('\n');
        Ok(())
    };
    action(Action::Protocol {
        min_reader_version: 1,
        min_writer_version: 2,
    })?;
    action(Action::MetaData {
        id: id(plan, folder),
        name: format!("{} {folder}", plan.name),
        format: Format {
            provider: "parquet",
            options: Nothing {},
        },
        schema_string: line(&Struct {
            r#type: "struct",
            fields: schema.columns().iter().map(field).collect(),
        })?,
        partition_columns: [],
        configuration: Nothing {},
        created_time: 0,
    })?;
    for (name, file) in files {
        action(Action::Add {
            path: name,
            partition_values: Nothing {},
            size: file.bytes,
            modification_time: 0,
            data_change: true,
            stats: line(&Stats {
                num_records: file.rows,
            })?,
        })?;
    }
    Ok(log)
}

/// An identifier of the form that Delta asks for, the same for the same dataset (UUID of version 8,
/// RFC 9562).
fn id(plan: &Plan, folder: &str) -> String {
    let mut digest: Vec<u8> = Sha256::digest(format!("{}/{folder}", plan.id)).to_vec();
    digest[6] = digest[6] & 0x0f | 0x80;
    digest[8] = digest[8] & 0x3f | 0x80;
    let part = |range: std::ops::Range<usize>| -> String {
        digest[range]
            .iter()
            .map(|byte| format!("{byte:02x}"))
            .collect()
    };
    [
        part(0..4),
        part(4..6),
        part(6..8),
        part(8..10),
        part(10..16),
    ]
    .join("-")
}

fn field(column: &Column) -> Field<'_> {
    Field {
        name: &column.name,
        r#type: match column.kind {
            Kind::Text => Type::Primitive("string"),
            Kind::Integer => Type::Primitive("long"),
            Kind::Real => Type::Primitive("double"),
            Kind::Flag => Type::Primitive("boolean"),
            Kind::Samples => Type::Array {
                r#type: "array",
                element_type: "float",
                contains_null: false,
            },
        },
        nullable: column.optional,
        metadata: Metadata {
            comment: &column.description,
            unit: column.unit.as_deref(),
        },
    }
}
