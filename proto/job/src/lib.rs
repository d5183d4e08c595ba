//! Validated job and frame descriptions, their distributions, and the record of a frame.
//!
//! A [`Job`] is a frame description with distributions in place of values. [`Job::parse`] reports all errors
//! together. [`Job::resolve`] is a pure function of (job, index) to a [`Frame`] without distributions.

mod artifact;
mod camera;
mod check;
mod classes;
mod collection;
mod daylight;
mod described;
mod earlier;
mod encode;
pub mod fields;
mod frame;
mod inhabited;
mod invalid;
mod job;
mod json;
mod label_types;
pub mod law;
mod leaves;
mod light;
mod merkle;
pub mod migration;
mod node;
mod normal;
mod own_water;
mod recent;
mod record;
mod record_text;
mod results;
mod rules;
mod scene;
mod scene_files;
mod scene_parts;
mod scene_record;
pub mod schema;
mod set_state;
mod shard_member;
mod site;
mod suggest;
mod suspended;
pub mod table;
pub mod truth;
mod vocabulary;
mod warnings;
mod water;

pub use imaging::digest::{hex, sha256};
pub use imaging::geometry::Intrinsics;

pub use artifact::{ArtifactKind, is_media_type};
pub use camera::{
    Camera, CameraView, Cfa, Chroma, Defocus, Distortion, Exposure, Jpeg, Metering, Motion, Path, Port,
    Sensor, Tone, Vignette, Waypoint, WhiteBalance,
};
pub use classes::{Classes, SceneCategory, Segment};
pub use collection::{MAX_COLLECTION, is_collection};
pub use daylight::{Daylight, NamedDaylight, Sky};
pub use described::{Beyond, Described, beyond};
pub use earlier::{EARLIER_VERSION, is_of_earlier_version};
pub use encode::Encode;
pub use frame::{Fidelity, Frame, SiteName};
pub use inhabited::{Ground, Life};
pub use invalid::{FieldError, Invalid, MAX_ERRORS};
pub use job::{Draft, Job};
pub use json::{MAX_BYTES, MAX_DEPTH, read as read_json, skip_byte_order_mark};
pub use label_types::{LabelType, collect_types, label_columns, label_types};
pub use leaves::{Leaf, LeafKind, Leaves, List};
pub use light::{Haze, HazeBlend, HazeSpace, Light, PointLamp, RaySource, SpotLamp};
pub use merkle::MerkleTree;
pub use normal::normal_quantile;
pub use own_water::{JERLOV_TYPES, OwnWater};
pub use recent::RecentJobs;
pub use record::{ArtifactEntry, Counts, FrameRecord, Promise, Provenance, RecordOf, job_digest};
pub use record_text::{BriefRecord, RecordText, Sound};
pub use rules::{CameraRules, Fault, WaterConditions, WaterRules};
pub use scene::{Scene, SceneLighting};
pub use scene_files::{RangeFile, RangeKind, SceneFiles};
pub use scene_parts::{ScenePart, SceneParts, Uploads};
pub use scene_record::{InstanceRecord, LensRecord, SceneRecord};
pub use set_state::SetState;
pub use shard_member::shard_member;
pub use site::{SITES, SitePreset};
pub use suggest::nearest;
pub use suspended::{Sediment, Snow, Turbidity};
pub use truth::{Truth, TruthRecord};
pub use vocabulary::Vocabulary;
pub use water::{ForwardScatter, HoleRule, Optics, PhaseFunction, ScatterModel, ScatterSource, Water};
