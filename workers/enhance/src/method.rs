//! The methods that a user chooses from.

use std::mem::discriminant;

use imaging::Raster;

use crate::registry::{MethodInfo, registry};
use crate::result::{EnhanceError, Enhanced};
use crate::{baseline, hscm, ibla, rd, rghs, suir, ulap};

/// An enhancement method with its options.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// Homomorphic filter, median, CLAHE, color merge, circular mask.
    Hscm(hscm::Options),
    /// CLAHE of the luma alone.
    Clahe,
    /// Channel means made equal.
    GrayWorld,
    /// Restoration by the light attenuation prior.
    Ulap,
    /// Restoration by blue-green dehazing and red correction.
    Suir,
    /// Restoration by image blurriness and light absorption.
    Ibla,
    /// Dual-intensity stretching by the Rayleigh distribution.
    Rd,
    /// Relative global histogram stretching.
    Rghs,
}

impl Method {
    /// The method of this name with its default options; `None` when no method has the name.
    #[must_use]
    pub fn parse(name: &str) -> Option<Self> {
        let info = registry().iter().find(|info| info.name == name)?;
        Some((info.default)())
    }

    /// The method's row of the registry.
    #[must_use]
    pub fn info(&self) -> &'static MethodInfo {
        let own = |info: &&MethodInfo| discriminant(&(info.default)()) == discriminant(self);
        registry().iter().find(own).expect("every method has a row")
    }

    /// The name that [`Method::parse`] reads.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.info().name
    }
}

/// How a stage with a fast and a reference implementation is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Variant {
    /// Constant time per pixel, in single precision where the tolerance allows it.
    #[default]
    Fast,
    /// The definition, written plainly in double precision.
    Reference,
}

/// Enhances one picture by its fast variant.
///
/// # Errors
/// [`EnhanceError::Empty`] for a picture without a pixel; [`EnhanceError::TooLarge`] for one beyond the method's limit.
pub fn run(method: &Method, picture: &Raster) -> Result<Enhanced, EnhanceError> {
    run_variant(method, picture, Variant::Fast)
}

/// Enhances one picture by the chosen variant.
///
/// # Errors
/// As [`run`].
pub fn run_variant(method: &Method, picture: &Raster, variant: Variant) -> Result<Enhanced, EnhanceError> {
    let (width, height) = (picture.width(), picture.height());
    if width == 0 || height == 0 {
        return Err(EnhanceError::Empty { width, height });
    }
    let pixels = width.saturating_mul(height);
    let info = method.info();
    if let Some(limit) = info.pixels_max
        && pixels > limit
    {
        return Err(EnhanceError::TooLarge {
            method: info.name,
            width,
            height,
            pixels,
            limit,
        });
    }
    match method {
        Method::Hscm(options) => hscm::enhance(picture, options, variant),
        Method::Clahe => Ok(baseline::clahe::enhance(picture)),
        Method::GrayWorld => Ok(baseline::grey_world::enhance(picture)),
        Method::Rghs => Ok(rghs::enhance(picture, variant)),
        Method::Rd => Ok(rd::enhance(picture, variant)),
        Method::Ibla => Ok(ibla::enhance(picture, variant)),
        Method::Suir => Ok(suir::enhance(picture, variant)),
        Method::Ulap => Ok(ulap::enhance(picture, variant)),
    }
}
