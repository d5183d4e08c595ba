//! Bytes that a worker, a set or a user chose are never run by a browser, nor embedded by other sites.

use serde_json::json;

use crate::common::bytes::{noise_png, png};
use crate::common::worker::Fake;
use crate::common::{Answer, job, start};

fn check(what: &str, answer: &Answer) {
    assert!(
        [200, 206, 304].contains(&answer.status),
        "{what}: {}",
        answer.text()
    );
    for (header, value) in [
        ("content-security-policy", "sandbox; default-src 'none'"),
        ("x-content-type-options", "nosniff"),
        ("cross-origin-resource-policy", "same-origin"),
    ] {
        assert_eq!(answer.header(header), value, "{what}: {header}");
    }
}

#[test]
fn artifacts_previews_archives_and_enhanced_pictures_are_sandboxed() {
    let service = start();
    let worker = Fake::register(&service);
    let mut one = job();
    one["count"] = json!(1);
    one["camera"] = json!({"width": 32, "height": 32, "hfov_deg": 80});
    let id = service.submit(&one);
    let lease = worker.lease(5000).expect("a frame");
    worker.finish_with(&lease, noise_png(32, 1)).unwrap();
    let image = format!("/v1/images/{id}/0");
    let artifact = service.get(&format!("{image}/artifacts/rgb"));
    check("an artifact", &artifact);
    let tag = artifact.header("etag").to_owned();
    let known = service.get_with(&format!("{image}/artifacts/rgb"), &[("if-none-match", &tag)]);
    assert_eq!(known.status, 304);
    check("a known artifact", &known);
    let part = service.get_with(&format!("{image}/artifacts/rgb"), &[("range", "bytes=0-9")]);
    assert_eq!(part.status, 206);
    check("a part", &part);
    check("a preview", &service.get(&format!("{image}/preview")));
    check(
        "an archive",
        &service.get(&format!("{image}/artifacts?kinds=rgb&record=true")),
    );
    let enhanced = service.form("/v1/enhance?method=hscm", &[("picture", &png(32, 32))]);
    check("an enhanced picture", &enhanced);
}
