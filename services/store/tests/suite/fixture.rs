use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};
use store::{Blob, Store};

pub(crate) fn blob(bytes: &[u8]) -> Blob {
    let digest = Sha256::digest(bytes)
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect();
    Blob {
        digest,
        bytes: bytes.to_vec(),
    }
}

pub(crate) fn numbered(number: u64, length: usize) -> Blob {
    let mut bytes = Vec::with_capacity(length + 32);
    let mut part = 0u64;
    while bytes.len() < length {
        bytes.extend(Sha256::digest(
            [number.to_le_bytes(), part.to_le_bytes()].concat(),
        ));
        part += 1;
    }
    bytes.truncate(length);
    blob(&bytes)
}

pub(crate) async fn put_one_by_one(store: &Store, blobs: &[Blob]) {
    for blob in blobs {
        store.put_all(vec![blob.clone()]).await.unwrap();
    }
}

pub(crate) async fn holds_all(store: &Store, blobs: &[Blob]) {
    for blob in blobs {
        let got = store.get(&blob.digest).await.unwrap();
        assert!(got.as_ref() == Some(&blob.bytes), "{} is not there", blob.digest);
    }
}

pub(crate) fn digests(blobs: &[Blob]) -> Vec<String> {
    blobs.iter().map(|blob| blob.digest.clone()).collect()
}

pub(crate) fn packs(folder: &Path) -> Vec<PathBuf> {
    let files = std::fs::read_dir(folder.join("packs")).unwrap();
    let mut packs: Vec<PathBuf> = files
        .map(|file| file.unwrap().path())
        .filter(|path| path.extension().is_some_and(|end| end == "sqlite"))
        .collect();
    packs.sort();
    packs
}

pub(crate) fn size(folder: &Path) -> u64 {
    let files = std::fs::read_dir(folder.join("packs")).unwrap();
    files.map(|file| file.unwrap().metadata().unwrap().len()).sum()
}
