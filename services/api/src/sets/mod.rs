//! Sets made outside this service: their images are imported as they are rendered, their bytes stay in place.

pub(crate) mod conformity;
pub(crate) mod feed;
mod follow;
mod followed;
pub(crate) mod intake;
mod look;
mod look_error;
mod reader;
pub(crate) mod routes;
mod shared;
mod view;

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::http::problem::{Problem, Slug};
use crate::jobs::Jobs;
use followed::Followed;
use reader::Reader;

/// The sets that a service follows.
pub(crate) struct Sets {
    jobs: Arc<Jobs>,
    /// Absent if imports are disabled.
    reader: Option<Reader>,
    /// By job id.
    followed: Mutex<BTreeMap<String, Arc<Followed>>>,
}

impl Sets {
    /// `stores`: permitted locations of sets.
    pub(crate) fn new(jobs: Arc<Jobs>, program: &Path, stores: &[String]) -> Self {
        Self {
            jobs,
            reader: (!stores.is_empty()).then(|| Reader::new(program, stores)),
            followed: Mutex::default(),
        }
    }

    fn reader(&self) -> Result<&Reader, Problem> {
        self.reader.as_ref().ok_or_else(|| {
            let remedy =
                "start it with `--store FOLDER` or `--store s3://BUCKET/PREFIX` to permit imports from there";
            Problem::new(Slug::ImportsDisabled, remedy)
        })
    }

    fn followed(&self) -> MutexGuard<'_, BTreeMap<String, Arc<Followed>>> {
        self.followed.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
