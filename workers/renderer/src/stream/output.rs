//! A frame of a stream.

use serde_json::Value;
use spec::{ArtifactKind, FrameRecord};

use crate::content::Content;

/// A rendered frame of a stream.
#[derive(Debug, Clone, PartialEq)]
pub struct StreamFrame {
    /// The picture, the range of an input with distances, every enhancement, and the other artifacts of the job that the
    /// frame has.
    pub artifacts: Vec<(ArtifactKind, Content<'static>)>,
    /// Everything known about the picture.
    pub record: FrameRecord,
    /// Milliseconds from the call to the result.
    pub elapsed_ms: f64,
}

impl StreamFrame {
    /// The content of an artifact.
    #[must_use]
    pub fn content(&self, kind: &ArtifactKind) -> Option<&Content<'static>> {
        let found = self.artifacts.iter().find(|(known, _)| known == kind);
        found.map(|(_, content)| content)
    }

    /// The plan: every stage with its variant, error bound and expected cost.
    #[must_use]
    pub fn plan(&self) -> &Value {
        &self.record.plan
    }

    /// Bound on the error of the exposed light; `None` if the job has no tolerance.
    #[must_use]
    pub fn error_bound(&self) -> Option<f64> {
        self.record.promise.as_ref().map(|promise| promise.bound)
    }
}
