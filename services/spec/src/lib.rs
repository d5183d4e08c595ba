//! Validated job and frame descriptions, the laws that vary them, and the record of a frame.
//!
//! A [`Job`] is a frame description with laws in place of values. [`Job::parse`] checks everything once and reports
//! all errors together; [`Job::resolve`] is a pure function of (job, index) to a [`Frame`] without any law left.

mod frame;
mod record;

pub use frame::{
    Ambient, ArtifactKind, Camera, Encode, Fidelity, ForwardScatter, ForwardScatterModel, Format, Frame, Haze,
    HazeBlend, HazeSpace, HoleRule, Optics, RangeFile, Scene, ScatterSource, Water,
};
pub use record::{ArtifactEntry, Counts, FrameRecord, Provenance, hex, job_digest};
