//! Scenes in air: procedural and uploaded radiance, range, masks and labels.
//!
//! Pure: a procedural scene is a function of (family, seed, camera), an uploaded one of its bytes.

mod bottom;
pub mod categories;
pub mod classes;
mod error;
mod generators;
pub mod labels;
mod life;
mod path;
pub mod pose;
mod rays;
mod scene;
mod site;
pub mod uploaded;
mod world;

pub use error::SceneError;
pub use families::{FAMILIES, SceneFamily};
pub use labels::{Labels, SurfaceLabels};
pub use path::CameraPath;
pub use pose::{CameraPose, LEAST_CLEARANCE_M};
pub use rays::WorldRays;
pub use world::World;

use generators::{families, open_water, pipeline, shaft, structure};
use imaging::geometry::Intrinsics;
pub use scene::Scene;

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
