use store::{Blob, Store, StoreError};

use crate::fixture::blob;

#[tokio::test]
async fn bytes_survive_a_restart_and_repeats_are_not_stored_twice() {
    let folder = tempfile::tempdir().unwrap();
    let first = blob(b"one");
    {
        let store = Store::open(folder.path()).await.unwrap();
        store
            .put_all(vec![first.clone(), first.clone(), blob(b"two")])
            .await
            .unwrap();
        store.put_all(vec![first.clone()]).await.unwrap();
        let stats = store.stats();
        assert_eq!((stats.packs, stats.blobs, stats.bytes), (1, 2, 6));
        // No close, as if the process had been killed.
    }
    let store = Store::open(folder.path()).await.unwrap();
    assert_eq!(
        store.get(&first.digest).await.unwrap().as_deref(),
        Some(&b"one"[..])
    );
    assert!(store.contains(&first.digest).await.unwrap());
    assert_eq!(store.get(&blob(b"three").digest).await.unwrap(), None);
    assert_eq!(store.stats().blobs, 2);
}

#[tokio::test]
async fn a_wrong_digest_rejects_the_whole_call() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).await.unwrap();
    let wrong = Blob {
        bytes: b"other".to_vec(),
        ..blob(b"one")
    };
    let result = store.put_all(vec![blob(b"good"), wrong]).await;
    assert!(matches!(result, Err(StoreError::DigestMismatch { .. })));
    assert_eq!(store.stats().blobs, 0);
    assert!(matches!(
        store.get("../../etc/passwd").await,
        Err(StoreError::NotADigest { .. })
    ));
}

#[tokio::test]
async fn a_full_pack_is_followed_by_the_next() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open_with(folder.path(), 1000).await.unwrap();
    let blobs: Vec<Blob> = (0..10u8).map(|i| blob(&[i; 400])).collect();
    for blob in &blobs {
        store.put_all(vec![blob.clone()]).await.unwrap();
    }
    assert!(store.stats().packs >= 3, "{:?}", store.stats());
    store.close().await;
    let store = Store::open_with(folder.path(), 1000).await.unwrap();
    for blob in &blobs {
        assert_eq!(store.get(&blob.digest).await.unwrap().as_ref(), Some(&blob.bytes));
    }
}

#[tokio::test]
async fn concurrent_callers_all_find_their_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let store = std::sync::Arc::new(Store::open(folder.path()).await.unwrap());
    let tasks: Vec<_> = (0..64u32)
        .map(|i| {
            let store = std::sync::Arc::clone(&store);
            tokio::spawn(async move {
                let mine = blob(&(i % 40).to_le_bytes().repeat(5000));
                store.put_all(vec![mine.clone()]).await.unwrap();
                assert_eq!(store.get(&mine.digest).await.unwrap(), Some(mine.bytes));
            })
        })
        .collect();
    for task in tasks {
        task.await.unwrap();
    }
    assert_eq!(store.stats().blobs, 40);
}

#[tokio::test]
async fn damaged_bytes_are_never_served_and_can_be_put_again() {
    let folder = tempfile::tempdir().unwrap();
    let good = blob(&[7u8; 200_000]);
    let store = Store::open(folder.path()).await.unwrap();
    store.put_all(vec![good.clone()]).await.unwrap();
    store.close().await;
    let pack = folder.path().join("packs/pack-000001.sqlite");
    let mut bytes = std::fs::read(&pack).unwrap();
    let position = bytes.windows(64).rposition(|window| window == [7u8; 64]).unwrap();
    bytes[position] ^= 1;
    std::fs::write(&pack, bytes).unwrap();
    let store = Store::open(folder.path()).await.unwrap();
    assert!(matches!(
        store.get(&good.digest).await,
        Err(StoreError::Corrupt { .. })
    ));
    assert!(!store.contains(&good.digest).await.unwrap());
    store.put_all(vec![good.clone()]).await.unwrap();
    assert_eq!(store.get(&good.digest).await.unwrap(), Some(good.bytes));
}

#[tokio::test]
async fn a_foreign_database_among_the_packs_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).await.unwrap();
    store.put_all(vec![blob(b"one")]).await.unwrap();
    store.close().await;
    let pack = folder.path().join("packs/pack-000001.sqlite");
    let mut bytes = std::fs::read(&pack).unwrap();
    bytes[68..72].fill(0);
    std::fs::write(&pack, bytes).unwrap();
    let error = Store::open(folder.path()).await.err().unwrap();
    assert!(error.to_string().contains("pack-000001.sqlite"), "{error}");
}
