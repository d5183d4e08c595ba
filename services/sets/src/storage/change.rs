//! Changing an object that others may change at the same time: compare and set.
//!
//! In a bucket, the new object replaces only the one that was read, by its ETag (`If-Match`), or is created only if absent. Folders
//! have no such condition, so a process that changes an object there holds the lock of a file next to it (`flock`, over NFS a lock
//! of the server). The system releases it when the process ends.

use std::fs::{File, TryLockError};
use std::path::Path;
use std::thread::sleep;
use std::time::{Duration, Instant};

use object_store::{Error, GetResult, ObjectStoreExt, PutMode, PutOptions, UpdateVersion};

use crate::error::SetError;
use crate::storage::location::Location;
use crate::storage::store::Store;

/// How long others may be changing the object.
const PATIENCE: Duration = Duration::from_secs(15);
/// Between two tries.
const PAUSE: Duration = Duration::from_millis(20);

impl Store {
    /// Replaces an object by the result of `change`, which gets its content. `None` means a missing object, and as a result no change.
    /// `change` is called again if another process has changed the object meanwhile.
    ///
    /// # Errors
    /// What `change` returns; otherwise [`SetError`] of the store.
    pub(crate) fn change(
        &self,
        name: &str,
        change: impl Fn(Option<&[u8]>) -> Result<Option<Vec<u8>>, SetError>,
    ) -> Result<(), SetError> {
        if let Location::Folder(root) = self.location() {
            let _lock = self.lock(&root.join(format!("{name}.lock")))?;
            return match change(self.get(name)?.as_deref())? {
                Some(bytes) => self.replace(name, &bytes),
                None => Ok(()),
            };
        }
        let begun = Instant::now();
        loop {
            let found = self.versioned(name)?;
            let (bytes, mode) = match &found {
                Some((bytes, version)) => (Some(bytes.as_slice()), PutMode::Update(version.clone())),
                None => (None, PutMode::Create),
            };
            let Some(bytes) = change(bytes)? else {
                return Ok(());
            };
            // A lost reply looks like a refusal; the next round then finds the new object.
            if self.put_if(name, bytes, mode)? {
                return Ok(());
            }
            self.pause(name, begun)?;
        }
    }

    /// An object with its version.
    fn versioned(&self, name: &str) -> Result<Option<(Vec<u8>, UpdateVersion)>, SetError> {
        let path = self.path(name);
        self.found(async {
            let found: GetResult = self.objects.get(&path).await?;
            let version = UpdateVersion {
                e_tag: found.meta.e_tag.clone(),
                version: found.meta.version.clone(),
            };
            Ok((found.bytes().await?.to_vec(), version))
        })
    }

    /// Writes an object on a condition; returns whether the condition held.
    fn put_if(&self, name: &str, bytes: Vec<u8>, mode: PutMode) -> Result<bool, SetError> {
        let (path, options) = (self.path(name), PutOptions::from(mode));
        let put = self.objects.put_opts(&path, bytes.into(), options);
        self.wait(async {
            match put.await {
                Ok(_) => Ok(true),
                Err(Error::AlreadyExists { .. } | Error::Precondition { .. }) => Ok(false),
                Err(error) => Err(error),
            }
        })
    }

    /// Waits for the lock of a file; it is held as long as the file is open.
    fn lock(&self, path: &Path) -> Result<File, SetError> {
        let failed = |error| SetError::Refused(format!("{} cannot be locked: {error}", path.display()));
        let file = File::options()
            .write(true)
            .create(true)
            .truncate(false)
            .open(path);
        let (file, begun) = (file.map_err(failed)?, Instant::now());
        loop {
            match file.try_lock() {
                Ok(()) => return Ok(file),
                Err(TryLockError::WouldBlock) => self.pause(&path.display().to_string(), begun)?,
                Err(TryLockError::Error(error)) => return Err(failed(error)),
            }
        }
    }

    fn pause(&self, name: &str, begun: Instant) -> Result<(), SetError> {
        if begun.elapsed() > PATIENCE {
            let location = self.location();
            return Err(SetError::Later(format!(
                "{location}: others keep changing {name}"
            )));
        }
        sleep(PAUSE);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::sync::atomic::{AtomicU64, Ordering};
    use std::thread;

    use object_store::memory::InMemory;

    use super::*;

    const WRITERS: u64 = 4;
    const ROUNDS: u64 = 25;

    /// Every writer adds 1 to the number in an object, again and again: none may be lost.
    fn count(stores: &[Store]) -> u64 {
        let tries = AtomicU64::new(0);
        let add = |found: Option<&[u8]>| {
            tries.fetch_add(1, Ordering::Relaxed);
            let number: u64 = found.map_or(0, |text| String::from_utf8_lossy(text).parse().unwrap());
            thread::yield_now();
            Ok(Some((number + 1).to_string().into_bytes()))
        };
        thread::scope(|scope| {
            for store in stores {
                scope.spawn(|| (0..ROUNDS).for_each(|_| store.change("n", add).unwrap()));
            }
        });
        assert!(tries.into_inner() >= WRITERS * ROUNDS);
        let text = stores[0].get("n").unwrap().unwrap();
        String::from_utf8(text).unwrap().parse().unwrap()
    }

    #[test]
    fn no_change_of_a_folder_is_lost() {
        let folder = tempfile::tempdir().unwrap();
        let location = Location::Folder(folder.path().to_owned());
        let stores: Vec<_> = (0..WRITERS).map(|_| Store::open(&location).unwrap()).collect();
        assert_eq!(count(&stores), WRITERS * ROUNDS);
    }

    #[test]
    fn no_change_of_a_store_that_compares_is_lost() {
        let objects = Arc::new(InMemory::new());
        let location = Location::parse("s3://reef/set").unwrap();
        let stores: Vec<_> = (0..WRITERS)
            .map(|_| Store::new(objects.clone(), "set", &location).unwrap())
            .collect();
        assert_eq!(count(&stores), WRITERS * ROUNDS);
    }
}
