//! Image format of a response.

use serde::Deserialize;
use utoipa::ToSchema;

/// Image format of a response.
#[derive(Debug, Clone, Copy, Default, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum PictureFormat {
    /// PNG.
    #[default]
    Png,
    /// Lossless WebP.
    Webp,
}
