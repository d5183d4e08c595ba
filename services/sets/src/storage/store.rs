//! The store that holds a set: a folder or a bucket, with calls that block.

use std::ops::Range;
use std::sync::Arc;
use std::time::{Duration, UNIX_EPOCH};

use bytes::Bytes;
use futures::TryStreamExt;
use object_store::aws::{AmazonS3Builder, Checksum};
use object_store::local::LocalFileSystem;
use object_store::path::Path;
use object_store::{
    BackoffConfig, Error, ObjectMeta, ObjectStore, ObjectStoreExt, PutMode, PutOptions, RetryConfig,
};
use tokio::runtime::{Builder, Runtime};

use crate::error::SetError;
use crate::storage::failure;
use crate::storage::layout;
use crate::storage::location::Location;
use crate::storage::transport::Connector;

/// How long a request is repeated before the store counts as unreachable.
const RETRY_LIMIT: Duration = Duration::from_secs(30);
const MOST_RETRIES: usize = 8;
/// Pauses between attempts: together about ten seconds, enough for a server to restart; those of the S3 client, one second.
const PAUSES: BackoffConfig = BackoffConfig {
    init_backoff: Duration::from_millis(200),
    max_backoff: Duration::from_secs(3),
    base: 3.0,
};
/// Longest object that is read as a whole: the rows of a shard, a hundred thousand records at most.
const MOST_OBJECT_BYTES: u64 = 512 << 20;
/// Attempts to create an object while its existence is unknown.
const CREATE_TRIES: usize = 3;

/// A store; clones share the connection.
#[derive(Clone)]
pub struct Store {
    pub(crate) objects: Arc<dyn ObjectStore>,
    root: Path,
    runtime: Arc<Runtime>,
    location: Location,
}

/// An object in a listing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Entry {
    /// Name below the set.
    pub name: String,
    /// Length in bytes.
    pub bytes: u64,
    /// When it was written, by the store's clock, in milliseconds of the Unix epoch.
    pub modified_ms: i64,
}

impl Store {
    /// Opens a location. For a bucket, endpoint, region and credentials come from the usual environment variables of S3 clients. No
    /// request is sent.
    ///
    /// # Errors
    /// [`SetError`]: the folder cannot be created, or the environment contradicts itself.
    pub fn open(location: &Location) -> Result<Self, SetError> {
        let refused = |error: Error| SetError::Refused(format!("{location}: {error}"));
        match location {
            Location::Folder(path) => {
                std::fs::create_dir_all(path)
                    .map_err(|error| SetError::Refused(format!("{location}: {error}")))?;
                let objects = LocalFileSystem::new_with_prefix(path).map_err(refused)?;
                Self::new(Arc::new(objects.with_fsync(true)), "", location)
            }
            Location::S3 { bucket, prefix } => {
                let retries = RetryConfig {
                    backoff: PAUSES,
                    max_retries: MOST_RETRIES,
                    retry_timeout: RETRY_LIMIT,
                };
                let objects = AmazonS3Builder::from_env()
                    .with_bucket_name(bucket)
                    .with_checksum_algorithm(Checksum::SHA256)
                    .with_allow_http(true)
                    .with_retry(retries)
                    .with_http_connector(Connector);
                Self::new(Arc::new(objects.build().map_err(refused)?), prefix, location)
            }
        }
    }

    pub(crate) fn new(
        objects: Arc<dyn ObjectStore>,
        prefix: &str,
        location: &Location,
    ) -> Result<Self, SetError> {
        // A second thread continues uploads while frames are rendered.
        let runtime = Builder::new_multi_thread().worker_threads(1).enable_all().build();
        let runtime =
            runtime.map_err(|error| SetError::Machine(format!("cannot start a thread: {error}")))?;
        Ok(Self {
            objects,
            root: Path::from(prefix),
            runtime: Arc::new(runtime),
            location: location.clone(),
        })
    }

    /// The location of the set.
    #[must_use]
    pub fn location(&self) -> &Location {
        &self.location
    }

    pub(crate) fn path(&self, name: &str) -> Path {
        Path::from_iter(self.root.parts().chain(Path::from(name).parts()))
    }

    /// Waits for a call; its error names the remedy.
    pub(crate) fn wait<T>(&self, call: impl Future<Output = object_store::Result<T>>) -> Result<T, SetError> {
        self.runtime.block_on(call).map_err(|error| self.explain(&error))
    }

    /// The bytes of an object; `None` if there is none.
    pub(crate) fn get(&self, name: &str) -> Result<Option<Vec<u8>>, SetError> {
        self.check_regular(name)?;
        let path = self.path(name);
        let found = self.found(async {
            let found = self.objects.get(&path).await?;
            match found.meta.size {
                ..=MOST_OBJECT_BYTES => Ok(Ok(found.bytes().await?.to_vec())),
                size => Ok(Err(size)),
            }
        })?;
        found.transpose().map_err(|size| {
            SetError::Damaged(format!(
                "{name} has {size} bytes; must be at most {MOST_OBJECT_BYTES}"
            ))
        })
    }

    /// Rejects anything but a regular file: opening a pipe would wait for its writer. The object store reports absent files.
    fn check_regular(&self, name: &str) -> Result<(), SetError> {
        match &self.location {
            Location::Folder(root)
                if std::fs::metadata(root.join(name)).is_ok_and(|found| !found.is_file()) =>
            {
                Err(SetError::Damaged(format!("{name} is not a regular file")))
            }
            _ => Ok(()),
        }
    }

