//! Artifact contents before encoding.

use std::borrow::Cow;

use imaging::{Plane, Raster, Rgb, Rgb8};
use serde_json::Value;
use spec::{ArtifactKind, FrameRecord};

/// The content of an artifact before encoding.
#[derive(Debug, Clone, PartialEq)]
pub enum Content<'a> {
    /// A picture, encoded in the format of the job.
    Picture(Cow<'a, Rgb8>),
    /// Exact integer codes, stored as PNG.
    Codes(Raster),
    /// Linear samples, stored as NPY.
    Linear(Cow<'a, Rgb<f32>>),
    /// Linear samples and their standard errors, stored as NPY of six planes.
    Pair([Cow<'a, Rgb<f32>>; 2]),
    /// Range in meters; NaN, infinity and non-positive values mark holes. Stored as PNG in millimeters.
    Range(Cow<'a, Plane<f32>>),
    /// An object, stored as JSON.
    Json(Value),
}

/// A rendered frame whose artifacts are not encoded; its record lists no artifact.
#[derive(Debug, Clone, PartialEq)]
pub struct Contents {
    /// The requested artifacts of this frame, in the order of the job. Unavailable ones are left out.
    pub artifacts: Vec<(ArtifactKind, Content<'static>)>,
    /// Everything known about the image.
    pub record: FrameRecord,
}

impl Content<'_> {
    pub(crate) fn into_owned(self) -> Content<'static> {
        match self {
            Self::Picture(picture) => Content::Picture(Cow::Owned(picture.into_owned())),
            Self::Codes(codes) => Content::Codes(codes),
            Self::Linear(layer) => Content::Linear(Cow::Owned(layer.into_owned())),
            Self::Pair(pair) => Content::Pair(pair.map(|layer| Cow::Owned(layer.into_owned()))),
            Self::Range(range) => Content::Range(Cow::Owned(range.into_owned())),
            Self::Json(value) => Content::Json(value),
        }
    }
}
