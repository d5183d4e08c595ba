//! Uploaded scenes.

mod keep;
pub(crate) mod routes;
mod upload;
pub(crate) mod view;

use std::sync::Arc;

use catalogue::Catalogue;

use crate::bytes::Bytes;
use crate::clock::Clock;
use crate::processes::Processes;

/// State for storing scenes.
pub(crate) struct Scenes {
    pub(crate) catalogue: Arc<Catalogue>,
    pub(crate) bytes: Arc<Bytes>,
    pub(crate) processes: Arc<Processes>,
    pub(crate) clock: Clock,
}
