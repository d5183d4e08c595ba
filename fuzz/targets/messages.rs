//! A worker's message of any kind: refused, or complete and checked.
#![no_main]

use libfuzzer_sys::fuzz_target;
use proto::{decode, message, wire};

fuzz_target!(|bytes: &[u8]| {
    let Some((kind, bytes)) = bytes.split_first() else { return };
    match kind % 7 {
        0 => drop(decode::<wire::RegisterRequest, message::Register>(bytes)),
        1 => drop(decode::<wire::LeaseRequest, message::WantLease>(bytes)),
        2 => drop(decode::<wire::BeatRequest, message::BeatOf>(bytes)),
        3 => drop(decode::<wire::PutArtifactsRequest, message::PutArtifacts>(bytes)),
        4 => drop(decode::<wire::CommitRequest, message::Commit>(bytes)),
        5 => drop(decode::<wire::FailRequest, message::Fail>(bytes)),
        _ => drop(decode::<wire::ReleaseRequest, message::Release>(bytes)),
    }
});
