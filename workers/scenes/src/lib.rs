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
mod scene;
mod shaft;
mod site;
mod structure;
pub mod uploaded;
mod world;

pub use error::SceneError;
pub use families::{FAMILIES, SceneFamily};
pub use labels::{Labels, SurfaceLabels};
pub use path::CameraPath;
pub use pose::{CameraPose, LEAST_CLEARANCE_M};
pub use rays::WorldRays;
pub use world::World;

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
