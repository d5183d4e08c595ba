use std::collections::BTreeMap;

use proptest::prelude::*;
use prost::Message;
use spec::{ArtifactEntry, Counts, FrameRecord, Intrinsics, Provenance, RangeFile, RangeKind, SceneFiles};

use crate::message::*;
use crate::{MessageError, wire};

/// Sends a message through bytes, as the transports do.
fn sent<M, W>(message: M) -> M
where
    M: TryFrom<W>,
    W: Message + Default + From<M>,
    M::Error: std::fmt::Debug,
{
    let bytes = W::from(message).encode_to_vec();
    M::try_from(W::decode(bytes.as_slice()).unwrap()).unwrap()
}

fn claim() -> Claim {
    Claim {
        token: u64::MAX,
        job_id: "job_1".to_owned(),
        frame: 7,
        attempt: 2,
    }
}

fn record() -> FrameRecord {
    let entry = ArtifactEntry {
        kind: "rgb".to_owned(),
        digest: "ab".repeat(32),
        bytes: 12,
        media_type: "image/png".to_owned(),
    };
    FrameRecord {
        frame: 7,
        parameters: serde_json::json!({"alpha": 0.1, "seed": u64::MAX}),
        optics: serde_json::Map::new(),
        plan: serde_json::json!([]),
        measurements: BTreeMap::from([("rgb".to_owned(), BTreeMap::from([("uiqm".to_owned(), 0.1 + 0.2)]))]),
        artifacts: vec![entry],
        counts: Counts {
            holes: 3,
            ..Counts::default()
        },
        timings_ms: BTreeMap::from([("water".to_owned(), 1.5)]),
        warnings: vec!["dark".to_owned()],
        scene: None,
        provenance: Provenance::default(),
    }
}

fn scene() -> SceneFiles<String> {
    let kind = RangeKind::ZDepth;
    SceneFiles {
        rgb: "01".repeat(32),
        range: Some(RangeFile {
            file: "23".repeat(32),
            kind,
            unit_m: Some(0.001),
            invalid_code: Some(65535),
        }),
        intrinsics: Some(Intrinsics {
            focal_px: 500.0,
            cx: 3.5,
            cy: -1.0,
        }),
        instances: Some("45".repeat(32)),
    }
}

#[test]
fn every_message_survives_the_wire_unchanged() {
    let register = Register {
        name: "n".to_owned(),
        slots: 4,
        code_version: "0.1".to_owned(),
        onnx_runtime: None,
        cpu_features: "avx2".to_owned(),
    };
    assert_eq!(sent::<_, wire::RegisterRequest>(register.clone()), register);
    let registered = Registered {
        worker_id: "wrk_1".to_owned(),
        lease_term_ms: 15_000,
        beat_ms: 5000,
    };
    assert_eq!(sent::<_, wire::RegisterResponse>(registered.clone()), registered);
    let want = WantLease {
        worker_id: "wrk_1".to_owned(),
        wait_ms: 100,
        frame_ms: 12.5,
    };
    assert_eq!(sent::<_, wire::LeaseRequest>(want.clone()), want);
    let lease = Lease {
        token: 9,
        job_id: "job_1".to_owned(),
        spec_digest: "0a".repeat(32),
        frames: vec![(0, 1), (99_999_999, 3)],
        term_ms: 15_000,
    };
    assert_eq!(sent::<_, wire::Lease>(lease.clone()), lease);
    let beat = BeatOf {
        worker_id: "wrk_1".to_owned(),
        tokens: vec![1, u64::MAX],
    };
    assert_eq!(sent::<_, wire::BeatRequest>(beat.clone()), beat);
    let answer = Beat {
        cancelled: vec![1],
        lost: vec![2, 3],
    };
    assert_eq!(sent::<_, wire::BeatResponse>(answer.clone()), answer);
    let release = Release {
        token: 4,
        reason: "stopped".to_owned(),
    };
    assert_eq!(sent::<_, wire::ReleaseRequest>(release.clone()), release);
}

#[test]
fn what_is_said_of_a_frame_survives_the_wire_unchanged() {
    let artifact = Artifact {
        kind: "enhanced.hscm".to_owned(),
        media_type: "image/png".to_owned(),
        data: vec![0, 255],
        digest: "0f".repeat(32),
    };
    let put = PutArtifacts {
        claim: claim(),
        artifacts: vec![artifact],
    };
    assert_eq!(sent::<_, wire::PutArtifactsRequest>(put.clone()), put);
    let commit = Commit {
        claim: claim(),
        record: record(),
    };
    assert_eq!(sent::<_, wire::CommitRequest>(commit.clone()), commit);
    let timings_ms = BTreeMap::from([("scene".to_owned(), 3.0)]);
    let fail = Fail {
        claim: claim(),
        error: "no".to_owned(),
        retryable: true,
        timings_ms,
    };
    assert_eq!(sent::<_, wire::FailRequest>(fail.clone()), fail);
    assert_eq!(sent::<_, wire::SceneResponse>(scene()), scene());
    let styles = vec![Style {
        name: "muddy".to_owned(),
        card_json: "{}".to_owned(),
    }];
    assert_eq!(sent::<_, wire::StylesResponse>(styles.clone()), styles);
    let bare = SceneFiles {
        range: None,
        intrinsics: None,
        instances: None,
        ..scene()
    };
    assert_eq!(sent::<_, wire::SceneResponse>(bare.clone()), bare);
}

