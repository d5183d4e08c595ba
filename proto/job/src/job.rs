//! A job: a frame description with distributions, valid by construction.

mod draft;
mod formula;
mod grids;
mod stored;

use crate::earlier::refuse_earlier_version;
use crate::invalid::Invalid;
use crate::json;
use crate::scene_parts::Uploads;
use crate::vocabulary::{KnownNetwork, Vocabulary};

pub use draft::Draft;
pub use formula::Job;

impl Job {
    /// Parses and checks a description, assuming that its uploaded scenes exist; use [`Draft`] to check them.
    ///
    /// # Errors
    /// All errors of the description, at most [`crate::MAX_ERRORS`]; a single one if the text is not JSON.
    pub fn parse(json: &[u8], vocabulary: &Vocabulary) -> Result<Self, Invalid> {
        Draft::read(json, vocabulary)?.check(&Uploads::Unknown)
    }

    /// Reads the canonical text of an accepted job. Names and limits are not checked again, so that the job renders the
    /// same frames after they have changed.
    ///
    /// # Errors
    /// A damaged text, or a job of version 0.1.
    pub fn from_canonical(text: &str) -> Result<Self, Invalid> {
        let stored = json::read(text.as_bytes())?;
        refuse_earlier_version(&stored)?;
        stored::read_job(&stored)
    }

    /// Adds the models of a job to a vocabulary, so that its description is valid where they are missing.
    pub fn admit_models(&self, vocabulary: &mut Vocabulary) {
        vocabulary.styles.extend(self.styles());
        for (networks, names) in [
            (&mut vocabulary.enhancers, self.enhancers()),
            (&mut vocabulary.metric_networks, self.metric_networks()),
        ] {
            networks.extend(names.into_iter().map(|name| KnownNetwork {
                name,
                digest: String::new(),
                size: None,
            }));
        }
    }
}
