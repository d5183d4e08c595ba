//! The list of methods that a user chooses from.

use imaging::{Plane, Raster};

use crate::hscm;

/// Names of all methods, as a job names them and as [`Method::parse`] reads them.
pub const METHODS: &[&str] = &["hscm"];

/// An enhancement method with its options.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// Homomorphic filter, median, CLAHE, colour merge, circular mask.
    Hscm(hscm::Options),
}

impl Method {
    /// The method of this name with its default options; `None` when no method has the name.
    #[must_use]
    pub fn parse(name: &str) -> Option<Self> {
        match name {
            "hscm" => Some(Self::Hscm(hscm::Options::default())),
            _ => None,
        }
    }

    /// The name that [`Method::parse`] reads.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Hscm(_) => "hscm",
        }
    }
}

/// How a stage with a fast and a reference implementation is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Variant {
    /// Single precision where the tolerance allows it.
    #[default]
    Fast,
    /// The definition, written plainly in double precision.
    Reference,
}

/// What a method returns.
#[derive(Debug, Clone, PartialEq)]
pub struct Enhanced {
    /// The result, 8 bit, masked where the options ask for a mask.
    pub picture: Raster,
    /// The same result before the mask: what metrics are taken from.
    pub unmasked: Raster,
    /// 255 where a pixel is kept and 0 where it is blacked out; `None` without a mask. A feature extractor wants
    /// this plane, since the hard edge in the masked picture makes key points along the circle.
    pub mask: Option<Plane<u8>>,
}

/// A picture that cannot be enhanced. Options cannot be wrong here: [`hscm::Options`] are checked when made.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum EnhanceError {
    /// The picture has no pixel.
    #[error("picture is {width}×{height} but needs at least 1×1")]
    Empty {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
    },
}

/// Enhances one picture by its fast variant.
///
/// # Errors
/// [`EnhanceError::Empty`] for a picture without a pixel.
pub fn run(method: &Method, picture: &Raster) -> Result<Enhanced, EnhanceError> {
    match method {
        Method::Hscm(options) => hscm::enhance(picture, options, Variant::Fast),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_listed_method_parses_to_its_own_name() {
        for name in METHODS {
            assert_eq!(Method::parse(name).map(|method| method.name()), Some(*name));
        }
        assert_eq!(Method::parse("HSCM"), None);
    }
}
