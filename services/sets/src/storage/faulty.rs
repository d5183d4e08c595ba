//! Stores that misbehave, for tests.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use async_trait::async_trait;
use futures::stream::BoxStream;
use object_store::memory::InMemory;
use object_store::path::Path;
use object_store::{
    CopyOptions, Error, GetOptions, GetResult, ListResult, MultipartUpload, ObjectMeta, ObjectStore, PutMode,
    PutMultipartOptions, PutOptions, PutPayload, PutResult, Result,
};

use crate::storage::location::Location;
use crate::storage::store::Store;

/// The fault of a store.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Fault {
    None,
    /// Overwrites objects that should be created only if absent.
    IgnoresConditions,
    /// Carries out this many requests and loses their replies.
    LosesReplies(u32),
    /// Has no free space.
    IsFull,
    /// Refuses every write.
    RefusesAccess,
}

#[derive(Debug)]
struct Faulty {
    objects: InMemory,
    fault: Fault,
    lost: AtomicU32,
}

/// A store in memory with this fault.
pub(crate) fn store(fault: Fault) -> Store {
    let faulty = Faulty {
        objects: InMemory::new(),
        fault,
        lost: AtomicU32::new(0),
    };
    let location = Location::parse("s3://test/set").unwrap();
    Store::new(Arc::new(faulty), "set", &location).unwrap()
}

impl fmt::Display for Faulty {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.fault)
    }
}

fn generic(text: &str) -> Error {
    Error::Generic {
        store: "test",
        source: text.into(),
    }
}

#[async_trait]
impl ObjectStore for Faulty {
    async fn put_opts(&self, path: &Path, payload: PutPayload, mut options: PutOptions) -> Result<PutResult> {
        match self.fault {
            Fault::IsFull => {
                return Err(generic(
                    "Server returned non-2xx status code: 507 Insufficient Storage: ",
                ));
            }
            Fault::RefusesAccess => {
                return Err(Error::PermissionDenied {
                    path: path.to_string(),
                    source: "403 Forbidden".into(),
                });
            }
            Fault::IgnoresConditions => options.mode = PutMode::Overwrite,
            Fault::None | Fault::LosesReplies(_) => {}
        }
        let result = self.objects.put_opts(path, payload, options).await;
        match self.fault {
            Fault::LosesReplies(times) if self.lost.fetch_add(1, Ordering::SeqCst) < times => {
                Err(generic("the connection was closed"))
            }
            _ => result,
        }
    }

    async fn put_multipart_opts(
        &self,
        path: &Path,
        options: PutMultipartOptions,
    ) -> Result<Box<dyn MultipartUpload>> {
        self.objects.put_multipart_opts(path, options).await
    }

    async fn get_opts(&self, path: &Path, options: GetOptions) -> Result<GetResult> {
        self.objects.get_opts(path, options).await
    }

    fn delete_stream(&self, paths: BoxStream<'static, Result<Path>>) -> BoxStream<'static, Result<Path>> {
        self.objects.delete_stream(paths)
    }

    fn list(&self, prefix: Option<&Path>) -> BoxStream<'static, Result<ObjectMeta>> {
        self.objects.list(prefix)
    }

    async fn list_with_delimiter(&self, prefix: Option<&Path>) -> Result<ListResult> {
        self.objects.list_with_delimiter(prefix).await
    }

    async fn copy_opts(&self, from: &Path, to: &Path, options: CopyOptions) -> Result<()> {
        self.objects.copy_opts(from, to, options).await
    }
}
