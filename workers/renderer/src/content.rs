//! What an artifact holds before it becomes a file.

use std::borrow::Cow;

use imaging::{Plane, Raster, Rgb, Rgb8};
use serde_json::Value;
use spec::{ArtifactKind, FrameRecord};

/// What an artifact holds before it becomes a file.
#[derive(Debug, Clone, PartialEq)]
pub enum Content<'a> {
    /// A picture, stored in the format that the frame asks for.
    Picture(Cow<'a, Rgb8>),
    /// Codes that must stay what they are, stored as PNG.
    Codes(Raster),
    /// Linear samples, stored as NPY.
    Linear(Cow<'a, Rgb<f32>>),
    /// Linear samples and their standard errors, stored as NPY of six planes.
    Pair([Cow<'a, Rgb<f32>>; 2]),
    /// Range in meters, NaN, infinite or not positive where there is none; stored as PNG in millimeters.
    Range(Cow<'a, Plane<f32>>),
    /// An object, stored as JSON.
    Json(Value),
}

/// A rendered frame whose artifacts are not encoded; its record lists no artifact.
#[derive(Debug, Clone, PartialEq)]
pub struct Contents {
    /// The artifacts that the frame asks for, in its order, those that it has.
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
