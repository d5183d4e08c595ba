//! A description on its way to a job: read, but its scenes not looked at yet.

use std::collections::BTreeSet;

use crate::check::{Checker, collection};
use crate::invalid::{FieldError, Invalid};
use crate::json::{self, MAX_BYTES};
use crate::scene_parts::Uploads;
use crate::vocabulary::Vocabulary;
use crate::warnings;

use super::{Job, seed};

/// A description that has been read; what is wrong with it so far is kept for [`Draft::check`]. It tells which uploaded
/// scenes to look up, so that what they lack is reported along with everything else.
pub struct Draft<'v> {
    job: Job,
    checker: Checker<'v>,
}

impl<'v> Draft<'v> {
    /// Reads a description.
    ///
    /// # Errors
    /// A text that is not JSON, or no object.
    pub fn read(json: &[u8], vocabulary: &'v Vocabulary) -> Result<Self, Invalid> {
        let written = json::read(json)?;
        let mut checker = Checker {
            vocabulary,
            trusting: false,
            seed: seed(&written),
            errors: Vec::new(),
        };
        let job = Job::read(&written, &mut checker)?;
        checker.across(&job.document);
        checker.water(&job.document, job.frames());
        checker.cameras(&job.document, job.frames());
        if job.canonical.len() > MAX_BYTES {
            let message = format!(
                "the description with its defaults has {} bytes, the limit is {MAX_BYTES}",
                job.canonical.len()
            );
            checker.refuse(|| FieldError::new("", message).limit(format!("{MAX_BYTES} bytes")));
        }
        Ok(Self { job, checker })
    }

    /// Names of all collections that a description may mean: the vocabulary that it is read with has to know their scenes.
    #[must_use]
    pub fn collections_named(json: &[u8]) -> BTreeSet<String> {
        json::read(json)
            .map(|value| collection::named(&value))
            .unwrap_or_default()
    }

    /// Ids of all uploaded scenes that a frame can ask for, sorted.
    #[must_use]
    pub fn uploaded_scene_ids(&self) -> Vec<String> {
        self.job.uploaded_scene_ids()
    }

    /// The job, if nothing is wrong with it over its scenes.
    ///
    /// # Errors
    /// Every error of the description together, at most [`crate::MAX_ERRORS`].
    pub fn check(self, uploads: &Uploads) -> Result<Job, Invalid> {
        let Self { mut job, mut checker } = self;
        let of_scenes = checker.scenes(&job.document, uploads);
        if !checker.errors.is_empty() {
            return Err(Invalid(checker.errors));
        }
        job.warnings = warnings::find(&job.document, checker.vocabulary);
        job.warnings.extend(of_scenes);
        Ok(job)
    }
}
