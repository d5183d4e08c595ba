use std::collections::BTreeMap;

use proptest::prelude::*;
use prost::Message;
use serde_json::json;

use super::*;
use crate::decode;
use crate::messages::FrameClaim;

fn claimed() -> Option<Claim> {
    Some(Claim {
        token: u64::MAX,
        job_id: "job_1".to_owned(),
        frame: 7,
        attempt: 2,
    })
}

fn commit() -> CommitRequest {
    let artifact = json!({"kind": "rgb", "digest": "ab".repeat(32), "bytes": 12, "media_type": "image/png"});
    let record = FrameRecord {
        frame: 7,
        parameters: json!({"alpha": 0.1, "seed": u64::MAX}),
        optics: serde_json::Map::new(),
        plan: json!([]),
        promise: None,
        measurements: BTreeMap::from([("rgb".to_owned(), BTreeMap::from([("uiqm".to_owned(), 0.1 + 0.2)]))]),
        artifacts: vec![serde_json::from_value(artifact).unwrap()],
        counts: spec::Counts::default(),
        timings_ms: BTreeMap::from([("water".to_owned(), 1.5)]),
        warnings: vec!["dark".to_owned()],
        scene: None,
        truth: None,
        provenance: spec::Provenance::default(),
    };
    CommitRequest {
        claim: claimed(),
        record_json: serde_json::to_vec(&record).unwrap(),
    }
}

fn register() -> RegisterRequest {
    RegisterRequest {
        name: "n".to_owned(),
        slots: 4,
        onnx_runtime: Some("1.24".to_owned()),
        protocol: crate::VERSION,
        ..RegisterRequest::default()
    }
}

fn lease() -> Lease {
    Lease {
        token: 9,
        job_id: "job_1".to_owned(),
        spec_digest: "0a".repeat(32),
        frames: vec![FrameClaim { frame: 0, attempt: 1 }],
        term_ms: 15_000,
    }
}

fn artifact_of(kind: &str, media_type: &str, digest: &str) -> PutArtifactsRequest {
    PutArtifactsRequest {
        claim: claimed(),
        artifacts: vec![Artifact {
            kind: kind.to_owned(),
            media_type: media_type.to_owned(),
            data: vec![0, 255],
            digest: digest.to_owned(),
        }],
    }
}

#[test]
fn whole_messages_pass_and_keep_every_field() {
    assert_eq!(decode(&register().encode_to_vec()), Ok(register()));
    assert_eq!(decode(&lease().encode_to_vec()), Ok(lease()));
    let sent = commit();
    let arrived: CommitRequest = decode(&sent.encode_to_vec()).unwrap();
    let record = arrived.record().unwrap();
    assert_eq!(serde_json::to_vec(&record).unwrap(), sent.record_json);
    assert_eq!(record.parameters["seed"], u64::MAX);
}

#[test]
fn an_absent_field_is_named() {
    assert_eq!(
        Lease::default().check().unwrap_err().to_string(),
        "`frames` is missing"
    );
    assert_eq!(
        FailRequest::default().check().unwrap_err().to_string(),
        "`claim` is missing"
    );
    let mut fail = FailRequest {
        claim: claimed(),
        ..FailRequest::default()
    };
    assert_eq!(fail.check(), Ok(()));
    fail.claim.as_mut().unwrap().attempt = 0;
    assert_eq!(fail.check().unwrap_err().to_string(), "`attempt` is missing");
}

#[test]
fn a_record_of_another_frame_or_of_no_json_is_refused() {
    let mut sent = commit();
    sent.claim.as_mut().unwrap().frame = 8;
    assert_eq!(
        sent.record().unwrap_err().to_string(),
        "`record_json` is not a frame record: it belongs to frame 7, but the claim is for frame 8"
    );
    sent.record_json = b"{".to_vec();
    assert!(matches!(sent.record(), Err(MessageError::Record(_))));
}

#[test]
fn text_that_could_become_a_path_or_a_header_is_refused() {
    let digest = "ab".repeat(32);
    assert_eq!(artifact_of("rgb", "image/png", &digest).check(), Ok(()));
    for refused in [
        artifact_of("../rgb", "image/png", &digest),
        artifact_of("enhanced.a/b", "image/png", &digest),
        artifact_of("rgb", "image/png\r\nx: y", &digest),
        artifact_of("rgb", "image/png", &digest.to_uppercase()),
    ] {
        assert!(refused.check().is_err(), "{refused:?}");
    }
}

#[test]
fn too_many_and_too_long_are_refused_with_the_limit() {
    let beat = BeatRequest {
        worker_id: "wrk_1".to_owned(),
        tokens: vec![1; limits::BEAT_TOKENS + 1],
        wait_ms: 0,
    };
    assert_eq!(
        beat.check().unwrap_err().to_string(),
        "`tokens` has 4097 tokens; must be at most 4096"
    );
    let request = RegisterRequest {
        name: "x".repeat(1000),
        ..register()
    };
    assert!(matches!(
        request.check(),
        Err(MessageError::TooLong { field: "name", .. })
    ));
}

#[test]
fn another_version_of_the_protocol_is_refused_with_a_hint() {
    let request = RegisterRequest {
        protocol: 0,
        ..register()
    };
    let error = request.check().unwrap_err().to_string();
    assert!(
        error.contains("version 0") && error.contains("same version of fathom"),
        "{error}"
    );
    let response = RegisterResponse {
        worker_id: "wrk_1".to_owned(),
        lease_term_ms: 1,
        beat_ms: 1,
        protocol: 1,
    };
    assert!(matches!(
        response.check(),
        Err(MessageError::Protocol { theirs: 1, .. })
    ));
}

fn decode_as_all(bytes: &[u8]) {
    let _ = decode::<RegisterRequest>(bytes);
    let _ = decode::<RegisterResponse>(bytes);
    let _ = decode::<LeaseRequest>(bytes);
    let _ = decode::<LeaseResponse>(bytes);
    let _ = decode::<BeatRequest>(bytes);
    let _ = decode::<PutArtifactsRequest>(bytes);
    let _ = decode::<CommitRequest>(bytes).and_then(|commit| commit.record());
    let _ = decode::<FailRequest>(bytes);
    let _ = decode::<StylesResponse>(bytes);
}

proptest! {
    #[test]
    fn garbage_is_refused_or_accepted_but_never_panics(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        decode_as_all(&bytes);
    }

    #[test]
    fn a_damaged_message_never_panics(at in 0usize..10_000, byte in any::<u8>(), cut in 0usize..10_000) {
        for mut bytes in [commit().encode_to_vec(), lease().encode_to_vec()] {
            let length = bytes.len();
            bytes[at % length] = byte;
            decode_as_all(&bytes);
            decode_as_all(&bytes[..cut % length]);
        }
    }
}
