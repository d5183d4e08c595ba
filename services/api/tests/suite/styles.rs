//! Styles that the service has and a worker does not.

use crate::common::worker::Real;
use crate::common::{Setup, job, start_with};
use serde_json::json;
use style::Library;

#[test]
fn a_worker_fetches_a_style_that_it_lacks() {
    let embedded = Library::embedded().unwrap();
    let onnx = embedded.get("muddy").unwrap().onnx.to_vec();
    let library = embedded.with_model("harbour", onnx.clone(), None).unwrap();
    let service = start_with(Setup {
        library: Some(library),
        ..Setup::default()
    });
    let mut styled = job();
    styled["water"]["style"] = json!({"grid": ["harbour", "muddy"]});
    styled["count"] = json!(1);
    // Started before the job is there, with the shipped styles alone.
    let _worker = Real::start(&service);
    let id = service.submit(&styled);
    let ended = service.get(&format!("/v1/jobs/{id}?wait=60")).json();
    assert_eq!(ended["state"], "done", "{ended}");
    let digest = |frame: u64| {
        let record = service.get(&format!("/v1/images/{id}/{frame}")).json();
        record["artifacts"][0]["digest"].as_str().unwrap().to_owned()
    };
    assert_eq!(digest(0), digest(1), "the same network under two names");
    let file = service.get("/v1/worker/styles/harbour");
    assert_eq!((file.status, file.body), (200, onnx));
    service.get("/v1/worker/styles/nowhere").problem(404, "not-found");
}
