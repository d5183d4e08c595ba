//! What a record says about the scene of a frame: where the camera was, and what could be seen.

use imaging::geometry::Intrinsics;
use serde::{Deserialize, Serialize};

use crate::camera::Distortion;
use crate::classes::SceneCategory;

/// The camera and the objects in view.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SceneRecord {
    /// Rows of the matrix that takes camera axes (right, down, ahead, 1) to the world of a procedural scene, in meters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub world_from_camera: Option<[[f64; 4]; 4]>,
    /// The camera, in index coordinates; of one behind a flat port its focal length in air.
    pub intrinsics: Intrinsics,
    /// What bends its rays; absent of a pinhole.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lens: Option<LensRecord>,
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

/// A lens behind its port.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LensRecord {
    /// How the distortion is meant: `brown-conrady`, from ideal to distorted coordinates.
    pub model: String,
    /// Its coefficients.
    pub distortion: Distortion,
    /// Refractive index of the water before a flat port, R, G, B; absent without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flat_port_n_w: Option<[f64; 3]>,
}

impl LensRecord {
    /// The lens for readers that know no ports: the focal length over that in air, and the distortion of rays in the water.
    ///
    /// A flat port makes `ρ = n t / √(1 - (n² - 1) t²)` of the tangent t in the water. Its series up to t⁷, into which the lens
    /// is inserted, is a distortion of the same kind: within two thousandths of the radius up to 30° from the axis in the water.
    #[must_use]
    pub fn in_water(&self) -> (f64, Distortion) {
        let Some([_, n, _]) = self.flat_port_n_w else {
            return (1.0, self.distortion);
        };
        let bend = n * n - 1.0;
        let port = [
            bend / 2.0,
            3.0 / 8.0 * bend * bend,
            5.0 / 16.0 * bend * bend * bend,
        ];
        let Distortion { k1, k2, k3, p1, p2 } = self.distortion;
        let n2 = n * n;
        let lens = [
            k1 * n2,
            2.0 * k1 * n2 * port[0] + k2 * n2 * n2,
            k1 * n2 * (2.0 * port[1] + port[0] * port[0]) + 4.0 * k2 * n2 * n2 * port[0] + k3 * n2 * n2 * n2,
        ];
        let distortion = Distortion {
            k1: port[0] + lens[0],
            k2: port[1] + port[0] * lens[0] + lens[1],
            k3: port[2] + port[1] * lens[0] + port[0] * lens[1] + lens[2],
            p1: p1 * n,
            p2: p2 * n,
        };
        (n, distortion)
    }
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
    /// Of growth: the number of the object in view that it is attached to.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub host: Option<u16>,
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
