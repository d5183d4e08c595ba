//! A method of enhancement.

use imaging::Raster;

use crate::result::Enhanced;
use crate::variant::Variant;

/// An enhancement method.
#[derive(Debug, Clone, Copy)]
pub struct Method {
    pub(super) name: &'static str,
    pub(super) about: &'static str,
    /// Pixel limit; `None` if only memory limits it.
    pub(super) pixels_max: Option<usize>,
    /// Measured distance from its authors' results.
    pub(super) published: Option<&'static str>,
    /// Distance of a faster variant from the exact method; 0 for all others.
    pub(super) distance: f64,
    pub(super) enhance: fn(&Raster, Variant) -> Enhanced,
}
