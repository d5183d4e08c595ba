//! The methods that a user chooses from: a file or folder for each, and a row in the table.

mod clahe;
mod gray_world;
pub mod hscm;
mod ibla;
mod rd;
mod rghs;
mod suir;
mod ulap;
#[cfg(test)]
mod vectors;

use imaging::Raster;

use crate::result::{EnhanceError, Enhanced};
use crate::variant::Variant;

/// An enhancement method.
#[derive(Debug, Clone, Copy)]
pub struct Method {
    name: &'static str,
    about: &'static str,
    /// Most pixels of a picture; `None` where only memory limits it.
    pixels_max: Option<usize>,
    enhance: fn(&Raster, Variant) -> Enhanced,
}

const TABLE: [Method; 9] = [
    Method::new(
        "hscm",
        "homomorphic filter, spatial median, CLAHE and circular mask",
        hscm::enhance,
    ),
    Method::new(
        "clahe",
        "CLAHE of the luma, the chroma kept (Zuiderveld 1994)",
        clahe::enhance,
    ),
    Method::new(
        "grey_world",
        "gray world: each channel scaled to the mean of all (Buchsbaum 1980)",
        gray_world::enhance,
    ),
    Method::new(
        "ulap",
        "restoration by the underwater light attenuation prior (Song et al. 2018)",
        ulap::enhance,
    )
    .guided(),
    Method::new(
        "suir",
        "blue-green dehazing and red correction (Li, Guo, Pang, Chen and Wang 2016)",
        suir::enhance,
    )
    .guided(),
    Method::new(
        "ibla",
        "restoration by blurriness and light absorption (Peng and Cosman 2017)",
        ibla::enhance,
    )
    .guided(),
    Method::new(
        "ibla_guided",
        "IBLA refined by the guided filter, which is faster",
        ibla::enhance_guided,
    )
    .guided(),
    Method::new(
        "rd",
        "two pictures integrated by the Rayleigh distribution (Abdul Ghani and Mat Isa 2014)",
        rd::enhance,
    ),
    Method::new(
        "rghs",
        "relative global histogram stretching (Huang et al. 2018)",
        rghs::enhance,
    ),
];

/// Names of all methods, as [`Method::parse`] reads them.
pub const METHODS: &[&str] = &{
    let mut names = [""; TABLE.len()];
    let mut row = 0;
    while row < names.len() {
        names[row] = TABLE[row].name;
        row += 1;
    }
    names
};

/// Most pixels for the methods with a color guided filter, which hold several planes in double precision.
const GUIDED_PIXELS_MAX: usize = 16_000_000;

impl Method {
    const fn new(name: &'static str, about: &'static str, enhance: fn(&Raster, Variant) -> Enhanced) -> Self {
        Self {
            name,
            about,
            pixels_max: None,
            enhance,
        }
    }

    /// Limited to the pixels of the guided filter.
    const fn guided(self) -> Self {
        Self {
            pixels_max: Some(GUIDED_PIXELS_MAX),
            ..self
        }
    }

    /// Returns the method of this name, if there is one.
    #[must_use]
    pub fn parse(name: &str) -> Option<Self> {
        TABLE.into_iter().find(|method| method.name == name)
    }

    /// The name that [`Method::parse`] reads.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// What it does, and its source.
    #[must_use]
    pub fn about(&self) -> &'static str {
        self.about
    }
}

/// Enhances one picture by the fast variant of a method.
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
    match method.pixels_max {
        Some(limit) if pixels > limit => Err(EnhanceError::TooLarge {
            method: method.name,
            width,
            height,
            pixels,
            limit,
        }),
        _ => Ok((method.enhance)(picture, variant)),
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
        assert!(Method::parse("HSCM").is_none());
    }
}
