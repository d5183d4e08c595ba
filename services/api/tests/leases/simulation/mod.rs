//! A hundred thousand random histories of a service and its workers.
//!
//! Messages are delayed, duplicated, lost and reordered; workers crash, stall past their leases and resume; the
//! service crashes between any two steps and restarts from its disk; its clock jumps; jobs are paused, cancelled and
//! retried.
//!
//! Failures: a frame with two images, or with none although it was not quarantined; an image accepted under a token
//! that is not the frame's latest, after the lease had expired, or for a quarantined frame; an ended frame that is
//! offered; a frame quarantined before its third strike; a history without an end.
//!
//! The simulation must also detect known bugs: two deliberately broken services must fail.

mod service;
mod world;

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use service::{Variant, Violation};
use world::World;

/// Half a minute of one processor; a break of a fence is found within a tenth of them.
const HISTORIES: u64 = 10_000;
/// Set to play more histories, different ones for each number.
const MORE: &str = "FATHOM_HISTORIES";
/// Broken services fail within this many histories.
const CAUGHT_WITHIN: u64 = 1_000;

/// Plays histories on all processors; returns the violations, with the numbers of their histories.
fn play(histories: u64, variant: Variant) -> BTreeSet<(u64, Violation)> {
    let (next, found) = (AtomicU64::new(0), AtomicBool::new(false));
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        let work = || {
            let mut violations = BTreeSet::new();
            loop {
                let number = next.fetch_add(1, Ordering::Relaxed);
                if number >= histories || (variant == Variant::Sound && found.load(Ordering::Relaxed)) {
                    return violations;
                }
                if let Err(violation) = World::new(number, variant).play() {
                    found.store(true, Ordering::Relaxed);
                    violations.insert((number, violation));
                }
            }
        };
        let threads: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        threads
            .into_iter()
            .flat_map(|thread| thread.join().unwrap())
            .collect()
    })
}

#[test]
fn in_no_history_is_a_promise_broken() {
    let histories = std::env::var(MORE).map_or(HISTORIES, |text| text.parse().unwrap());
    assert_eq!(play(histories, Variant::Sound), BTreeSet::new());
}

#[test]
fn a_service_that_does_not_look_at_tokens_is_caught() {
    let found = play(CAUGHT_WITHIN, Variant::NoFence);
    assert!(
        found
            .iter()
            .any(|(_, violation)| *violation == Violation::StaleToken),
        "{found:?}"
    );
}

#[test]
fn a_service_that_does_not_look_whether_a_frame_is_open_is_caught() {
    let found = play(CAUGHT_WITHIN, Variant::NoStateGuard);
    for expected in [
        Violation::TwoImages,
        Violation::LeaseHadEnded,
        Violation::WasGivenUp,
    ] {
        assert!(
            found.iter().any(|(_, violation)| *violation == expected),
            "{expected:?} in {found:?}"
        );
    }
}

#[test]
fn a_service_that_forgets_its_images_is_detected() {
    let found = play(CAUGHT_WITHIN, Variant::ForgetsImages);
    assert!(
        found
            .iter()
            .any(|(_, violation)| *violation == Violation::OfferedAgain),
        "{found:?}"
    );
}
