//! A full disk: the call reports it, stored blobs stay readable, and writing works again once there is space.
//!
//! The disk is a small file system in memory, see [`on_a_small_disk`]. Where it cannot be mounted the test fails.

use std::path::Path;

use store::{Blob, Store, StoreError};

use crate::fixture::{digests, holds_all, numbered};

#[path = "../../../../tests/src/small_disk.rs"]
mod small_disk;

const DISK: &str = "size=40m";
const BALLAST_BYTES: usize = 6 << 20;
const PACK_BYTES: u64 = 4_000_000;

#[test]
fn a_full_disk_stops_only_writes() {
    small_disk::run("full::on_a_small_disk", DISK);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "run by the test above, on a small disk"]
async fn on_a_small_disk() {
    let folder = std::env::var_os(small_disk::FOLDER).expect("started by the test above");
    let folder = Path::new(&folder);
    for name in ["one", "two"] {
        std::fs::write(folder.join(name), vec![7; BALLAST_BYTES]).unwrap();
    }
    let store = Store::open_with(folder, PACK_BYTES).await.unwrap();
    let mut stored = fill(&store, 0).await;
    assert!(stored.len() > 10, "{}", stored.len());
    // Repeated attempts leave no partial data.
    for number in 5000..5010 {
        let late = numbered(number, 500_000);
        let refused = store
            .put_all(vec![late.clone(), numbered(number + 100, 10)])
            .await;
        assert!(matches!(refused, Err(StoreError::Full { .. })), "{refused:?}");
        assert_eq!(store.get(&late.digest).await.unwrap(), None);
        assert!(!store.contains(&late.digest).await.unwrap());
        holds_all(&store, &stored).await;
    }
    // With space available again, the same store continues.
    std::fs::remove_file(folder.join("one")).unwrap();
    let more = fill(&store, 1000).await;
    assert!(more.len() > 3, "{}", more.len());
    stored.extend(more);
    holds_all(&store, &stored).await;
    // Deleting needs a little space for its log before it frees any.
    let refused = store.delete(&digests(&stored[..4])).await;
    assert!(matches!(refused, Err(StoreError::Full { .. })), "{refused:?}");
    holds_all(&store, &stored).await;
    std::fs::remove_file(folder.join("two")).unwrap();
    let live = stored.split_off(stored.len() - 5);
    store.delete(&digests(&stored)).await.unwrap();
    let freed = store.compact().await.unwrap();
    assert!(freed.packs >= 3 && freed.bytes_freed > 10_000_000, "{freed:?}");
    holds_all(&store, &live).await;
    let after = fill(&store, 2000).await;
    assert!(after.len() > 10, "{}", after.len());
    store.close().await;
    let store = Store::open_with(folder, PACK_BYTES).await.unwrap();
    holds_all(&store, &live).await;
    holds_all(&store, &after).await;
}

/// Stores until the disk is full; returns the stored blobs.
async fn fill(store: &Store, from: u64) -> Vec<Blob> {
    let mut stored = Vec::new();
    for number in from..from + 500 {
        let blob = numbered(number, 500_000);
        match store.put_all(vec![blob.clone()]).await {
            Ok(()) => stored.push(blob),
            Err(StoreError::Full { .. }) => return stored,
            Err(other) => panic!("{other}"),
        }
    }
    panic!("the disk is never full");
}
