//! A worker's message of any kind: refused, or complete and checked.
#![no_main]

use libfuzzer_sys::fuzz_target;
use proto::{decode, wire};

fuzz_target!(|bytes: &[u8]| {
    let Some((kind, bytes)) = bytes.split_first() else { return };
    match kind % 7 {
        0 => drop(decode::<wire::RegisterRequest>(bytes)),
        1 => drop(decode::<wire::LeaseRequest>(bytes)),
        2 => drop(decode::<wire::BeatRequest>(bytes)),
        3 => drop(decode::<wire::PutArtifactsRequest>(bytes)),
        4 => drop(decode::<wire::CommitRequest>(bytes).and_then(|commit| commit.record())),
        5 => drop(decode::<wire::FailRequest>(bytes)),
        _ => drop(decode::<wire::ReleaseRequest>(bytes)),
    }
});
