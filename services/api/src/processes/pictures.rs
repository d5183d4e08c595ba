//! The process that renders pictures of requests.

use std::path::{Path, PathBuf};
use std::time::Duration;

use super::child::Allowance;
use super::lasting::{Bounds, Lasting, Reply};
use crate::http::budget::{Budget, Share};
use crate::http::problem::{Problem, Slug};
use crate::limits;
use crate::renders::protocol::PictureReply;

/// Concurrent and waiting pictures: two of one caller, and two of others.
const PLACES: usize = 4;
/// Memory of networks and tables.
const BASE_BYTES: u64 = 2 << 30;
/// Memory for each pixel: layers of light in single precision, and a result in which every artifact is listed.
const PIXEL_BYTES: u64 = 600;
/// Maximum length of the line with the record.
const MAX_HEAD_BYTES: u64 = 4 << 20;

/// The process and its places.
pub(crate) struct PictureProcess {
    process: Lasting,
    places: Budget,
}

/// A picture in the form that the process reads.
pub(crate) struct PictureMessage {
    pub(crate) bytes: Vec<u8>,
    pub(crate) pixels: usize,
    /// Time limit of the process.
    pub(crate) time: Duration,
}

impl PictureProcess {
    /// A process of this program on this data folder, with options for styles.
    pub(crate) fn new(
        program: &Path,
        data: &Path,
        options: Vec<(&'static str, PathBuf)>,
        share: Share,
    ) -> Self {
        Self {
            process: Lasting::new(program, "pictures", data, options),
            places: Budget::new("picture renders", PLACES, share, limits::SHED_UPLOAD_AFTER),
        }
    }

    /// Renders a picture of a caller; returns the reply and its files.
    pub(crate) async fn render(
        &self,
        message: PictureMessage,
        caller: &str,
    ) -> Result<(PictureReply, Vec<u8>), Problem> {
        let _place = self.places.acquire(caller).await?;
        let bounds = Bounds {
            allowance: Allowance {
                time: message.time,
                memory_bytes: BASE_BYTES + PIXEL_BYTES * message.pixels as u64,
            },
            head_bytes: MAX_HEAD_BYTES,
            body_bytes: limits::ARTIFACT_BYTES as u64,
        };
        let exchanged = self.process.exchange(message.bytes, bounds).await;
        let Reply { head, body } = exchanged.map_err(|why| {
            let detail = format!("the process that renders the picture failed: {why}");
            Problem::new(Slug::RenderFailed, detail)
        })?;
        let reply = serde_json::from_slice(&head).map_err(|error| Problem::internal(&error))?;
        Ok((reply, body))
    }
}
