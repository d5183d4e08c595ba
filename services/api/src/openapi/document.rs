//! Assembles the document: the declarations of the routes, the generated components of lists and fields, and common
//! responses.

use serde_json::{Map, Value, json};
use spec::Vocabulary;
use utoipa::openapi::OpenApi;

use super::{description, leaf, problems};
use crate::http::problem::Slug;

/// The document of these routes and of the lists with these names.
pub(crate) fn document(mut routes: OpenApi, vocabulary: &Vocabulary, list_names: &[&str]) -> Value {
    problems::add(&mut routes);
    let mut document = serde_json::to_value(&routes).expect("the document is plain data");
    if let Some(components) = document["components"]["schemas"].as_object_mut() {
        components.extend(description::components(vocabulary));
        components.extend(lists(list_names));
        components.remove("Bytes");
        refer_to_rows(components);
    }
    let problem = json!({"application/problem+json": {"schema": {"$ref": "#/components/schemas/Problem"}}});
    document["components"]["responses"]["Problem"]["content"] = problem;
    let operations = document["paths"].as_object_mut().into_iter().flatten();
    let operations = operations.filter_map(|(_, path)| path.as_object_mut()).flatten();
    for (_, operation) in operations {
        set_media_types(operation);
        let parameters = operation.get_mut("parameters").and_then(Value::as_array_mut);
        let schemas = parameters
            .into_iter()
            .flatten()
            .filter_map(|parameter| parameter.get_mut("schema"));
        schemas.filter_map(Value::as_object_mut).for_each(leave_out_null);
    }
    document
}

/// Components of built-in lists.
fn lists(names: &[&str]) -> Map<String, Value> {
    let slugs: Vec<_> = Slug::ALL.iter().map(|slug| slug.name()).collect();
    let types: Vec<_> = slugs.iter().map(|slug| format!("/problems/{slug}")).collect();
    // Names for code generators, because the words begin with a slash.
    let words: Vec<_> = slugs
        .iter()
        .map(|slug| slug.replace('-', "_").to_uppercase())
        .collect();
    let lists = json!({
        "ListName": {"type": "string", "enum": names, "description": "A built-in list."},
        "ProblemType": {"type": "string", "enum": types, "x-enum-varnames": words,
                        "description": "A kind of problem; `GET /v1/lists/problems` explains it."},
    });
    match lists {
        Value::Object(lists) => lists,
        _ => Map::new(),
    }
}

/// Makes the rows of pages components, so that a page refers to them.
fn refer_to_rows(components: &mut Map<String, Value>) {
    for (name, page) in components.iter_mut() {
        if let Some(row) = name.strip_prefix("Page_") {
            page["properties"]["items"]["items"] = leaf::reference(row);
        }
    }
}

/// Non-JSON bodies are text or bytes.
fn set_media_types(operation: &mut Value) {
    let responses = operation.get_mut("responses").and_then(Value::as_object_mut);
    for (_, response) in responses.into_iter().flatten() {
        let contents = response.get_mut("content").and_then(Value::as_object_mut);
        for (media_type, content) in contents.into_iter().flatten() {
            if media_type.ends_with("json") {
                continue;
            }
            let is_text = media_type.starts_with("text/") || media_type.ends_with("ndjson");
            content["schema"] = if is_text {
                json!({"type": "string"})
            } else {
                json!({"type": "string", "format": "binary"})
            };
        }
    }
}

/// A parameter may be absent, but not null.
fn leave_out_null(schema: &mut Map<String, Value>) {
    if let Some(only) = find_only_option(schema.get("type")) {
        schema.insert("type".to_owned(), only);
    } else if let Some(Value::Object(only)) = find_only_option(schema.get("oneOf")) {
        schema.remove("oneOf");
        schema.extend(only);
    }
}

/// The only option of a list other than null.
fn find_only_option(options: Option<&Value>) -> Option<Value> {
    let mut kept = options?
        .as_array()?
        .iter()
        .filter(|option| **option != "null" && option["type"] != "null");
    kept.next().filter(|_| kept.next().is_none()).cloned()
}
