//! Damage found since the catalogue was opened.

use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

use tokio::sync::Notify;

use crate::error::CatalogueError;
use crate::image_id::ImageId;

/// Findings that are kept; more call for a full check anyway.
const MOST_FINDINGS: usize = 100;

/// A damaged row or artifact of an image.
#[derive(Debug, Clone)]
pub struct ImageDamage {
    /// The image.
    pub image: ImageId,
    /// The row as lists name it, or the artifact.
    pub what: String,
}

/// The findings, each with the image that it concerns, if any.
#[derive(Default)]
pub(crate) struct DamageLog {
    findings: Mutex<BTreeMap<String, Option<ImageDamage>>>,
    found: Notify,
}

impl DamageLog {
    pub(crate) fn texts(&self) -> Vec<String> {
        self.findings().keys().cloned().collect()
    }

    pub(crate) fn images(&self) -> Vec<ImageDamage> {
        self.findings().values().flatten().cloned().collect()
    }

    /// Waits for the next finding about an image.
    pub(crate) async fn wait_for_image(&self) {
        self.found.notified().await;
    }

    pub(crate) fn note(&self, text: String, image: Option<ImageDamage>) {
        let mut findings = self.findings();
        if findings.len() < MOST_FINDINGS && !findings.contains_key(&text) {
            if image.is_some() {
                self.found.notify_one();
            }
            findings.insert(text, image);
        }
    }

    pub(crate) fn note_error(&self, error: &CatalogueError) {
        if let CatalogueError::Damaged { what, image } = error {
            let damage = image.clone().map(|image| ImageDamage {
                image,
                what: what.clone(),
            });
            self.note(error.to_string(), damage);
        }
    }

    pub(crate) fn forget(&self, restored: &ImageId) {
        self.findings()
            .retain(|_, damage| damage.as_ref().is_none_or(|damage| damage.image != *restored));
    }

    /// Adds the name of a damaged row to `names`, notes it and returns `None`; other results are unchanged.
    pub(crate) fn skip<T>(
        &self,
        row: Result<T, CatalogueError>,
        names: &mut Vec<String>,
    ) -> Result<Option<T>, CatalogueError> {
        match row {
            Err(error @ CatalogueError::Damaged { .. }) => {
                self.note_error(&error);
                if let CatalogueError::Damaged { what, .. } = error {
                    tracing::error!(what, "a damaged row is left out of a list");
                    names.push(what);
                }
                Ok(None)
            }
            other => other.map(Some),
        }
    }

    fn findings(&self) -> MutexGuard<'_, BTreeMap<String, Option<ImageDamage>>> {
        self.findings.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