#[test]
fn an_absent_field_is_named() {
    let error = Lease::try_from(wire::Lease::default()).unwrap_err();
    assert_eq!(error, MessageError::Missing { field: "frames" });
    let mut wire = wire::FailRequest::from(Fail {
        claim: claim(),
        error: String::new(),
        retryable: false,
        timings_ms: BTreeMap::new(),
    });
    wire.attempt = 0;
    assert_eq!(
        Fail::try_from(wire).unwrap_err().to_string(),
        "`attempt` is missing"
    );
}

#[test]
fn a_record_of_another_frame_or_of_no_json_is_refused() {
    let mut wire = wire::CommitRequest::from(Commit {
        claim: claim(),
        record: record(),
    });
    wire.frame = 8;
    let error = Commit::try_from(wire.clone()).unwrap_err().to_string();
    assert_eq!(
        error,
        "`record_json` is no frame record: it is of frame 7, the claim is on frame 8"
    );
    wire.record_json = b"{".to_vec();
    assert!(matches!(Commit::try_from(wire), Err(MessageError::Record(_))));
}

#[test]
fn text_that_could_become_a_path_or_a_header_is_refused() {
    let artifact = |kind: &str, media_type: &str, digest: &str| {
        Artifact::try_from(wire::Artifact {
            kind: kind.to_owned(),
            media_type: media_type.to_owned(),
            data: Vec::new(),
            digest: digest.to_owned(),
        })
    };
    let digest = "ab".repeat(32);
    assert!(artifact("rgb", "image/png", &digest).is_ok());
    assert!(artifact("../rgb", "image/png", &digest).is_err());
    assert!(artifact("enhanced.a/b", "image/png", &digest).is_err());
    assert!(artifact("rgb", "image/png\r\nx: y", &digest).is_err());
    assert!(artifact("rgb", "image/png", &digest.to_uppercase()).is_err());
}

#[test]
fn too_many_and_too_long_are_refused_with_the_limit() {
    let tokens = vec![1; crate::limits::BEAT_TOKENS + 1];
    let error = BeatOf::try_from(wire::BeatRequest {
        worker_id: "wrk_1".to_owned(),
        tokens,
    })
    .unwrap_err();
    assert_eq!(error.to_string(), "`tokens` has 4097 tokens, the limit is 4096");
    let name = "x".repeat(1000);
    let request = wire::RegisterRequest {
        name,
        slots: 1,
        protocol: crate::VERSION,
        ..wire::RegisterRequest::default()
    };
    assert!(matches!(
        Register::try_from(request),
        Err(MessageError::TooLong { field: "name", .. })
    ));
}

#[test]
fn another_version_of_the_protocol_is_refused_with_a_word_on_what_to_do() {
    let request = wire::RegisterRequest {
        name: "old".to_owned(),
        slots: 1,
        ..wire::RegisterRequest::default()
    };
    let error = Register::try_from(request).unwrap_err().to_string();
    assert!(
        error.contains("version 0") && error.contains("same version of fathom"),
        "{error}"
    );
    let response = wire::RegisterResponse {
        worker_id: "wrk_1".to_owned(),
        lease_term_ms: 1,
        beat_ms: 1,
        protocol: 1,
    };
    assert!(matches!(
        Registered::try_from(response),
        Err(MessageError::Protocol { theirs: 1, .. })
    ));
}

fn arrives<M: TryFrom<W>, W: Message + Default>(bytes: &[u8]) -> bool {
    W::decode(bytes).is_ok_and(|wire| M::try_from(wire).is_ok())
}

fn all(bytes: &[u8]) -> [bool; 9] {
    [
        arrives::<Register, wire::RegisterRequest>(bytes),
        arrives::<Registered, wire::RegisterResponse>(bytes),
        arrives::<WantLease, wire::LeaseRequest>(bytes),
        arrives::<Lease, wire::Lease>(bytes),
        arrives::<BeatOf, wire::BeatRequest>(bytes),
        arrives::<PutArtifacts, wire::PutArtifactsRequest>(bytes),
        arrives::<Commit, wire::CommitRequest>(bytes),
        arrives::<Fail, wire::FailRequest>(bytes),
        arrives::<SceneFiles<String>, wire::SceneResponse>(bytes),
    ]
}

proptest! {
    #[test]
    fn garbage_is_refused_or_accepted_but_never_panics(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        all(&bytes);
    }

    #[test]
    fn a_damaged_message_never_panics(at in 0usize..10_000, byte in any::<u8>(), cut in 0usize..10_000) {
        let messages = [
            wire::CommitRequest::from(Commit { claim: claim(), record: record() }).encode_to_vec(),
            wire::SceneResponse::from(scene()).encode_to_vec(),
        ];
        for mut bytes in messages {
            let length = bytes.len();
            bytes[at % length] = byte;
            all(&bytes);
            all(&bytes[..cut % length]);
        }
    }
}
