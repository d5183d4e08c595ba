//! Messages between the service and the process that renders pictures: a line of JSON, then the bytes of files.

use serde::{Deserialize, Serialize};
use serde_json::Value;
use spec::RangeKind;

/// A picture to render.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct PictureRequest {
    pub(crate) job: PictureJob,
    pub(crate) stamp_ns: u64,
    pub(crate) camera: Option<[[f64; 3]; 3]>,
    pub(crate) pose: Option<[[f64; 4]; 4]>,
    pub(crate) format: ReplyFormat,
    pub(crate) files: Vec<InputFile>,
}

/// The job of a picture. Requests of equal jobs share a stream.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct PictureJob {
    /// The canonical description.
    pub(crate) description: String,
    pub(crate) gives_hfov: bool,
    pub(crate) has_metrics: bool,
    pub(crate) has_instances: bool,
}

/// A file that follows the line.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct InputFile {
    pub(crate) role: InputRole,
    pub(crate) bytes: u64,
}

/// The form field of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum InputRole {
    Rgb,
    Range,
    ZDepth,
    Instances,
}

impl InputRole {
    pub(crate) const ALL: [Self; 4] = [Self::Rgb, Self::Range, Self::ZDepth, Self::Instances];

    /// The name of its field.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Rgb => "rgb",
            Self::Range => RangeKind::Range.name(),
            Self::ZDepth => RangeKind::ZDepth.name(),
            Self::Instances => "instances",
        }
    }
}

/// What a caller receives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum ReplyFormat {
    /// The picture as PNG.
    Png,
    /// The picture as lossless WebP.
    Webp,
    /// The record and all artifacts, in the format of the job.
    Mixed,
}

/// The line before the files of a reply.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct PictureReply {
    /// Bytes of all files.
    pub(crate) bytes: u64,
    pub(crate) outcome: Outcome,
}

/// What became of a request.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Outcome {
    Rendered {
        record: Value,
        warnings: Vec<String>,
        files: Vec<OutputFile>,
    },
    /// Wrong parts of the form.
    Refused(Vec<WrongPart>),
    /// The frame cannot be rendered.
    Failed(String),
}

/// A file of a reply.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct OutputFile {
    pub(crate) kind: String,
    pub(crate) media_type: String,
    pub(crate) bytes: u64,
}

/// A wrong part of a form.
#[derive(Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct WrongPart {
    /// Its field.
    pub(crate) name: String,
    pub(crate) message: String,
}
