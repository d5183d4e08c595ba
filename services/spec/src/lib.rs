//! Validated job and frame descriptions, the laws that vary them, and the record of a frame.
//!
//! A [`Job`] is a frame description with laws in place of values. [`Job::parse`] checks everything once and reports
//! all errors together; [`Job::resolve`] is a pure function of (job, index) to a [`Frame`] without any law left.

mod artifact;
mod check;
mod draw;
#[rustfmt::skip]
pub mod fields;
mod frame;
mod haze;
mod invalid;
mod job;
mod json;
mod lamps;
pub mod law;
mod node;
mod normal;
mod own_water;
mod record;
mod scene_record;
pub mod schema;
mod suggest;
mod suspended;
pub mod table;
mod typed;
mod vocabulary;
mod warnings;
mod water;

pub use artifact::ArtifactKind;
pub use frame::{
    Ambient, Beam, Camera, Encode, Fidelity, Format, ForwardScatter, ForwardScatterModel, Frame, Haze,
    HazeBlend, HazeSpace, HoleRule, Lamp, Optics, Path, RangeFile, ScatterSource, Scene, StyleTier, Water,
    Waypoint,
};
pub use haze::{haze_lights, haze_space};
pub use invalid::{FieldError, Invalid, MAX_ERRORS};
pub use job::Job;
pub use json::{MAX_BYTES, MAX_DEPTH};
pub use lamps::lamps;
pub use normal::normal_quantile;
pub use own_water::OwnWater;
pub use record::{ArtifactEntry, Counts, FrameRecord, Provenance, hex, job_digest};
pub use scene_record::{InstanceRecord, IntrinsicsRecord, SceneRecord};
pub use suspended::{Snow, Turbidity, snow, turbidity, water_world};
pub use vocabulary::Vocabulary;
pub use warnings::diffuse_warning;
pub use water::water_request;
