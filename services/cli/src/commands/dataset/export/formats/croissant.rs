//! `croissant.json`: the export in the vocabulary of Croissant 1.1, so that catalogs of datasets and loaders understand its rows.

use std::collections::BTreeSet;

use client::ColumnInfo;
use serde_json::{Map, Value, json};

use crate::commands::dataset::export::format::Format;
use crate::commands::dataset::export::formats::card::Card;
use crate::commands::dataset::export::input::fields::meaning;

/// A list of rows that the file describes.
pub(crate) struct RowFile {
    /// Path below the root.
    pub(crate) name: String,
    pub(crate) sha256: String,
    /// The columns that any of its rows has a value in.
    pub(crate) columns: BTreeSet<String>,
}

/// The names of the vocabulary.
const CONTEXT: &str = r#"{
  "@language": "en", "@vocab": "https://schema.org/", "arrayShape": "cr:arrayShape", "citeAs": "cr:citeAs", "column": "cr:column",
  "conformsTo": "dct:conformsTo", "containedIn": "cr:containedIn", "cr": "http://mlcommons.org/croissant/",
  "rai": "http://mlcommons.org/croissant/RAI/", "data": {"@id": "cr:data", "@type": "@json"},
  "dataType": {"@id": "cr:dataType", "@type": "@vocab"}, "dct": "http://purl.org/dc/terms/",
  "description": {"@container": "@language"}, "equivalentProperty": "cr:equivalentProperty",
  "examples": {"@id": "cr:examples", "@type": "@json"}, "extract": "cr:extract", "field": "cr:field",
  "fileProperty": "cr:fileProperty", "fileObject": "cr:fileObject", "fileSet": "cr:fileSet", "format": "cr:format",
  "includes": "cr:includes", "isArray": "cr:isArray", "isLiveDataset": "cr:isLiveDataset", "jsonPath": "cr:jsonPath", "key": "cr:key",
  "md5": "cr:md5", "name": {"@container": "@language"}, "parentField": "cr:parentField", "path": "cr:path",
  "recordSet": "cr:recordSet", "references": "cr:references", "regex": "cr:regex", "repeated": "cr:repeated",
  "replace": "cr:replace", "samplingRate": "cr:samplingRate", "sc": "https://schema.org/", "separator": "cr:separator",
  "source": "cr:source", "subField": "cr:subField", "transform": "cr:transform"
}"#;

/// The file's text.
pub(crate) fn croissant(card: &Card<'_>, columns: &[ColumnInfo], rows: &[RowFile]) -> String {
    let context: Value = serde_json::from_str(CONTEXT).unwrap_or_default();
    let sources = card.origins.iter().map(|origin| {
        json!({
            "@type": "sc:CreativeWork", "name": origin.name, "description": origin.source, "license": origin.licence
        })
    });
    let mut distribution: Vec<Value> = rows.iter().map(|rows| file_object(card.format, rows)).collect();
    distribution.extend(file_set(card.format));
    let record_sets: Vec<Value> = rows
        .iter()
        .map(|rows| record_set(card.format, columns, rows))
        .collect();
    let mut file = json!({
        "@context": context,
        "@type": "sc:Dataset",
        "conformsTo": "http://mlcommons.org/croissant/1.1",
        "name": card.dataset,
        "description": card.summary(),
        "license": card.license,
        "keywords": ["underwater", "synthetic"],
        "distribution": distribution,
        "recordSet": record_sets,
    });
    let sources: Vec<Value> = sources.collect();
    if !sources.is_empty() {
        file["isBasedOn"] = sources.into();
    }
    format!("{file:#}\n")
}

fn file_object(format: Format, rows: &RowFile) -> Value {
    json!({
        "@type": "cr:FileObject", "@id": rows.name, "name": rows.name, "contentUrl": rows.name,
        "encodingFormat": media_type(format), "sha256": rows.sha256
    })
}

fn media_type(format: Format) -> &'static str {
    match format {
        Format::Hf => "application/x-parquet",
        _ => "application/jsonlines",
    }
}

/// The files that hold the images.
fn file_set(format: Format) -> Option<Value> {
    let (pattern, media_type) = match format {
        Format::WebDataset => ("**/*.tar", "application/x-tar"),
        Format::Parquet => ("**/data/*.parquet", "application/x-parquet"),
        Format::Mcap => ("**/*.mcap", "application/octet-stream"),
        _ => return None,
    };
    Some(json!({
        "@type": "cr:FileSet", "@id": "shards", "name": "shards", "encodingFormat": media_type, "includes": pattern
    }))
}

/// The rows of a part.
fn record_set(format: Format, columns: &[ColumnInfo], rows: &RowFile) -> Value {
    let id = match rows.name.split_once('/') {
        Some((part, _)) => format!("images-{part}"),
        None => "images".to_owned(),
    };
    let present = columns
        .iter()
        .filter(|column| rows.columns.contains(&column.name));
    let mut fields: Vec<Value> = present.map(|column| field(&id, rows, column)).collect();
    if !format.shares_files() {
        let file = ColumnInfo {
            name: "file_name".to_owned(),
            kind: "text".to_owned(),
            unit: None,
        };
        fields.push(field(&id, rows, &file));
    }
    json!({
        "@type": "cr:RecordSet", "@id": id, "name": id, "description": "one record for each image", "field": fields
    })
}

fn field(id: &str, rows: &RowFile, column: &ColumnInfo) -> Value {
    let data_type = match column.kind.as_str() {
        "number" => "sc:Float",
        "bool" => "sc:Boolean",
        _ => "sc:Text",
    };
    let unit = column
        .unit
        .as_ref()
        .map_or_else(String::new, |unit| format!(", in {unit}"));
    let about = match column.name.as_str() {
        "file_name" => "path of the picture from the folder of the rows".to_owned(),
        _ => meaning(column),
    };
    let mut field = Map::new();
    field.insert("@type".to_owned(), "cr:Field".into());
    field.insert("@id".to_owned(), format!("{id}/{}", column.name).into());
    field.insert("name".to_owned(), column.name.clone().into());
    field.insert("description".to_owned(), format!("{about}{unit}").into());
    field.insert("dataType".to_owned(), data_type.into());
    field.insert(
        "source".to_owned(),
        json!({"fileObject": {"@id": rows.name}, "extract": {"column": column.name}}),
    );
    Value::Object(field)
}
