//! What can be wrong with the description of a scene, or with the files of an uploaded one.

use imaging::codec::DecodeError;

use crate::FAMILIES;

/// A scene that cannot be made from what was given.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SceneError {
    /// No such procedural family.
    #[error("scene family `{family}` does not exist; there is {}", FAMILIES.join(", "))]
    UnknownFamily {
        /// The name that was asked for.
        family: String,
    },
    /// A file is damaged, too large, or holds something else than what the field takes.
    #[error("`{field}`: {reason}")]
    File {
        /// The field the file came in.
        field: &'static str,
        /// What is wrong with it.
        #[source]
        reason: DecodeError,
    },
    /// A map has other sides than the picture it belongs to.
    #[error("{map} is {width}×{height} but the image is {image_width}×{image_height}")]
    Size {
        /// The field the map came in.
        field: &'static str,
        /// What the map is called.
        map: &'static str,
        /// Columns of the map.
        width: usize,
        /// Rows of the map.
        height: usize,
        /// Columns of the picture.
        image_width: usize,
        /// Rows of the picture.
        image_height: usize,
    },
    /// Something that cannot be guessed was not given.
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
    /// A camera that is in or too close to something.
    #[error(
        "`{field}`: frame {frame} is {distance_m:.3} m from a surface but must be at least {limit_m} m away"
    )]
    Blocked {
        /// The field that placed the camera.
        field: &'static str,
        /// The frame, from 0 on.
        frame: usize,
        /// Distance from the surface, below 0 inside.
        distance_m: f64,
        /// The least distance.
        limit_m: f64,
    },
    /// A radiance that is NaN or infinite. It would spread over the whole frame.
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
    /// The field that is to blame, by the API's name.
    #[must_use]
    pub fn field(&self) -> &'static str {
        match self {
            Self::UnknownFamily { .. } => "family",
            Self::Radiance { .. } => "rgb",
            Self::File { field, .. }
            | Self::Size { field, .. }
            | Self::Missing { field, .. }
            | Self::Blocked { field, .. }
            | Self::Number { field, .. } => field,
        }
    }
}
