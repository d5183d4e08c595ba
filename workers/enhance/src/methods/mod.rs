//! Registry of the methods: a file or folder for each, and a row in the table.

mod clahe;
mod gray_world;
pub mod hscm;
pub mod ibla;
mod method;
mod rd;
mod rghs;
mod suir;
mod ulap;
#[cfg(test)]
mod vectors;

use imaging::Raster;

use crate::result::{EnhanceError, Enhanced};
use crate::variant::Variant;
pub use method::Method;

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
    .guided()
    .published("median 43 dB to public code of the method on 20 photos; 7 % of the pixels turn red"),
    Method::new(
        "ibla",
        "restoration by blurriness and light absorption (Peng and Cosman 2017)",
        ibla::enhance,
    )
    .guided()
    .published(
        "its definition in f64 reproduces 45 of the 45 results published with the photos of U45 bit for bit",
    ),
    Method::new(
        "ibla_guided",
        "IBLA refined by the guided filter, which is faster",
        ibla::enhance_guided,
    )
    .guided()
    .published("median 34.5 dB to the results published with the 45 photos of U45, 5 of them below 17 dB")
    .away(1.7e-1),
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

/// Names of all methods for [`Method::parse`].
pub const METHODS: &[&str] = &{
    let mut names = [""; TABLE.len()];
    let mut row = 0;
    while row < names.len() {
        names[row] = TABLE[row].name;
        row += 1;
    }
    names
};

/// Limit of the methods with a color guided filter, which hold several f64 planes.
const GUIDED_PIXELS_MAX: usize = 16_000_000;

impl Method {
    const fn new(name: &'static str, about: &'static str, enhance: fn(&Raster, Variant) -> Enhanced) -> Self {
        Self {
            name,
            about,
            pixels_max: None,
            published: None,
            distance: 0.0,
            enhance,
        }
    }

    /// With the pixel limit of the guided filter.
    const fn guided(self) -> Self {
        Self {
            pixels_max: Some(GUIDED_PIXELS_MAX),
            ..self
        }
    }

    /// With a measured distance from its authors' results.
    const fn published(self, distance: &'static str) -> Self {
        Self {
            published: Some(distance),
            ..self
        }
    }

    /// As a faster variant at this distance from another method.
    const fn away(self, distance: f64) -> Self {
        Self { distance, ..self }
    }

    /// Returns the method of this name.
    #[must_use]
    pub fn parse(name: &str) -> Option<Self> {
        TABLE.into_iter().find(|method| method.name == name)
    }

    /// The name that [`Method::parse`] reads.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Short description and source.
    #[must_use]
    pub fn about(&self) -> &'static str {
        self.about
    }

    /// Distance of a faster variant from its exact method, 0 for all other methods: the 95 % quantile over rendered
    /// frames of the RMS difference in linear light, as measured by `fathom-lab ibla`.
    #[must_use]
    pub fn distance(&self) -> f64 {
        self.distance
    }

    /// Distance from its authors' published results, as a sentence without its full stop. It was measured for the
    /// definition in f64; the fast variant follows that within the tolerances of the `agreement` tests.
    #[must_use]
    pub fn against_published(&self) -> &'static str {
        self.published
            .unwrap_or("not measured against its authors' results")
    }
}

/// Enhances one picture by the fast variant of a method.
///
/// # Errors
/// [`EnhanceError::Empty`] for a picture without pixels; [`EnhanceError::TooLarge`] beyond the method's limit.
pub fn run(method: &Method, picture: &Raster) -> Result<Enhanced, EnhanceError> {
    run_variant(method, picture, Variant::Fast)
}

/// Enhances one picture by the given variant.
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

    #[test]
    fn methods_say_how_far_they_are_from_published_results() {
        let said = |name: &str| Method::parse(name).unwrap().against_published();
        assert!(said("ibla").contains("45 of the 45") && said("ibla").contains("U45"));
        assert!(said("ibla_guided").contains("34.5 dB") && said("ibla_guided").contains("below 17 dB"));
        assert!(said("suir").contains("43 dB") && said("suir").contains("7 %"));
        let measured = METHODS
            .iter()
            .filter(|name| !said(name).starts_with("not measured"));
        assert_eq!(measured.count(), 3);
    }
}
