//! Errors in the description of a scene, or in the files of an uploaded one.

use imaging::codec::DecodeError;

use crate::LEAST_CLEARANCE_M;

/// A scene that cannot be made from what was given.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SceneError {
    /// No such procedural family.
    #[error("scene family `{family}` does not exist; there is {known}")]
    UnknownFamily {
        /// The requested name.
        family: String,
        /// The names that exist.
        known: String,
    },
    /// A file is damaged, too large, or of a type that the field does not take.
    #[error("`{field}`: {reason}")]
    File {
        /// The field the file came in.
        field: &'static str,
        /// What is wrong with it.
        #[source]
        reason: DecodeError,
    },
    /// A map does not have the size of the picture it belongs to.
    #[error("{} is {}×{} but the image is {}×{}", map_name(field), size.0, size.1, image.0, image.1)]
    Size {
        /// The field the map came in.
        field: &'static str,
        /// Width and height of the map.
        size: (usize, usize),
        /// Width and height of the picture.
        image: (usize, usize),
    },
    /// A value without a safe default is missing.
    #[error("`{field}` is missing: {reason}")]
    Missing {
        /// What is missing.
        field: &'static str,
        /// What needs it.
        reason: &'static str,
    },
    /// A number outside its limits.
    #[error("`{field}` is {value} but must be {limit}")]
    Number {
        /// The field.
        field: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        limit: &'static str,
    },
    /// A matrix that is no pose.
    #[error("`pose`: {0}")]
    Pose(&'static str),
    /// A camera inside a solid or too close to one.
    #[error(
        "`path`: frame {frame} is {distance_m:.3} m from a surface but must be at least {} m away",
        LEAST_CLEARANCE_M
    )]
    Blocked {
        /// The frame, from 0 on.
        frame: usize,
        /// Distance from the surface, below 0 inside.
        distance_m: f64,
    },
    /// A view whose camera would be inside a solid or too close to one.
    #[error(
        "`camera.{field}` is {value}, which puts the camera {clearance_m:.3} m from a surface; the limit is {} m: \
        change it or leave it out",
        LEAST_CLEARANCE_M
    )]
    View {
        /// The field of the description's `camera`.
        field: &'static str,
        /// Its value.
        value: f64,
        /// Distance from the surface, below 0 inside.
        clearance_m: f64,
    },
    /// Classes without a mask, of objects that the mask does not show, or a mask of more objects than can be told apart.
    #[error("`{field}`: {reason}")]
    Objects {
        /// `classes` or `instances`.
        field: &'static str,
        /// What is wrong.
        reason: String,
    },
    /// A radiance that is NaN or infinite, which forward scatter would spread over the whole frame.
    #[error("`rgb`: radiance is {value} at pixel ({x}, {y}) but must be finite")]
    Radiance {
        /// Column of the first such pixel, row by row.
        x: usize,
        /// Row of the first such pixel.
        y: usize,
        /// The sample.
        value: f32,
    },
}

impl SceneError {
    /// The API's name of the field at fault.
    #[must_use]
    pub fn field(&self) -> &'static str {
        match self {
            Self::UnknownFamily { .. } => "family",
            Self::Radiance { .. } => "rgb",
            Self::Blocked { .. } => "path",
            Self::Pose(_) => "pose",
            Self::File { field, .. }
            | Self::Objects { field, .. }
            | Self::Size { field, .. }
            | Self::Missing { field, .. }
            | Self::View { field, .. }
            | Self::Number { field, .. } => field,
        }
    }
}

fn map_name(field: &str) -> &'static str {
    match field {
        "range" => "range map",
        "z_depth" => "z-depth map",
        _ => "instance mask",
    }
}
