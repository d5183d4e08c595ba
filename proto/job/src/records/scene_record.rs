//! The scene part of a record: camera pose and visible objects.

use imaging::geometry::Intrinsics;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::camera::Distortion;
use crate::classes::SceneCategory;

/// The camera and the objects in view.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = SceneInView)]
pub struct SceneRecord {
    /// Rows of the matrix from camera axes (right, down, ahead, 1) to the world of a procedural scene, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, value_type = Option<Vec<Vec<f64>>>)]
    pub world_from_camera: Option<[[f64; 4]; 4]>,
    /// The pinhole camera; behind a flat port with its focal length in air.
    #[schema(value_type = CameraIntrinsics)]
    pub intrinsics: Intrinsics,
    /// Lens and port; absent for a pinhole.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, value_type = Option<Object>)]
    pub lens: Option<LensRecord>,
    /// Objects in view; absent without an artifact that needs labels.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub instances: Option<Vec<InstanceRecord>>,
    /// The classes of an uploaded scene; those of procedural scenes are fixed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, value_type = Option<Vec<Value>>)]
    pub categories: Option<Vec<SceneCategory>>,
    /// Number of objects with visible contrast.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub visible: Option<u64>,
    /// Minimum visibility of the objects that have one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub least_visibility: Option<f64>,
    /// Mean visibility.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub mean_visibility: Option<f64>,
}

/// A pinhole camera with square pixels, in index coordinates.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes [`Intrinsics`]")]
struct CameraIntrinsics {
    /// Focal length, px.
    focal_px: f64,
    /// Column of the principal point, px.
    cx: f64,
    /// Row of the principal point, px.
    cy: f64,
}

/// A lens behind its port.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LensRecord {
    /// Distortion model: `brown-conrady`, from ideal to distorted coordinates.
    pub model: String,
    /// Distortion coefficients.
    pub distortion: Distortion,
    /// Refractive index of the water in front of a flat port, R, G, B; absent without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flat_port_n_w: Option<[f64; 3]>,
}

impl LensRecord {
    /// The lens for readers without a port model: the ratio of the focal length in water to that in air, and the
    /// distortion of rays in water.
    ///
    /// A flat port maps the tangent t in the water to `ρ = n t / √(1 - (n² - 1) t²)`. Its series up to t⁷, composed
    /// with the lens, is a distortion of the same model: within two thousandths of the radius up to 30° from the axis
    /// in the water.
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = ObjectInView)]
pub struct InstanceRecord {
    /// Number in the instance mask.
    pub number: u16,
    /// Category; `GET /v1/lists/categories` lists them.
    pub category: String,
    /// Bounding box of the visible part, px: left, top, and the first column and row beyond.
    #[serde(rename = "box")]
    #[schema(value_type = Vec<u64>, min_items = 4, max_items = 4)]
    pub bounds: [usize; 4],
    /// Visible pixels.
    pub pixels: u64,
    /// For growth: number of the visible object that it is attached to.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub host: Option<u16>,
    /// Median range, m.
    pub range_m: Option<f64>,
    /// Transmittance of the water at that range, R, G, B.
    #[schema(value_type = Option<Vec<f64>>)]
    pub transmittance: Option<[f64; 3]>,
    /// Contrast against its surround after the water.
    pub contrast: Option<f64>,
    /// Contrast after the water over contrast before it, at most 1.
    pub visibility: Option<f64>,
    /// Whether the contrast after the water reaches 0.02.
    pub visible: bool,
}
