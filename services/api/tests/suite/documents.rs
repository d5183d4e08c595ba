//! The OpenAPI document matches the service.

mod fields;

use std::collections::BTreeSet;

use serde_json::{Value, json};

use crate::common::{Running, start};

const ROUTES: &[(&str, &str)] = &[
    ("/v1/renders", "post"),
    ("/v1/jobs", "post"),
    ("/v1/jobs", "get"),
    ("/v1/jobs/{id}", "get"),
    ("/v1/jobs/{id}", "delete"),
    ("/v1/jobs/preview", "post"),
    ("/v1/jobs/{id}/cancel", "post"),
    ("/v1/jobs/{id}/pause", "post"),
    ("/v1/jobs/{id}/resume", "post"),
    ("/v1/jobs/{id}/retry-failed", "post"),
    ("/v1/jobs/{id}/events", "get"),
    ("/v1/jobs/{id}/results", "get"),
    ("/v1/jobs/{id}/errors", "get"),
    ("/v1/datasets/{name}/density", "get"),
    ("/v1/datasets/{name}/histogram", "get"),
    ("/v1/datasets/{name}/metadata.jsonl", "get"),
    ("/v1/datasets/{name}/metadata.csv", "get"),
    ("/v1/enhance", "post"),
    ("/v1/measure", "post"),
    ("/v1/scenes", "post"),
    ("/v1/scenes", "get"),
    ("/v1/scenes/{id}", "get"),
    ("/v1/sets", "get"),
    ("/v1/sets", "post"),
    ("/v1/sets/{job}", "get"),
    ("/v1/sets/{job}", "delete"),
    ("/v1/scenes/{id}", "delete"),
    ("/v1/collections", "get"),
    ("/v1/collections/{name}", "get"),
    ("/v1/collections/{name}", "delete"),
    ("/v1/waters", "get"),
    ("/v1/waters", "post"),
    ("/v1/waters/{name}", "get"),
    ("/v1/waters/{name}", "delete"),
    ("/v1/styles", "get"),
    ("/v1/styles", "post"),
    ("/v1/styles/train", "post"),
    ("/v1/styles/trainings/{id}", "get"),
    ("/v1/styles/trainings/{id}", "delete"),
    ("/v1/lists", "get"),
    ("/v1/lists/{list}", "get"),
    ("/v1/datasets", "get"),
    ("/v1/datasets/{name}", "get"),
    ("/v1/datasets/{name}", "delete"),
    ("/v1/datasets/{name}/stats", "get"),
    ("/v1/datasets/{name}/versions", "get"),
    ("/v1/datasets/{name}/versions", "post"),
    ("/v1/datasets/{name}/versions/{version}", "get"),
    ("/v1/datasets/{name}/versions/{version}", "delete"),
    ("/v1/datasets/{name}/versions/{version}/verify", "post"),
    ("/v1/images", "get"),
    ("/v1/images/{job}/{frame}", "get"),
    ("/v1/images/{job}/{frame}/artifacts/{kind}", "get"),
    ("/v1/images/{job}/{frame}/preview", "get"),
    ("/v1/images/{job}/{frame}/verify", "post"),
    ("/v1/workers", "get"),
    ("/livez", "get"),
    ("/readyz", "get"),
    ("/version", "get"),
    ("/metrics", "get"),
];

#[test]
fn every_route_is_described_and_every_reference_resolves() {
    let service = start();
    let document = service.get("/openapi.json").json();
    for (path, method) in ROUTES.iter().copied() {
        let operation = &document["paths"][path][method];
        assert!(
            operation["responses"].is_object() && operation["summary"].is_string(),
            "{method} {path}"
        );
    }
    let text = document.to_string();
    for reference in text.split("\"$ref\":\"#").skip(1) {
        let pointer = reference.split('"').next().unwrap();
        assert!(document.pointer(pointer).is_some(), "{pointer} is nowhere");
    }
    for slug in api::Slug::ALL {
        assert!(text.contains(&format!("/problems/{}`", slug.name())), "{slug:?}");
        assert_eq!(service.get(&format!("/problems/{}", slug.name())).status, 200);
    }
}

