//! What the camera would see in air: procedural and uploaded radiance, range and masks.
//!
//! Pure: a procedural scene is a function of (family, seed, camera), an uploaded one of its bytes.

mod error;
pub mod structure;
pub mod uploaded;

pub use error::SceneError;

use imaging::geometry::Intrinsics;
use imaging::{Plane, Rgb};

/// A scene in air.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Linear radiance, white = 1, at least 0; may exceed 1.
    pub radiance: Rgb<f32>,
    /// Range in metres along the line of sight; not finite or below a millimetre: a hole.
    pub range: Option<Plane<f32>>,
    /// Instance of each pixel, 0 = background.
    pub instances: Option<Plane<u16>>,
    /// The camera, if it is known.
    pub intrinsics: Option<Intrinsics>,
}

/// The procedural families.
pub const FAMILIES: &[&str] = &["structure"];

/// Renders a procedural scene.
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
    match family {
        "structure" => Ok(structure::render(seed, width, height, intrinsics)),
        _ => Err(SceneError::UnknownFamily {
            family: family.to_owned(),
        }),
    }
}
