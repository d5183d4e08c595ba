//! A worker's message of any kind: refused, or complete and checked.
#![no_main]

use libfuzzer_sys::fuzz_target;
use wire::{decode, messages};

fuzz_target!(|bytes: &[u8]| {
    let Some((kind, bytes)) = bytes.split_first() else {
        return;
    };
    match kind % 7 {
        0 => drop(decode::<messages::RegisterRequest>(bytes)),
        1 => drop(decode::<messages::LeaseRequest>(bytes)),
        2 => drop(decode::<messages::BeatRequest>(bytes)),
        3 => drop(decode::<messages::PutArtifactsRequest>(bytes)),
        4 => drop(decode::<messages::CommitRequest>(bytes).and_then(|commit| commit.record())),
        5 => drop(decode::<messages::FailRequest>(bytes)),
        _ => drop(decode::<messages::ReleaseRequest>(bytes)),
    }
});