#[test]
fn the_example_of_the_document_is_accepted() {
    let service = start();
    let document = service.get("/openapi.json").json();
    let example = &document["components"]["schemas"]["JobDescription"]["examples"][0];
    assert!(example.is_object(), "{document}");
    service.submit(example);
}

#[test]
fn the_documentation_page_brings_its_own_files() {
    let service = start();
    let page = service.get("/docs/");
    assert_eq!(page.status, 200, "{}", page.text());
    assert!(
        !page.text().contains("http://") && !page.text().contains("https://"),
        "{}",
        page.text()
    );
}

fn document() -> (Running, Value) {
    let service = start();
    let document = service.get("/openapi.json").json();
    (service, document)
}

fn operations(document: &Value) -> Vec<&Value> {
    let paths = document["paths"].as_object().unwrap().values();
    let members = paths.flat_map(|path| path.as_object().unwrap().values());
    members.filter(|member| member["responses"].is_object()).collect()
}

/// The component of a reference, or the schema itself.
fn followed<'d>(document: &'d Value, schema: &'d Value) -> &'d Value {
    match schema["$ref"].as_str() {
        Some(path) => document.pointer(path.trim_start_matches('#')).unwrap(),
        None => schema,
    }
}

/// The schema without its distribution alternative.
fn without_law<'d>(document: &'d Value, schema: &'d Value) -> &'d Value {
    let schema = followed(document, schema);
    let is_law = |option: &&Value| option["$ref"].as_str().is_some_and(|path| path.ends_with("Law"));
    match schema["oneOf"].as_array() {
        Some(options) if options.iter().any(|option| is_law(&option)) => {
            followed(document, options.iter().find(|option| !is_law(option)).unwrap())
        }
        _ => schema,
    }
}

#[test]
fn every_operation_has_a_name_of_its_own_made_of_a_verb_and_a_noun() {
    let (_service, document) = document();
    let mut seen = BTreeSet::new();
    for operation in operations(&document) {
        let id = operation["operationId"].as_str().unwrap();
        let parts: Vec<_> = id.split('_').collect();
        let plain = |part: &&str| !part.is_empty() && part.chars().all(|c| c.is_ascii_lowercase());
        assert!(parts.len() >= 2 && parts.iter().all(plain), "{id}");
        assert!(seen.insert(id), "{id} stands twice");
        assert_eq!(operation["tags"].as_array().map(Vec::len), Some(1), "{id}");
    }
    let tags: BTreeSet<_> = document["tags"]
        .as_array()
        .unwrap()
        .iter()
        .map(|tag| &tag["name"])
        .map(Value::to_string)
        .collect();
    let used: BTreeSet<_> = operations(&document)
        .iter()
        .map(|operation| operation["tags"][0].to_string())
        .collect();
    assert_eq!(tags, used);
}

/// Pointers to unnamed groups or word lists inside a schema. The parts of `allOf` are one schema.
fn anonymous(schema: &Value, place: &str) -> Vec<String> {
    let members = |name: &str| schema[name].as_object().into_iter().flatten();
    let items = |name: &str| schema[name].as_array().into_iter().flatten();
    let element = Some(&schema["items"]).filter(|element| element.is_object());
    let parts = items("oneOf").chain(element).cloned();
    let inside = members("properties").map(|(name, member)| (format!("{place}/{name}"), member.clone()));
    let below: Vec<_> = parts.map(|part| (place.to_owned(), part)).chain(inside).collect();
    let mut found: Vec<_> = items("allOf").flat_map(|part| anonymous(part, place)).collect();
    for (place, schema) in below {
        if schema["properties"].is_object() || schema["enum"].is_array() {
            found.push(place.clone());
        }
        found.extend(anonymous(&schema, &place));
    }
    found
}

