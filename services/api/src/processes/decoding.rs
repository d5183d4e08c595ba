//! Processes that decode user files, each with limited memory and time, all within a memory budget.

use std::ffi::OsStr;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use axum::body::Bytes;
use imaging::codec::{MAX_PIXELS, announced_pixels};
use serde::de::DeserializeOwned;
use tempfile::TempDir;
use tokio::sync::Semaphore;

use crate::decode::{REPLY, REQUEST, RESULT, Refusal, Request};
use crate::http::failure::writing;
use crate::http::problem::Problem;
use crate::processes::child::{Allowance, Children, Ended};
use crate::processes::scratch::Scratch;

/// Minimum memory of a process.
const MIN_MIB: usize = 256;
/// Memory in addition to files and pixels.
const EXTRA_MIB: usize = 64;
/// The slowest method needs a second per million pixels.
const TIME: Duration = Duration::from_secs(120);

/// Starts the processes.
pub(crate) struct Decoding {
    scratch: Arc<Scratch>,
    children: Children,
    /// Budget of their total memory, MiB.
    memory: Semaphore,
    most_mib: usize,
}

/// Files to decode, and their memory per pixel.
pub(crate) struct Files<'a> {
    /// The form field of the file that determines the memory.
    pub(crate) field: &'static str,
    /// By the names that the request uses.
    pub(crate) named: Vec<(&'static str, &'a Bytes)>,
    pub(crate) bytes_per_pixel: usize,
}

impl Files<'_> {
    /// Memory of a process that decodes them.
    fn mib(&self) -> usize {
        let pixels = self.named.iter().map(|(_, file)| announced_pixels(file)).max();
        let pixels = pixels.unwrap_or(0).min(MAX_PIXELS);
        let files: usize = self.named.iter().map(|(_, file)| file.len()).sum();
        let bytes = pixels * self.bytes_per_pixel + 2 * files;
        ((bytes >> 20) + EXTRA_MIB).max(MIN_MIB)
    }
}

/// Output of a process.
pub(crate) struct Decoded<R> {
    pub(crate) reply: R,
    folder: TempDir,
}

impl<R> Decoded<R> {
    /// The output image.
    pub(crate) async fn result(&self) -> Result<Vec<u8>, Problem> {
        let read = tokio::fs::read(self.folder.path().join(RESULT)).await;
        read.map_err(|error| Problem::internal(&error))
    }
}

impl Decoding {
    pub(crate) fn new(program: &Path, scratch: Arc<Scratch>, places: usize, most_mib: usize) -> Self {
        Self {
            scratch,
            children: Children::new(program, Vec::new(), places),
            memory: Semaphore::new(most_mib),
            most_mib,
        }
    }

    /// Decodes files as requested.
    pub(crate) async fn run<R: DeserializeOwned>(
        &self,
        request: &Request,
        files: Files<'_>,
    ) -> Result<Decoded<R>, Problem> {
        let mib = files.mib().min(self.most_mib);
        let places = u32::try_from(mib).unwrap_or(u32::MAX);
        let memory = self.memory.acquire_many(places).await;
        let _memory = memory.map_err(|error| Problem::internal(&error))?;
        let folder = self.scratch.folder().map_err(|error| writing(&error))?;
        let request = serde_json::to_vec(request).map_err(|error| Problem::internal(&error))?;
        write(folder.path(), REQUEST, &request).await?;
        for (name, bytes) in &files.named {
            write(folder.path(), name, bytes).await?;
        }
        let allowance = Allowance {
            time: TIME,
            memory_bytes: (mib as u64) << 20,
        };
        let arguments = [
            OsStr::new("decode"),
            OsStr::new("--folder"),
            folder.path().as_os_str(),
        ];
        let pointer = format!("/{}", files.field);
        match self.children.run("child", &arguments, allowance).await? {
            Ended::Well => {}
            Ended::Refused(why) | Ended::Lacking(why) => return Err(Problem::field(&pointer, why)),
            Ended::Badly(why) => {
                let message = format!("it cannot be decoded: {why}");
                return Err(Problem::field(&pointer, message));
            }
        }
        let reply = tokio::fs::read(folder.path().join(REPLY)).await;
        let reply = reply.map_err(|error| Problem::internal(&error))?;
        let reply: Result<R, Refusal> =
            serde_json::from_slice(&reply).map_err(|error| Problem::internal(&error))?;
        let reply = reply.map_err(|Refusal { pointer, message }| Problem::field(&pointer, message))?;
        Ok(Decoded { reply, folder })
    }
}

async fn write(folder: &Path, name: &str, bytes: &[u8]) -> Result<(), Problem> {
    let written = tokio::fs::write(folder.join(name), bytes).await;
    written.map_err(|error| writing(&error))
}
