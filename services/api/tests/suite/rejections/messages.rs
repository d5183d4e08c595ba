//! Messages of workers are checked before they have any effect.

use crate::common::Running;
use crate::common::bytes::png;
use crate::common::worker::{Fake, claim, commit, record};
use crate::rejections::bad_input::nothing_changes;
use prost::Message;
use serde_json::Value;
use wire::limits;
use wire::messages;

const PROTOBUF: [(&str, &str); 1] = [("content-type", "application/x-protobuf")];

const CALLS: [&str; 7] = [
    "register",
    "lease",
    "beat",
    "artifacts",
    "commit",
    "fail",
    "release",
];

fn refused(service: &Running, call: &str, message: &impl Message) -> Value {
    let path = format!("/v1/worker/{call}");
    let answer = service.post_with(&path, &PROTOBUF, &message.encode_to_vec());
    answer.problem(400, "invalid-body")
}

fn detail(problem: &Value) -> &str {
    problem["detail"].as_str().unwrap()
}

#[test]
fn bytes_that_are_no_message_are_refused() {
    nothing_changes(|service| {
        for call in CALLS {
            let path = format!("/v1/worker/{call}");
            for bytes in [&[0xff; 40][..], &[0x0a, 9, b'x'], b""] {
                service
                    .post_with(&path, &PROTOBUF, bytes)
                    .problem(400, "invalid-body");
            }
            service
                .post_with(&path, &[], b"")
                .problem(415, "unsupported-media-type");
        }
    });
}

#[test]
fn a_worker_with_another_protocol_version_gets_instructions() {
    nothing_changes(|service| {
        for protocol in [0, wire::VERSION - 1, wire::VERSION + 1] {
            let about = messages::RegisterRequest {
                name: "other".to_owned(),
                slots: 1,
                protocol,
                ..messages::RegisterRequest::default()
            };
            let problem = refused(service, "register", &about);
            let said = format!(
                "the other side uses version {protocol} of the worker protocol and this side version {}; run the same \
                 version of fathom for service and workers",
                wire::VERSION
            );
            assert_eq!(detail(&problem), said);
            assert_eq!(service.get("/v1/workers").json()["items"], serde_json::json!([]));
        }
    });
}

#[test]
fn a_field_that_is_missing_too_long_or_out_of_its_range_is_named_with_the_limit() {
    nothing_changes(|service| {
        let about = messages::RegisterRequest {
            name: "n".repeat(limits::NAME_BYTES + 1),
            slots: 1,
            protocol: wire::VERSION,
            ..messages::RegisterRequest::default()
        };
        let problem = refused(service, "register", &about);
        assert!(
            detail(&problem).contains("`name` has 257 bytes; must be at most 256"),
            "{problem}"
        );
        let about = messages::RegisterRequest {
            name: "n".to_owned(),
            slots: limits::SLOTS + 1,
            ..about
        };
        let problem = refused(service, "register", &about);
        assert!(
            detail(&problem).contains("`slots` is 1025") && detail(&problem).contains("1024"),
            "{problem}"
        );
        let beat = messages::BeatRequest {
            worker_id: "wrk_1".to_owned(),
            wait_ms: 0,
            tokens: vec![1; limits::BEAT_TOKENS + 1],
        };
        let problem = refused(service, "beat", &beat);
        assert!(detail(&problem).contains("must be at most 4096"), "{problem}");
        let want = messages::LeaseRequest {
            worker_id: "wrk_1".to_owned(),
            wait_ms: 0,
            frame_ms: f64::NAN,
        };
        let problem = refused(service, "lease", &want);
        assert!(detail(&problem).contains("`frame_ms` is NaN"), "{problem}");
        let problem = refused(service, "release", &messages::ReleaseRequest::default());
        assert!(detail(&problem).contains("`token` is missing"), "{problem}");
    });
}

#[test]
fn artifacts_that_are_too_many_or_have_names_like_paths_are_not_stored() {
    nothing_changes(|service| {
        let worker = Fake::register(service);
        let lease = worker.lease(1000).unwrap();
        let held = claim(&lease);
        let put = |artifacts: Vec<messages::Artifact>| messages::PutArtifactsRequest {
            claim: Some(held.clone()),
            artifacts,
        };
        let many = vec![messages::Artifact::default(); limits::ARTIFACTS + 1];
        let problem = refused(service, "artifacts", &put(many));
        assert!(
            detail(&problem).contains("65 artifacts; must be at most 64"),
            "{problem}"
        );
        // A hundred bytes each in memory, two on the wire.
        let bomb = put(vec![messages::Artifact::default(); 1_000_000]);
        let problem = refused(service, "artifacts", &bomb);
        assert!(
            detail(&problem).contains("fields; must be at most 8192"),
            "{problem}"
        );
        let path = messages::Artifact {
            kind: "../../rgb".to_owned(),
            media_type: "image/png".to_owned(),
            data: vec![1],
            digest: "ab".repeat(32),
        };
        let problem = refused(service, "artifacts", &put(vec![path.clone()]));
        assert!(detail(&problem).contains("../../rgb"), "{problem}");
        let wrong_digest = messages::Artifact {
            kind: "rgb".to_owned(),
            data: png(32, 24),
            ..path
        };
        let problem = refused(service, "artifacts", &put(vec![wrong_digest]));
        assert!(detail(&problem).contains("its bytes have digest"), "{problem}");
        worker.release(&lease);
    });
}

#[test]
fn a_record_of_another_frame_or_of_files_that_were_not_stored_is_no_image() {
    nothing_changes(|service| {
        let worker = Fake::register(service);
        let lease = worker.lease(1000).unwrap();
        let held = claim(&lease);
        let record = record(&worker.frame(&lease).unwrap(), &"ab".repeat(32), 9);
        let mut commit = commit(held, &record);
        let problem = refused(service, "commit", &commit);
        assert!(detail(&problem).contains("was not stored"), "{problem}");
        commit.claim.as_mut().unwrap().frame += 1;
        let problem = refused(service, "commit", &commit);
        assert!(detail(&problem).contains("not a frame record"), "{problem}");
        worker.release(&lease);
    });
}
