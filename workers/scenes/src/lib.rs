//! Scenes in air: procedural and uploaded radiance, range, masks and labels.
//!
//! Pure: a procedural scene is a function of (family, seed, camera), an uploaded one of its bytes.

mod bottom;
pub mod categories;
pub mod classes;
mod error;
mod families;
pub mod labels;
mod life;
mod open_water;
mod path;
mod pipeline;
pub mod pose;
mod rays;
mod shaft;
mod site;
mod structure;
pub mod uploaded;
mod world;

pub use error::SceneError;
pub use families::{FAMILIES, SceneFamily};
pub use labels::{Labels, SurfaceLabels};
pub use path::CameraPath;
pub use pose::CameraPose;
pub use rays::WorldRays;
pub use world::World;

use imaging::geometry::Intrinsics;
use imaging::{Plane, Rgb};

/// A scene in air.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Linear radiance (white = 1, at least 0, may exceed 1), or reflectance where requested.
    pub radiance: Rgb<f32>,
    /// Range in meters along the line of sight. Non-finite values and values below a millimeter are holes.
    pub range: Option<Plane<f32>>,
    /// Instance of each pixel, 0 = background.
    pub instances: Option<Plane<u16>>,
    /// Camera intrinsics, if known.
    pub intrinsics: Option<Intrinsics>,
    /// Unit normals without relief in camera axes, supplied with the reflectance of procedural scenes.
    pub normals: Option<[Plane<f32>; 3]>,
}

/// Minimum distance from surfaces of a camera on a path, m.
pub const LEAST_CLEARANCE_M: f64 = 0.05;

/// Renders a procedural scene from its default pose.
///
/// # Errors
/// [`SceneError::UnknownFamily`].
pub fn procedural(
    family: &str,
    seed: u64,
    width: usize,
    height: usize,
    intrinsics: Intrinsics,
) -> Result<Scene, SceneError> {
    let world = World::new(family, seed)?;
    Ok(world.render(&world.pose(), (width, height), &intrinsics))
}
