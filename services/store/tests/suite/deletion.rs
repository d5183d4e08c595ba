//! Deletion and compaction.
//!
//! Failures: a live blob that a reader cannot find at any moment; a deleted blob that reappears; space that is not
//! reclaimed.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use store::{Blob, Scrubbed, Store, StoreError};

use crate::fixture::{blob, digests, holds_all, numbered, packs, put_one_by_one, size};

const PACK_BYTES: u64 = 2_000_000;

fn some(blobs: std::ops::Range<u64>) -> Vec<Blob> {
    blobs.map(|number| numbered(number, 100_000)).collect()
}

#[tokio::test]
async fn deleted_blobs_are_gone_also_after_a_restart_and_can_be_stored_again() {
    let folder = tempfile::tempdir().unwrap();
    let (store, blobs) = (Store::open(folder.path()).await.unwrap(), some(0..4));
    store.put_all(blobs.clone()).await.unwrap();
    assert_eq!(store.delete(&digests(&blobs[..2])).await.unwrap(), 200_000);
    assert_eq!(store.delete(&digests(&blobs[..2])).await.unwrap(), 0, "again");
    assert!(matches!(
        store.delete(&["x".to_owned()]).await,
        Err(StoreError::NotADigest { .. })
    ));
    drop(store);
    let store = Store::open(folder.path()).await.unwrap();
    assert_eq!(store.get(&blobs[0].digest).await.unwrap(), None);
    assert_eq!(store.scrub(&blobs[1].digest).await.unwrap(), Scrubbed::Missing);
    assert_eq!((store.stats().blobs, store.stats().bytes), (2, 200_000));
    holds_all(&store, &blobs[2..]).await;
    store.put_all(blobs[..1].to_vec()).await.unwrap();
    holds_all(&store, &blobs[..1]).await;
}

#[tokio::test]
async fn compaction_frees_only_deleted_blobs() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open_with(folder.path(), PACK_BYTES).await.unwrap();
    let blobs = some(0..100);
    put_one_by_one(&store, &blobs).await;
    assert_eq!(store.compact().await.unwrap().packs, 0, "nothing is deleted");
    // All blobs of the first packs, two thirds of later ones, none of the last.
    let (gone, live): (Vec<Blob>, Vec<Blob>) = blobs
        .into_iter()
        .enumerate()
        .map(|(at, blob)| (at < 40 || (at < 70 && at % 3 > 0), blob))
        .fold((vec![], vec![]), |(mut gone, mut live), (dead, blob)| {
            if dead {
                gone.push(blob)
            } else {
                live.push(blob)
            }
            (gone, live)
        });
    store.delete(&digests(&gone)).await.unwrap();
    let done = store.compact().await.unwrap();
    assert!(done.packs >= 3, "{done:?}");
    assert!(done.bytes_freed > 5_000_000, "{done:?}");
    holds_all(&store, &live).await;
    assert_eq!(
        store.compact().await.unwrap().packs,
        0,
        "a second time has nothing to do"
    );
    store.close().await;
    let after = size(folder.path());
    assert!(after < 7_500_000, "{after} bytes for {} blobs", live.len());
    let store = Store::open_with(folder.path(), PACK_BYTES).await.unwrap();
    holds_all(&store, &live).await;
    assert_eq!(store.stats().blobs, live.len() as u64);
}

#[tokio::test]
async fn an_only_pack_that_is_emptied_leaves_no_file_behind() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).await.unwrap();
    let blobs = some(0..5);
    store.put_all(blobs.clone()).await.unwrap();
    holds_all(&store, &blobs).await;
    store.delete(&digests(&blobs)).await.unwrap();
    assert_eq!(store.compact().await.unwrap().packs, 1);
    assert_eq!(size(folder.path()), 0);
    store.put_all(blobs.clone()).await.unwrap();
    holds_all(&store, &blobs).await;
    assert_eq!(packs(folder.path())[0].file_name().unwrap(), "pack-000002.sqlite");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn readers_and_writers_never_miss_a_live_blob_while_packs_are_rewritten() {
    let folder = tempfile::tempdir().unwrap();
    let store = Arc::new(Store::open_with(folder.path(), PACK_BYTES).await.unwrap());
    let blobs = some(0..120);
    put_one_by_one(&store, &blobs).await;
    let (live, dead): (Vec<_>, Vec<_>) = blobs.into_iter().enumerate().partition(|(at, _)| at % 4 == 0);
    let live: Arc<Vec<Blob>> = Arc::new(live.into_iter().map(|(_, blob)| blob).collect());
    let dead: Vec<Blob> = dead.into_iter().map(|(_, blob)| blob).collect();
    let over = Arc::new(AtomicBool::new(false));
    let mut tasks = tokio::task::JoinSet::new();
    for start in 0..6 {
        let (store, live, over) = (Arc::clone(&store), Arc::clone(&live), Arc::clone(&over));
        tasks.spawn(async move {
            let mut reads = 0;
            while !over.load(Ordering::SeqCst) {
                holds_all(&store, &live[start * 4..]).await;
                reads += 1;
            }
            reads
        });
    }
    let writing = Arc::clone(&store);
    let written = tokio::spawn(async move { put_one_by_one(&writing, &some(1000..1040)).await });
    for part in dead.chunks(15) {
        store.delete(&digests(part)).await.unwrap();
        store.compact().await.unwrap();
    }
    written.await.unwrap();
    over.store(true, Ordering::SeqCst);
    while let Some(reads) = tasks.join_next().await {
        assert!(reads.unwrap() > 0);
    }
    holds_all(&store, &live).await;
    holds_all(&store, &some(1000..1040)).await;
    assert_eq!(store.stats().blobs, 70);
}

#[tokio::test(flavor = "multi_thread")]
async fn an_interrupted_compaction_loses_no_blob_and_can_be_repeated() {
    for cut_us in [0, 200, 1_000, 3_000, 6_000, 10_000, 15_000, 25_000, 40_000] {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open_with(folder.path(), PACK_BYTES).await.unwrap();
        let blobs = some(0..60);
        put_one_by_one(&store, &blobs).await;
        store.delete(&digests(&blobs[..45])).await.unwrap();
        let _ = tokio::time::timeout(Duration::from_micros(cut_us), store.compact()).await;
        // The writer may still be busy with its last step; a folder has one store at a time.
        store.close().await;
        let store = Store::open_with(folder.path(), PACK_BYTES).await.unwrap();
        holds_all(&store, &blobs[45..]).await;
        assert_eq!(store.stats().blobs, 15, "cut off after {cut_us} us");
        store.compact().await.unwrap();
        holds_all(&store, &blobs[45..]).await;
        store.close().await;
        assert!(size(folder.path()) < 3_500_000, "{}", size(folder.path()));
    }
}

#[tokio::test]
async fn a_copy_opens_and_has_everything_that_was_stored_before() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open_with(folder.path(), PACK_BYTES).await.unwrap();
    let blobs = some(0..50);
    put_one_by_one(&store, &blobs).await;
    let target = folder.path().join("copy");
    let more = some(50..60);
    let (copied, ()) = tokio::join!(store.backup(&target), put_one_by_one(&store, &more));
    copied.unwrap();
    let copy = Store::open_with(&target, PACK_BYTES).await.unwrap();
    holds_all(&copy, &blobs).await;
    copy.put_all(vec![blob(b"one more")]).await.unwrap();
    assert!(store.backup(&target).await.is_err(), "a copy that is there stays");
}
