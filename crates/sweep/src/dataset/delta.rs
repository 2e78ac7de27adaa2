//! A finished dataset as Delta tables: a log beside the Parquet files of each kind of table, which
//! stay as they are (protocol of Delta Lake, <https://github.com/delta-io/delta/blob/master/PROTOCOL.md>).
//!
//! The log follows from the dataset alone, times included, which are 0: exported again it is the same.

use std::fs;

use recordings::{Column, FileEntry, Kind, Manifest, Schema};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use super::diagrams::{self, DiagramTable};
use super::output::Output;
use super::store::failed;
use super::tables::Tables;
use super::verify::faults_of;
use crate::{Error, Plan};

/// The log of a Delta table, beside its files.
pub(super) const FOLDER: &str = "_delta_log";
/// Its first version, which is the only one here.
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
/// Where a file is damaged, the dataset has no manifest yet, the log of another table stands there, or it cannot be
/// written.
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
        (diagrams::FOLDER, diagrams.schema),
    ];
    let mut exported = Vec::new();
    for (folder, schema) in tables {
        let files = files(&manifest, folder);
        if files.is_empty() {
            continue;
        }
        write(output, folder, &log(plan, folder, &schema, &files))?;
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
    let path = format!("{folder}/{FOLDER}/{VERSION}");
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

/// The actions of the first version, a line each.
fn log(plan: &Plan, folder: &str, schema: &Schema, files: &[(&str, &FileEntry)]) -> String {
    let protocol = json!({"protocol": {"minReaderVersion": 1, "minWriterVersion": 2}});
    let meta_data = json!({"metaData": {
        "id": id(plan, folder),
        "name": format!("{} {folder}", plan.name),
        "format": {"provider": "parquet", "options": {}},
        "schemaString": schema_of(schema).to_string(),
        "partitionColumns": [],
        "configuration": {},
        "createdTime": 0,
    }});
    let add = |(name, file): &(&str, &FileEntry)| {
        json!({"add": {
            "path": name,
            "partitionValues": {},
            "size": file.bytes,
            "modificationTime": 0,
            "dataChange": true,
            "stats": json!({"numRecords": file.rows}).to_string(),
        }})
    };
    let actions = [protocol, meta_data].into_iter();
    let actions = actions.chain(files.iter().map(add));
    actions.map(|action| format!("{action}\n")).collect()
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

fn schema_of(schema: &Schema) -> Value {
    let fields: Vec<Value> = schema.columns().iter().map(field).collect();
    json!({"type": "struct", "fields": fields})
}

fn field(column: &Column) -> Value {
    let mut metadata = json!({"comment": column.description});
    if let Some(unit) = &column.unit {
        metadata["unit"] = unit.as_str().into();
    }
    let kind = match column.kind {
        Kind::Text => json!("string"),
        Kind::Integer => json!("long"),
        Kind::Real => json!("double"),
        Kind::Flag => json!("boolean"),
        Kind::Samples => json!({"type": "array", "elementType": "float", "containsNull": false}),
    };
    json!({"name": column.name, "type": kind, "nullable": column.optional, "metadata": metadata})
}
