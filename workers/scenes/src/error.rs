//! Errors in the description of a scene or in its uploaded files.

use imaging::codec::DecodeError;

use super::pose::LEAST_CLEARANCE_M;

/// Invalid scene.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SceneError {
    /// Unknown procedural family.
    #[error("scene family `{family}` does not exist; there is {known}")]
    UnknownFamily {
        /// The requested name.
        family: String,
        /// The names that exist.
        known: String,
    },
    /// A file is damaged, too large, or of a type that its field does not accept.
    #[error("`{field}`: {reason}")]
    File {
        /// Upload field.
        field: &'static str,
        /// Cause.
        #[source]
        reason: DecodeError,
    },
    /// The sizes of a map and its picture differ.
    #[error("{} is {}×{} but the image is {}×{}", map_name(field), size.0, size.1, image.0, image.1)]
    Size {
        /// Upload field of the map.
        field: &'static str,
        /// Width and height of the map.
        size: (usize, usize),
        /// Width and height of the picture.
        image: (usize, usize),
    },
    /// A required value without a safe default is missing.
    #[error("`{field}` is missing: {reason}")]
    Missing {
        /// Missing field.
        field: &'static str,
        /// Feature that requires it.
        reason: &'static str,
    },
    /// A number is out of range.
    #[error("`{field}` is {value}; must be {limit}")]
    Number {
        /// The field.
        field: &'static str,
        /// Its value.
        value: f64,
        /// Allowed range.
        limit: &'static str,
    },
    /// The matrix is not a valid pose.
    #[error("`pose`: {0}")]
    Pose(&'static str),
    /// A camera is inside a solid or too close to one.
    #[error(
        "`path`: frame {frame} is {distance_m:.3} m from a surface; must be at least {} m away",
        LEAST_CLEARANCE_M
    )]
    Blocked {
        /// Frame number from 0.
        frame: usize,
        /// Distance from the surface; negative inside.
        distance_m: f64,
    },
    /// A view places the camera inside a solid or too close to one.
    #[error(
        "`camera.{field}` is {value}, which puts the camera {clearance_m:.3} m from a surface; the limit is {} m: \
        change it or leave it out",
        LEAST_CLEARANCE_M
    )]
    View {
        /// Field of the description's `camera`.
        field: &'static str,
        /// Its value.
        value: f64,
        /// Distance from the surface; negative inside.
        clearance_m: f64,
    },
    /// Classes without a mask, classes of objects absent from the mask, or a mask with too many objects.
    #[error("`{field}`: {reason}")]
    Objects {
        /// `classes` or `instances`.
        field: &'static str,
        /// Cause.
        reason: String,
    },
    /// A radiance is NaN or infinite; forward scatter would spread it over the whole frame.
    #[error("`rgb`: radiance is {value} at pixel ({x}, {y}); must be finite")]
    Radiance {
        /// Column of the first such pixel in row-major order.
        x: usize,
        /// Row of that pixel.
        y: usize,
        /// The invalid sample.
        value: f32,
    },
}

impl SceneError {
    /// API name of the invalid field.
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