    /// A part of an object that is there.
    ///
    /// # Errors
    /// [`SetError::Damaged`] if it is not there; otherwise [`SetError`] of the store.
    pub fn range(&self, name: &str, range: Range<u64>) -> Result<Bytes, SetError> {
        self.check_regular(name)?;
        let path = self.path(name);
        self.wait(self.objects.get_range(&path, range))
    }

    /// An object without its bytes; `None` if there is none.
    ///
    /// # Errors
    /// [`SetError`] of the store.
    pub fn entry(&self, name: &str) -> Result<Option<Entry>, SetError> {
        self.check_regular(name)?;
        let path = self.path(name);
        let found = self.found(self.objects.head(&path))?;
        Ok(found.map(|meta| self.listed(&meta)))
    }

    /// Creates an object only if absent; otherwise returns the existing one.
    ///
    /// A call whose reply was lost may have succeeded, so the object is read before a refusal or a failure is reported.
    pub(crate) fn create(&self, name: &str, bytes: &[u8]) -> Result<Option<Vec<u8>>, SetError> {
        let path = self.path(name);
        let mut tries = 0;
        loop {
            tries += 1;
            let options = PutOptions::from(PutMode::Create);
            let call = self.objects.put_opts(&path, bytes.to_vec().into(), options);
            let failure = match self.runtime.block_on(call) {
                Ok(_) => return Ok(None),
                Err(error) => error,
            };
            let is_refusal = matches!(failure, Error::AlreadyExists { .. } | Error::Precondition { .. });
            let reason = self.explain(&failure);
            if !is_refusal && matches!(reason, SetError::Refused(_)) {
                return Err(reason);
            }
            match self.get(name) {
                Ok(Some(found)) => return Ok(Some(found).filter(|found| found != bytes)),
                Ok(None) if tries < CREATE_TRIES => {}
                Ok(None) | Err(_) => return Err(reason),
            }
        }
    }

    /// Creates or replaces an object.
    pub(crate) fn replace(&self, name: &str, bytes: &[u8]) -> Result<(), SetError> {
        let path = self.path(name);
        self.wait(self.objects.put(&path, bytes.to_vec().into()))
            .map(drop)
    }

    /// Removes an object; it may be gone already.
    pub(crate) fn delete(&self, name: &str) -> Result<(), SetError> {
        let path = self.path(name);
        self.found(self.objects.delete(&path)).map(drop)
    }

    /// Everything below a folder of the set.
    pub(crate) fn list(&self, folder: &str) -> Result<Vec<Entry>, SetError> {
        let path = self.path(folder);
        let listing = self.objects.list(Some(&path));
        let entries = listing.map_ok(|meta| self.listed(&meta));
        self.wait(entries.try_collect())
    }

    /// Names of the folders directly below.
    pub(crate) fn folders(&self) -> Result<Vec<String>, SetError> {
        let listing = self.wait(self.objects.list_with_delimiter(Some(&self.root)))?;
        let names = listing.common_prefixes.iter().filter_map(|path| path.filename());
        Ok(names.map(str::to_owned).collect())
    }

    /// Removes the remains of interrupted uploads in a folder; returns the number of files. Listings of a folder omit them. A bucket
    /// hides parts of uploads, and removes them by a lifecycle rule.
    pub(crate) fn sweep_unfinished(&self, newest_ms: i64) -> Result<u64, SetError> {
        let Location::Folder(root) = &self.location else {
            return Ok(0);
        };
        let failed = |error: std::io::Error| SetError::Later(format!("{}: {error}", self.location));
        let mut removed = 0;
        for folder in [layout::SHARDS, layout::ROWS, layout::DONE, layout::PROBE] {
            let Ok(entries) = std::fs::read_dir(root.join(folder)) else {
                continue;
            };
            for entry in entries {
                let entry = entry.map_err(failed)?;
                let is_unfinished = entry.file_name().to_string_lossy().contains('#');
                let modified = entry
                    .metadata()
                    .and_then(|meta| meta.modified())
                    .map_err(failed)?;
                let modified = modified.duration_since(UNIX_EPOCH).unwrap_or_default();
                if is_unfinished && modified.as_millis() as i64 <= newest_ms {
                    std::fs::remove_file(entry.path()).map_err(failed)?;
                    removed += 1;
                }
            }
        }
        Ok(removed)
    }

    pub(crate) fn found<T>(
        &self,
        call: impl Future<Output = object_store::Result<T>>,
    ) -> Result<Option<T>, SetError> {
        match self.runtime.block_on(call) {
            Ok(value) => Ok(Some(value)),
            Err(error @ Error::NotFound { .. }) if !failure::is_missing_bucket(&error) => Ok(None),
            Err(error) => Err(self.explain(&error)),
        }
    }

    fn listed(&self, meta: &ObjectMeta) -> Entry {
        let name = meta.location.prefix_match(&self.root);
        let parts: Vec<_> = name
            .into_iter()
            .flatten()
            .map(|part| part.as_ref().to_owned())
            .collect();
        Entry {
            name: parts.join("/"),
            bytes: meta.size,
            modified_ms: meta.last_modified.timestamp_millis(),
        }
    }

    pub(crate) fn explain(&self, error: &Error) -> SetError {
        failure::explain(&self.location, error)
    }
}
