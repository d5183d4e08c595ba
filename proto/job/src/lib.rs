//! Validated job and frame descriptions, their distributions, and the record of a frame.
//!
//! A [`Job`] is a frame description with distributions in place of values. [`Job::parse`] reports all errors
//! together. [`Job::resolve`] is a pure function of (job, index) to a [`Frame`] without distributions.

mod check;
mod collection;
mod declared;
mod described;
mod description;
mod distributions;
mod job;
mod own_water;
mod recent;
mod records;
pub mod schema;
mod site;
mod text;
mod warnings;

pub use imaging::digest::{hex, sha256};
pub use imaging::geometry::Intrinsics;

pub use artifact::ArtifactKind;
pub use camera::{
    Camera, CameraView, Cfa, Chroma, Defocus, Distortion, Exposure, Jpeg, Metering, Motion, Path, Port,
    Sensor, Stereo, Tone, Vignette, Waypoint, WhiteBalance,
};
pub use classes::{Classes, SceneCategory, Segment};
pub use collection::{MAX_COLLECTION, is_collection};
pub use comparison::{
    Agreement, RecordDifference, UNCOMPARED_MEMBERS, compare_records, compare_values, describe_differences,
    find_unknown_members,
};
pub use daylight::{Daylight, NamedDaylight, Sky};
pub use declared::{fields, table};
use declared::{leaves, rules, vocabulary};
pub use described::{Beyond, Described, beyond};
pub use description::truth;
use description::{
    artifact, camera, classes, daylight, enhancement, frame, inhabited, label_types, light, results, scene,
    scene_files, scene_parts, suspended, water,
};
pub use distributions::law;
use distributions::{node, normal};
pub use earlier::{EARLIER_VERSION, is_of_earlier_version};
pub use encode::Encode;
pub use enhancement::mask::{Circle, Mask, Saturated};
pub use enhancement::mask_image::MaskImage;
pub use enhancement::parameters::{
    Clahe, DarkChannel, EnhancerNetwork, Fusion, GrayWorld, Guided, Hscm, Ibla, IblaRefinement, Mlle,
    Rayleigh, ResultColor, Stretching,
};
pub use enhancement::{Enhancement, HSCM_STEPS, MASK_STEP, METHODS, MetricsOver, NETWORK_METHOD, Step};
pub use frame::{Fidelity, Frame, Siblings, SiteName};
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
use records::{comparison, merkle, record, record_text, scene_record, set_state, shard_member};
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
pub use text::migration;
use text::{earlier, encode, invalid, json, suggest};
pub use truth::{Truth, TruthRecord};
pub use vocabulary::{KnownNetwork, METRIC_NETWORK, Vocabulary};
pub use water::{ForwardScatter, HoleRule, Optics, PhaseFunction, ScatterModel, ScatterSource, Water};
