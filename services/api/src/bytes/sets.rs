//! Bytes of imported images: ranges of the tars of their sets, read in place.

use std::fs::File;
use std::io::{self, ErrorKind};
use std::ops::Range;
use std::os::unix::fs::FileExt;
use std::path::Path;
use std::sync::Arc;

use catalogue::Place;
use spec::{ArtifactEntry, sha256};

use crate::http::problem::{Problem, Slug};

/// Reads a range of a file of a set in a bucket. It may block.
pub type ReadBucket = Arc<dyn Fn(&Place, Range<u64>) -> Result<Vec<u8>, Unread> + Send + Sync>;

/// Why the bytes of an imported artifact are unavailable.
#[derive(Debug, Clone, thiserror::Error)]
pub enum Unread {
    /// The tar is missing or too short.
    #[error("{0}")]
    Gone(String),
    /// The bytes have another digest.
    #[error("{0}")]
    Differs(String),
    /// The store does not respond or refuses access; a retry may succeed.
    #[error("{0}")]
    Unreachable(String),
}

impl From<Unread> for Problem {
    fn from(error: Unread) -> Self {
        tracing::error!(%error, "an imported artifact cannot be read");
        let slug = match error {
            Unread::Gone(_) | Unread::Differs(_) => Slug::SetChanged,
            Unread::Unreachable(_) => Slug::SetUnreachable,
        };
        Self::new(slug, error.to_string())
    }
}

/// Reads the bytes of imported artifacts.
#[derive(Clone)]
pub struct SetFiles {
    buckets: ReadBucket,
}

impl SetFiles {
    /// Reads sets in folders itself, those in buckets with the reader.
    #[must_use]
    pub fn new(buckets: ReadBucket) -> Self {
        Self { buckets }
    }

    /// Reads and verifies the bytes of an artifact.
    ///
    /// # Errors
    /// [`Unread`].
    pub async fn read(&self, place: &Place, entry: &ArtifactEntry) -> Result<Vec<u8>, Unread> {
        let (files, place, entry) = (self.clone(), place.clone(), entry.clone());
        let read = tokio::task::spawn_blocking(move || files.verified(&place, &entry));
        read.await
            .unwrap_or_else(|error| Err(Unread::Unreachable(error.to_string())))
    }

    fn verified(&self, place: &Place, entry: &ArtifactEntry) -> Result<Vec<u8>, Unread> {
        let range = place.offset..place.offset.saturating_add(entry.bytes);
        let bytes = if is_bucket(&place.set) {
            (self.buckets)(place, range)?
        } else {
            from_folder(place, range)?
        };
        if sha256(&bytes) != entry.digest {
            let reason = format!(
                "{} in {} does not hold artifact {} at {}",
                place.tar, place.set, entry.digest, place.offset
            );
            return Err(Unread::Differs(reason));
        }
        Ok(bytes)
    }
}

fn is_bucket(set: &str) -> bool {
    set.contains("://")
}

fn from_folder(place: &Place, range: Range<u64>) -> Result<Vec<u8>, Unread> {
    let read = read_range(Path::new(&place.set), &place.tar, range);
    let read = read.map_err(|error| {
        let reason = format!("{} in {}: {error}", place.tar, place.set);
        match error.kind() {
            ErrorKind::NotFound | ErrorKind::NotADirectory | ErrorKind::UnexpectedEof => Unread::Gone(reason),
            _ => Unread::Unreachable(reason),
        }
    })?;
    read.ok_or_else(|| Unread::Differs(format!("{} is outside {}", place.tar, place.set)))
}

/// `None` if the file is outside the folder.
fn read_range(folder: &Path, file: &str, range: Range<u64>) -> io::Result<Option<Vec<u8>>> {
    let folder = folder.canonicalize()?;
    let path = folder.join(file).canonicalize()?;
    if !path.starts_with(&folder) {
        return Ok(None);
    }
    // Opening a pipe would wait for its writer.
    if !std::fs::metadata(&path)?.is_file() {
        return Err(io::Error::other("not a regular file"));
    }
    let file = File::open(path)?;
    // Check the length before allocating memory.
    if file.metadata()?.len() < range.end {
        return Err(ErrorKind::UnexpectedEof.into());
    }
    let mut bytes = vec![0; (range.end - range.start) as usize];
    file.read_exact_at(&mut bytes, range.start)?;
    Ok(Some(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(bytes: &[u8]) -> ArtifactEntry {
        ArtifactEntry {
            kind: "rgb".to_owned(),
            digest: sha256(bytes),
            bytes: bytes.len() as u64,
            media_type: "image/png".to_owned(),
        }
    }

    fn place(set: &Path, tar: &str, offset: u64) -> Place {
        Place {
            set: set.to_str().unwrap().to_owned(),
            tar: tar.to_owned(),
            offset,
        }
    }

    fn without_buckets() -> SetFiles {
        SetFiles::new(Arc::new(|place, _| Err(Unread::Gone(place.set.clone()))))
    }

    #[tokio::test]
    async fn exactly_the_range_is_read_and_only_with_its_digest() {
        let set = tempfile::tempdir().unwrap();
        std::fs::write(set.path().join("a.tar"), b"0123456789").unwrap();
        let files = without_buckets();
        let read = files.read(&place(set.path(), "a.tar", 3), &entry(b"345")).await;
        assert_eq!(read.unwrap(), b"345");
        let other = files.read(&place(set.path(), "a.tar", 4), &entry(b"345")).await;
        assert!(matches!(other, Err(Unread::Differs(_))), "{other:?}");
        for gone in [
            place(set.path(), "b.tar", 3),
            place(set.path(), "a.tar", u64::MAX),
        ] {
            let gone = files.read(&gone, &entry(b"345")).await;
            assert!(matches!(gone, Err(Unread::Gone(_))), "{gone:?}");
        }
    }

    #[tokio::test]
    async fn files_outside_the_set_are_not_read() {
        let folder = tempfile::tempdir().unwrap();
        let set = folder.path().join("set");
        std::fs::create_dir(&set).unwrap();
        std::fs::write(folder.path().join("secret"), b"345").unwrap();
        std::os::unix::fs::symlink(folder.path().join("secret"), set.join("a.tar")).unwrap();
        for tar in ["a.tar", "../secret"] {
            let read = without_buckets().read(&place(&set, tar, 0), &entry(b"345")).await;
            assert!(matches!(read, Err(Unread::Differs(_))), "{tar}: {read:?}");
        }
    }

    #[tokio::test]
    async fn the_reader_of_buckets_reads_sets_in_buckets() {
        let place = Place {
            set: "s3://reef/tour".to_owned(),
            tar: "a.tar".to_owned(),
            offset: 3,
        };
        let reader: ReadBucket =
            Arc::new(|_, range| Ok(b"0123456789"[range.start as usize..range.end as usize].to_vec()));
        let read = SetFiles::new(reader).read(&place, &entry(b"345")).await;
        assert_eq!(read.unwrap(), b"345");
    }
}
