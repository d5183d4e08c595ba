//! The form of a picture in a response.

use serde::Deserialize;
use utoipa::ToSchema;

/// The form of an answer.
#[derive(Debug, Clone, Copy, Default, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum PictureFormat {
    /// PNG.
    #[default]
    Png,
    /// WebP without loss.
    Webp,
}
