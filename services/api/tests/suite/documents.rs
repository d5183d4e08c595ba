//! The OpenAPI document says what the service does.

use crate::common::start;

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
    ("/v1/datasets/{name}/histogram", "get"),
    ("/v1/datasets/{name}/metadata.jsonl", "get"),
    ("/v1/datasets/{name}/metadata.csv", "get"),
    ("/v1/enhance", "post"),
    ("/v1/measure", "post"),
    ("/v1/scenes", "post"),
    ("/v1/scenes", "get"),
    ("/v1/waters", "get"),
    ("/v1/waters", "post"),
    ("/v1/waters/{name}", "get"),
    ("/v1/waters/{name}", "delete"),
    ("/v1/styles", "get"),
    ("/v1/styles", "post"),
    ("/v1/styles/train", "post"),
    ("/v1/styles/trainings/{id}", "get"),
    ("/v1/styles/trainings/{id}", "delete"),
    ("/v1/datasets", "get"),
    ("/v1/datasets/{name}", "get"),
    ("/v1/datasets/{name}", "delete"),
    ("/v1/datasets/{name}/stats", "get"),
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
