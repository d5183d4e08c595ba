//! The record of a frame as a worker sends it: refused, or with a digest that its own text has, too.
#![no_main]

use libfuzzer_sys::fuzz_target;
use wire::messages::{Claim, CommitRequest};

fuzz_target!(|json: &[u8]| {
    for frame in [0, 7] {
        let commit = CommitRequest {
            claim: Some(Claim {
                token: 1,
                job_id: "job_1".to_owned(),
                frame,
                attempt: 1,
            }),
            record_json: json.to_vec(),
        };
        let Ok(record) = commit.record() else { continue };
        assert_eq!(record.frame, frame);
        let text = serde_json::to_vec(&record).expect("a record is JSON");
        let again = CommitRequest {
            record_json: text,
            ..commit
        };
        let again = again.record().expect("its own text");
        assert_eq!(
            (again.digest(), again.artifacts),
            (record.digest(), record.artifacts)
        );
    }
});