#[test]
fn groups_and_lists_of_words_have_names() {
    let (_service, document) = document();
    let components = document["components"]["schemas"].as_object().unwrap();
    let nameless: Vec<_> = components
        .iter()
        .flat_map(|(name, schema)| anonymous(schema, name))
        .collect();
    assert!(components.len() > 100 && nameless.is_empty(), "{nameless:#?}");
    for (name, schema) in components {
        let own = json!({"$ref": format!("#/components/schemas/{name}")});
        let alternatives = schema["oneOf"].as_array();
        assert!(
            alternatives.is_none_or(|alternatives| !alternatives.contains(&own)),
            "{name} is one of itself"
        );
    }
    for operation in operations(&document) {
        let contents = operation["responses"]
            .as_object()
            .unwrap()
            .values()
            .chain([&operation["requestBody"]]);
        let bodies = contents.flat_map(|body| body["content"].as_object().into_iter().flatten());
        let parameters = operation["parameters"].as_array().into_iter().flatten();
        for schema in bodies
            .map(|(_, content)| &content["schema"])
            .chain(parameters.map(|one| &one["schema"]))
        {
            let is_named = !schema["properties"].is_object() && !schema["enum"].is_array();
            assert!(
                is_named && anonymous(schema, "").is_empty(),
                "{}: {schema}",
                operation["operationId"]
            );
        }
    }
}

#[test]
fn the_words_of_the_document_are_those_of_the_program() {
    let (service, document) = document();
    let words = |name: &str| document["components"]["schemas"][name]["enum"].clone();
    let listed = |name: &str| {
        let items = service.get(&format!("/v1/lists/{name}")).json()["items"].clone();
        let names: Vec<Value> = items
            .as_array()
            .unwrap()
            .iter()
            .map(|item| item["name"].clone())
            .collect();
        json!(names)
    };
    for (component, list) in [
        ("ArtifactKind", "artifacts"),
        ("Metric", "metrics"),
        ("EnhancementMethod", "enhancements"),
        ("SceneFamily", "families"),
        ("JobState", "states"),
        ("JerlovType", "jerlov-types"),
    ] {
        assert_eq!(words(component), listed(list), "{component}");
    }
    let metrics: Vec<_> = quality::MetricId::all().map(|id| id.to_string()).collect();
    assert_eq!(
        (words("Metric"), words("EnhancementMethod")),
        (json!(metrics), json!(enhance::METHODS))
    );
    let problems: Vec<_> = api::Slug::ALL
        .iter()
        .map(|slug| format!("/problems/{}", slug.name()))
        .collect();
    assert_eq!(words("ProblemType"), json!(problems));
    let laws: BTreeSet<_> = document["components"]["schemas"]["NumberLaw"]["oneOf"]
        .as_array()
        .unwrap()
        .iter()
        .map(|law| followed(&document, law)["required"][0].as_str().unwrap())
        .collect();
    assert_eq!(laws, BTreeSet::from(spec::law::KEYS));
}

#[test]
fn every_list_is_at_its_listed_path() {
    let (service, document) = document();
    let lists = service.get("/v1/lists").json();
    for list in lists["items"].as_array().unwrap() {
        let entries = service.get(list["path"].as_str().unwrap());
        assert_eq!(entries.status, 200, "{list}");
        assert!(entries.json()["items"].is_array(), "{list}");
    }
    let names = document["components"]["schemas"]["ListName"]["enum"]
        .as_array()
        .unwrap();
    assert!(names.contains(&json!("findings")) && !names.contains(&json!("waters")));
    let elsewhere = service.get("/v1/lists/waters").problem(404, "not-found");
    assert!(
        elsewhere["detail"].as_str().unwrap().contains("/v1/waters"),
        "{elsewhere}"
    );
    service.get("/v1/lists/nothing").problem(404, "not-found");
    let categories = service.get("/v1/lists/categories").json();
    assert_eq!(categories["items"][6]["number"], 6);
}
