//! `croissant.json`: what a dataset is, for programs that know nothing of it. JSON-LD of the vocabulary Croissant 1.0
//! (Akhtar et al. 2024, "Croissant: A Metadata Format for ML-Ready Datasets"; MLCommons).
//!
//! Each table is a record set over the file set `NAME/*.parquet`; a record's fields are its columns. Each file of a table
//! is a file object with its checksum. Who publishes the dataset adds `creator`, `datePublished` and `url`, which the
//! program cannot know.

use crate::{Column, DatasetCard, Error, FileEntry, Kind};
use serde::Serialize;
use serde_json::{Value, json};

const PARQUET: &str = "application/x-parquet";

#[derive(Serialize)]
struct Dataset<'a> {
    #[serde(rename = "@context")]
    context: Value,
    #[serde(rename = "@type")]
    kind: &'static str,
    #[serde(rename = "conformsTo")]
    conforms_to: &'static str,
    name: &'a str,
    description: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    license: Option<String>,
    keywords: &'a [String],
    distribution: Vec<Resource<'a>>,
    #[serde(rename = "recordSet")]
    record_set: Vec<RecordSet<'a>>,
}

/// A file, or the files of a table.
#[derive(Serialize)]
#[serde(tag = "@type")]
enum Resource<'a> {
    #[serde(rename = "cr:FileObject", rename_all = "camelCase")]
    File {
        #[serde(rename = "@id")]
        id: &'a str,
        name: &'a str,
        content_url: &'a str,
        content_size: String,
        encoding_format: &'static str,
        sha256: &'a str,
    },
    #[serde(rename = "cr:FileSet", rename_all = "camelCase")]
    Files {
        #[serde(rename = "@id")]
        id: String,
        name: String,
        encoding_format: &'static str,
        includes: String,
    },
}

#[derive(Serialize)]
struct RecordSet<'a> {
    #[serde(rename = "@type")]
    kind: &'static str,
    #[serde(rename = "@id")]
    id: &'a str,
    name: &'a str,
    field: Vec<Value>,
}

/// The metadata of the dataset with this card and these files: indented JSON with a newline at the end.
///
/// # Errors
/// None in practice: everything in it has a form in JSON.
pub fn croissant(card: &DatasetCard, files: &[FileEntry]) -> Result<String, Error> {
    let names: Vec<&str> = card
        .subsets
        .iter()
        .chain(&card.unsplit)
        .map(|subset| subset.name.as_str())
        .collect();
    let of_a_table = |file: &&FileEntry| {
        let folder = file.path.split_once('/').map(|(folder, _)| folder);
        folder.is_some_and(|folder| names.contains(&folder))
    };
    let sets = names.iter().map(|name| Resource::Files {
        id: file_set(name),
        name: file_set(name),
        encoding_format: PARQUET,
        includes: format!("{name}/*.parquet"),
    });
    let files = files.iter().filter(of_a_table).map(|file| Resource::File {
        id: &file.path,
        name: &file.path,
        content_url: &file.path,
        content_size: format!("{} B", file.bytes),
        encoding_format: PARQUET,
        sha256: &file.sha256,
    });
    let tables = card.subsets.iter().chain(&card.unsplit);
    let dataset = Dataset {
        context: context(),
        kind: "sc:Dataset",
        conforms_to: "http://mlcommons.org/croissant/1.0",
        name: &card.title,
        description: &card.summary,
        license: card.licence.map(|licence| licence.url()),
        keywords: &card.tags,
        distribution: sets.chain(files).collect(),
        record_set: tables
            .map(|table| RecordSet {
                kind: "cr:RecordSet",
                id: &table.name,
                name: &table.name,
                field: (table.schema.columns().iter())
                    .map(|column| field(&table.name, column))
                    .collect(),
            })
            .collect(),
    };
    let json = serde_json::to_string_pretty(&dataset).map_err(|e| Error::encode("JSON", e))?;
    Ok(json + "\n")
}

fn file_set(table: &str) -> String {
    format!("{table}-files")
}

fn field(table: &str, column: &Column) -> Value {
    let description = match &column.unit {
        Some(unit) => format!("{} [{unit}]", column.description),
        None => column.description.clone(),
    };
    let data_type = match column.kind {
        Kind::Text => "sc:Text",
        Kind::Integer => "sc:Integer",
        Kind::Real | Kind::Samples => "sc:Float",
        Kind::Flag => "sc:Boolean",
    };
    let mut field = json!({
        "@type": "cr:Field",
        "@id": format!("{table}/{}", column.name),
        "name": format!("{table}/{}", column.name),
        "description": description,
        "dataType": data_type,
        "source": {
            "fileSet": {"@id": file_set(table)},
            "extract": {"column": column.name},
        },
    });
    if column.kind == Kind::Samples {
        field["repeated"] = true.into();
    }
    field
}

/// The names of the vocabulary, as the specification lists them.
fn context() -> Value {
    json!({
        "@language": "en",
        "@vocab": "https://schema.org/",
        "citeAs": "cr:citeAs",
        "column": "cr:column",
        "conformsTo": "dct:conformsTo",
        "cr": "http://mlcommons.org/croissant/",
        "rai": "http://mlcommons.org/croissant/RAI/",
        "data": {"@id": "cr:data", "@type": "@json"},
        "dataType": {"@id": "cr:dataType", "@type": "@vocab"},
        "dct": "http://purl.org/dc/terms/",
        "equivalentProperty": "cr:equivalentProperty",
        "examples": {"@id": "cr:examples", "@type": "@json"},
        "extract": "cr:extract",
        "field": "cr:field",
        "fileProperty": "cr:fileProperty",
        "fileObject": "cr:fileObject",
        "fileSet": "cr:fileSet",
        "format": "cr:format",
        "includes": "cr:includes",
        "isLiveDataset": "cr:isLiveDataset",
        "jsonPath": "cr:jsonPath",
        "key": "cr:key",
        "md5": "cr:md5",
        "parentField": "cr:parentField",
        "path": "cr:path",
        "recordSet": "cr:recordSet",
        "references": "cr:references",
        "regex": "cr:regex",
        "repeated": "cr:repeated",
        "replace": "cr:replace",
        "samplingRate": "cr:samplingRate",
        "sc": "https://schema.org/",
        "separator": "cr:separator",
        "source": "cr:source",
        "subField": "cr:subField",
        "transform": "cr:transform",
    })
}
