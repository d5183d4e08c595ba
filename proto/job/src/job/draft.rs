//! A parsed description whose scenes are not checked yet.

use std::collections::BTreeSet;

use serde_json::Value;

use crate::check::{Checker, Location, collection, find_values};
use crate::fields::DOCUMENT;
use crate::invalid::{FieldError, Invalid, MAX_ERRORS};
use crate::json::{self, MAX_BYTES};
use crate::node::Node;
use crate::scene_parts::Uploads;
use crate::site::Sites;
use crate::vocabulary::Vocabulary;
use crate::warnings;

use super::formula::{Document, Job, seed};

/// A parsed description with its errors so far. [`Draft::check`] adds the errors of the uploaded scenes and reports
/// all together.
pub struct Draft<'v> {
    job: Job,
    written: Value,
    /// Errors of the job as a whole.
    errors: Vec<FieldError>,
    /// One checker per document of the job, with its errors.
    parts: Vec<Part<'v>>,
}

/// A document of the job and its errors.
struct Part<'v> {
    checker: Checker<'v>,
    /// JSON pointer to the fields specific to this document; empty for the job itself.
    pointer: String,
}

impl Part<'_> {
    /// The errors of the document, with pointers into the submitted text.
    fn take_errors(&mut self, written: &Value) -> Vec<FieldError> {
        let mut errors = std::mem::take(&mut self.checker.errors);
        for error in &mut errors {
            if written.pointer(&error.pointer).is_none() {
                error.pointer.insert_str(0, &self.pointer);
            }
        }
        errors
    }
}

impl<'v> Draft<'v> {
    /// Parses a description.
    ///
    /// # Errors
    /// Not a JSON object, or an invalid site.
    pub fn read(json: &[u8], vocabulary: &'v Vocabulary) -> Result<Self, Invalid> {
        let mut draft = Self::start(json::read(json)?, vocabulary)?;
        let frames = draft.job.frames();
        for (document, part) in draft.job.formula.documents.iter().zip(&mut draft.parts) {
            part.checker.check_across(&document.node);
            part.checker.try_waters(&document.node, frames);
            part.checker.try_cameras(&document.node, frames);
        }
        draft.refuse_path_with_drawn_site();
        let length = draft.job.canonical.len();
        if length > MAX_BYTES {
            let message =
                format!("the description with its defaults has {length} bytes; must be at most {MAX_BYTES}");
            draft
                .errors
                .push(FieldError::new("", message).limit(format!("{MAX_BYTES} bytes")));
        } else if draft.job.formula.site.is_some()
            && let Err(Invalid(errors)) = json::read(draft.job.canonical.as_bytes())
        {
            // The descriptions of sites are nested deeper than the submitted text.
            draft.errors.extend(errors);
        }
        Ok(draft)
    }

    /// Checks each document of a description without its scenes; the errors are kept.
    fn start(written: Value, vocabulary: &'v Vocabulary) -> Result<Self, Invalid> {
        let seed = seed(&written);
        let mut checker = Checker::new(vocabulary, seed);
        let sites = Sites::expand(&written, &mut checker);
        let mut errors = checker.errors;
        if sites.descriptions.is_empty() {
            return Err(Invalid(errors));
        }
        let (mut documents, mut parts) = (Vec::new(), Vec::new());
        for description in sites.descriptions {
            let mut checker = Checker::new(vocabulary, seed);
            let Some(node) = checker.check(&Location::default(), &DOCUMENT, false, &description.value) else {
                return Err(Invalid(checker.errors));
            };
            checker.require_scene(&node);
            documents.push(Document {
                site: description.name,
                node,
            });
            let pointer = description.pointer;
            parts.push(Part { checker, pointer });
        }
        let job = Job::assemble(seed, sites.name, documents, &mut errors);
        Ok(Self {
            job,
            written,
            errors,
            parts,
        })
    }

    /// Names of all collections that a description may mention. The vocabulary must know their scenes.
    #[must_use]
    pub fn collections_named(json: &[u8]) -> BTreeSet<String> {
        json::read(json)
            .map(|value| collection::named(&value))
            .unwrap_or_default()
    }

    /// Ids of all uploaded scenes that a frame can use, sorted.
    #[must_use]
    pub fn uploaded_scene_ids(&self) -> Vec<String> {
        self.job.uploaded_scene_ids()
    }

    /// Completes the job with the known uploads.
    ///
    /// # Errors
    /// All errors of the description, at most [`crate::MAX_ERRORS`].
    pub fn check(mut self, uploads: &Uploads) -> Result<Job, Invalid> {
        let mut found = Vec::new();
        for (document, part) in self.job.formula.documents.iter().zip(&mut self.parts) {
            let scene_warnings = part.checker.check_scenes(&document.node, uploads);
            let mut warnings = warnings::find(&document.node, part.checker.vocabulary);
            warnings.extend(scene_warnings);
            found.push(warnings);
        }
        self.job.warnings = self.join(&found, |site, warning| format!("site `{site}`: {warning}"));
        self.finish()
    }

    /// Completes the job if it has no errors so far.
    fn finish(mut self) -> Result<Job, Invalid> {
        let parts = self.parts.iter_mut();
        let found: Vec<_> = parts.map(|part| part.take_errors(&self.written)).collect();
        let site_errors = self.join(&found, |site, error| FieldError {
            message: format!("site `{site}`: {}", error.message),
            ..error.clone()
        });
        self.errors.extend(site_errors);
        if self.errors.len() > MAX_ERRORS {
            self.errors.truncate(MAX_ERRORS);
            self.errors.push(FieldError::too_many());
        }
        if self.errors.is_empty() {
            Ok(self.job)
        } else {
            Err(Invalid(self.errors))
        }
    }

    /// Joins the findings of all documents: once if all have it, else labeled with the site's name.
    fn join<T: Clone + PartialEq>(&self, found: &[Vec<T>], label: impl Fn(&str, &T) -> T) -> Vec<T> {
        let mut joined = Vec::new();
        for (position, (items, document)) in found.iter().zip(&self.job.formula.documents).enumerate() {
            for item in items {
                if !found.iter().all(|others| others.contains(item)) {
                    joined.push(label(&document.site, item));
                } else if position == 0 {
                    joined.push(item.clone());
                }
            }
        }
        joined
    }

    /// A path has one world.
    fn refuse_path_with_drawn_site(&mut self) {
        let mut laws = self.job.formula.site.iter().flat_map(Node::laws);
        let documents = self.job.formula.documents.iter();
        let mut cameras = documents.flat_map(|document| find_values(&document.node, "camera"));
        if laws.any(|law| law.key() != "grid") && cameras.any(|(_, camera)| camera.get("path").is_some()) {
            let message =
                "`camera.path` needs one site, but `site` is drawn for each frame; use one site, or a `grid`";
            self.errors
                .push(FieldError::new("/site", message).limit("one site, or a `grid` of sites"));
        }
    }
}

impl Checker<'_> {
    /// Without a site a description needs a scene.
    fn require_scene(&mut self, document: &Node) {
        if document.get("scene").is_none()
            && !self
                .errors
                .iter()
                .any(|error: &FieldError| error.pointer.starts_with("/scene"))
        {
            let message = "`scene` is missing; add it, or name a `site`";
            self.refuse(|| FieldError::new("/scene", message).limit("required"));
        }
    }
}
