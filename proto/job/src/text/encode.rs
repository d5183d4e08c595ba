//! Image encodings.

use serde::Deserialize;
use spec_derive::Described;

/// File format of RGB-like artifacts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Described)]
#[serde(tag = "format", rename_all = "snake_case")]
#[described(default = "png")]
pub enum Encode {
    /// PNG, lossless.
    Png,
    /// WebP, lossless.
    Webp,
    /// JPEG.
    Jpeg {
        /// JPEG quality
        #[field(within(1, 100), default = 95)]
        quality: u8,
    },
}
