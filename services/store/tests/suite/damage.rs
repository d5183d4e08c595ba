//! Damaged bytes: all are detected, none served, all replaced by storing them again.

use store::{Blob, Scrubbed, Store, StoreError};

use crate::fixture::{holds_all, numbered, packs, put_one_by_one};

const PACK_BYTES: u64 = 3_000_000;
const BLOBS: u64 = 60;

/// A closed store of several packs, and its blobs.
async fn filled() -> (tempfile::TempDir, Vec<Blob>) {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open_with(folder.path(), PACK_BYTES).await.unwrap();
    let blobs: Vec<Blob> = (0..BLOBS)
        .map(|number| numbered(number, 20_000 + 4_000 * number as usize))
        .collect();
    put_one_by_one(&store, &blobs).await;
    store.close().await;
    assert!(packs(folder.path()).len() >= 3);
    (folder, blobs)
}

/// Opens the damaged store, reads everything twice, and stores everything again. Returns the number of damaged blobs.
async fn found_and_mended(folder: &tempfile::TempDir, blobs: &[Blob]) -> usize {
    let store = Store::open_with(folder.path(), PACK_BYTES).await.unwrap();
    let mut bad = 0;
    for blob in blobs {
        let scrubbed = store.scrub(&blob.digest).await.unwrap();
        bad += usize::from(scrubbed != Scrubbed::Good);
        match (scrubbed, store.get(&blob.digest).await) {
            (Scrubbed::Good, Ok(Some(bytes))) => assert!(bytes == blob.bytes),
            (Scrubbed::Missing, Ok(None)) | (Scrubbed::Corrupt, Err(StoreError::Corrupt { .. })) => {}
            (scrubbed, got) => panic!("{scrubbed:?} but {:?}", got.map(|bytes| bytes.map(|b| b.len()))),
        }
    }
    store.put_all(blobs.to_vec()).await.unwrap();
    holds_all(&store, blobs).await;
    drop(store);
    let store = Store::open_with(folder.path(), PACK_BYTES).await.unwrap();
    holds_all(&store, blobs).await;
    bad
}

/// The file of a blob, and every offset of 64 bytes from its middle. SQLite keeps old copies when it moves a row to
/// another page.
fn places(folder: &tempfile::TempDir, blob: &Blob) -> (std::path::PathBuf, Vec<usize>) {
    let middle = blob.bytes.len() / 2;
    let needle = &blob.bytes[middle..middle + 64];
    packs(folder.path())
        .into_iter()
        .find_map(|pack| {
            let bytes = std::fs::read(&pack).unwrap();
            let found = |at: &usize| bytes[*at] == needle[0] && bytes[*at..].starts_with(needle);
            let places: Vec<usize> = (0..bytes.len()).filter(found).collect();
            (!places.is_empty()).then_some((pack, places))
        })
        .unwrap()
}

#[tokio::test]
async fn a_flipped_bit_in_any_blob_is_found() {
    let (folder, blobs) = filled().await;
    for blob in blobs.iter().step_by(2) {
        let (pack, places) = places(&folder, blob);
        let mut bytes = std::fs::read(&pack).unwrap();
        for at in places {
            bytes[at + 7] ^= 0x10;
        }
        std::fs::write(&pack, bytes).unwrap();
    }
    assert_eq!(found_and_mended(&folder, &blobs).await, blobs.len() / 2);
}

#[tokio::test]
async fn swapped_bytes_of_two_blobs_are_found() {
    let (folder, blobs) = filled().await;
    let ((pack, ones), (other_pack, others)) = (places(&folder, &blobs[0]), places(&folder, &blobs[1]));
    assert_eq!(pack, other_pack);
    let whole = std::fs::read(&pack).unwrap();
    let mut bytes = whole.clone();
    for (to, from) in [(&ones, others[0]), (&others, ones[0])] {
        for &at in to {
            bytes[at..at + 64].copy_from_slice(&whole[from..from + 64]);
        }
    }
    std::fs::write(&pack, bytes).unwrap();
    assert_eq!(found_and_mended(&folder, &blobs).await, 2);
}

#[tokio::test]
async fn a_flipped_bit_anywhere_in_a_file_is_never_served_and_never_keeps_the_store_closed() {
    // Offsets spread over the whole first pack, and every one of its first bytes except the format fields.
    let (folder, blobs) = filled().await;
    let pack = packs(folder.path())[0].clone();
    let whole = std::fs::read(&pack).unwrap();
    let early = (0..60).chain(72..120);
    let spread = (0..60).map(|step| 120 + step * (whole.len() - 121) / 59);
    for at in early.chain(spread) {
        let mut bytes = whole.clone();
        bytes[at] ^= 1 << (at % 8);
        let copy = tempfile::tempdir().unwrap();
        std::fs::create_dir(copy.path().join("packs")).unwrap();
        for path in packs(folder.path()) {
            let target = copy.path().join("packs").join(path.file_name().unwrap());
            if path == pack {
                std::fs::write(target, &bytes).unwrap();
            } else {
                std::fs::hard_link(&path, target).unwrap();
            }
        }
        found_and_mended(&copy, &blobs[..30]).await;
    }
}

#[tokio::test]
async fn truncated_emptied_overwritten_and_missing_packs_are_found() {
    type Damage = fn(&std::path::Path);
    let damages: [Damage; 5] = [
        |pack| {
            let file = std::fs::File::options().write(true).open(pack).unwrap();
            file.set_len(file.metadata().unwrap().len() / 2 + 100).unwrap();
        },
        |pack| std::fs::write(pack, b"").unwrap(),
        |pack| std::fs::write(pack, b"not a database at all").unwrap(),
        |pack| std::fs::write(pack, vec![0; 1_000_000]).unwrap(),
        |pack| std::fs::remove_file(pack).unwrap(),
    ];
    for damage in damages {
        let (folder, blobs) = filled().await;
        damage(&packs(folder.path())[1]);
        let bad = found_and_mended(&folder, &blobs).await;
        assert!(bad > 5 && bad < blobs.len(), "{bad} blobs of one pack of several");
    }
}

#[tokio::test]
async fn a_pack_that_goes_missing_under_a_running_store_does_not_stop_it() {
    let (folder, blobs) = filled().await;
    let store = Store::open_with(folder.path(), PACK_BYTES).await.unwrap();
    std::fs::remove_file(&packs(folder.path())[0]).unwrap();
    let first = store.get(&blobs[0].digest).await;
    assert!(matches!(first, Err(StoreError::Corrupt { .. })), "{first:?}");
    holds_all(&store, &blobs[50..]).await;
    store.put_all(blobs.clone()).await.unwrap();
    holds_all(&store, &blobs).await;
}
