//! What a record says about the scene of a frame: where the camera was, and what could be seen.

use imaging::geometry::Intrinsics;
use serde::{Deserialize, Serialize};

use crate::classes::SceneCategory;

/// The camera and the objects in view.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SceneRecord {
    /// Rows of the matrix that takes camera axes (right, down, ahead, 1) to the world of a procedural scene, in meters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub world_from_camera: Option<[[f64; 4]; 4]>,
    /// The pinhole camera, in index coordinates.
    pub intrinsics: Intrinsics,
    /// The objects in view; absent unless an artifact with labels was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub instances: Option<Vec<InstanceRecord>>,
    /// The classes of an uploaded scene; those of procedural scenes are always the same.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub categories: Option<Vec<SceneCategory>>,
    /// How many of them have a contrast that can be seen.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub visible: Option<u64>,
    /// The least visibility of those that have one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub least_visibility: Option<f64>,
    /// Their mean visibility.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mean_visibility: Option<f64>,
}

/// An object in view.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct InstanceRecord {
    /// Its number in the instance mask.
    pub number: u16,
    /// What it is, by the name of the semantic mask's code.
    pub category: String,
    /// The box around what is seen of it: left, top, and the first column and row beyond.
    #[serde(rename = "box")]
    pub bounds: [usize; 4],
    /// How many pixels show it.
    pub pixels: u64,
    /// Its median range in meters.
    pub range_m: Option<f64>,
    /// Transmittance of the water at that range, R, G, B.
    pub transmittance: Option<[f64; 3]>,
    /// Its contrast against its surround after the water.
    pub contrast: Option<f64>,
    /// That contrast over the one before the water, at most 1; absent where it had none before.
    pub visibility: Option<f64>,
    /// Whether the contrast after the water reaches the threshold of sight, 0.02.
    pub visible: bool,
}
