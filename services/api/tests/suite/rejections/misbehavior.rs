//! Workers with impossible reports.

use renderer::worker::client::ClientError;
use serde_json::json;
use wire::messages::{Artifact, PutArtifactsRequest};

use crate::common::bytes::numbered_png;
use crate::common::worker::{Fake, claim, commit, record};
use crate::common::{job, start};

fn refused(outcome: Result<bool, ClientError>) -> String {
    match outcome {
        Err(ClientError::Refused { status: 400, problem }) => problem.to_string(),
        other => panic!("not refused: {other:?}"),
    }
}

#[test]
fn a_misbehaving_worker_is_dismissed_after_three_reports_and_others_finish_its_frames() {
    let service = start();
    let id = service.submit(&job());
    let worker = Fake::register(&service);

    // A frame without its image.
    let lease = worker.lease(1000).unwrap();
    let frame = worker.frame(&lease).unwrap();
    let mut lie = record(&frame, &"ab".repeat(32), 9);
    lie.artifacts.clear();
    let said = refused(worker.client.commit(&commit(claim(&lease), &lie)));
    assert!(said.contains("`rgb` is missing"), "{said}");
    // The lease has lost the frame, which is offered again.
    assert!(matches!(worker.finish(&lease), Err(ClientError::Stale)));

    // Parameters other than those of the description.
    let lease = worker.lease(1000).unwrap();
    let picture = numbered_png(32, 24, 0);
    let digest = spec::sha256(&picture);
    let file = |media_type: &str| Artifact {
        kind: "rgb".into(),
        media_type: media_type.into(),
        data: picture.clone(),
        digest: digest.clone(),
    };
    let put = |lease, media_type| {
        worker.client.put_artifacts(&PutArtifactsRequest {
            claim: Some(claim(lease)),
            artifacts: vec![file(media_type)],
        })
    };
    put(&lease, "image/png").unwrap();
    let mut lie = record(&worker.frame(&lease).unwrap(), &digest, picture.len() as u64);
    lie.parameters["alpha"] = json!(0.123);
    let said = refused(worker.client.commit(&commit(claim(&lease), &lie)));
    assert!(said.contains("/parameters/alpha"), "{said}");

    // An image that is an HTML page.
    let lease = worker.lease(1000).unwrap();
    let said = refused(put(&lease, "text/html").map(|()| true));
    assert!(said.contains("not text/html"), "{said}");

    // The worker is dismissed, and so is its name.
    assert!(worker.try_lease(0).is_err());
    assert!(
        service.get("/v1/workers").json()["items"]
            .as_array()
            .unwrap()
            .is_empty()
    );
    let again = Fake::try_named(&service, "fake", None);
    assert!(again.is_err_and(|error| error.to_string().contains("dismissed")));

    let honest = Fake::try_named(&service, "honest", None).unwrap();
    honest.work();
    let done = service.get(&format!("/v1/jobs/{id}")).json();
    assert_eq!(
        (&done["state"], &done["done"]),
        (&json!("done"), &json!(2)),
        "{done}"
    );
}
