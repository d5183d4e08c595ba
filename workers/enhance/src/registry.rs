//! The list of all methods.

use crate::hscm;
use crate::method::Method;

/// One row of the registry.
#[derive(Debug)]
pub struct MethodInfo {
    /// As a job names it and as [`Method::parse`] reads it.
    pub name: &'static str,
    /// What it does, in a line.
    pub what: &'static str,
    /// Where it comes from.
    pub source: &'static str,
    /// Its default options, in words.
    pub options: &'static str,
    /// Most pixels of a picture; `None` where only memory limits it.
    pub pixels_max: Option<usize>,
    pub(crate) default: fn() -> Method,
}

/// All methods.
#[must_use]
pub fn registry() -> &'static [MethodInfo] {
    REGISTRY
}

/// Names of all methods, in the order of the registry.
pub const METHODS: &[&str] = &names();

const fn names() -> [&'static str; REGISTRY.len()] {
    let mut names = [""; REGISTRY.len()];
    let mut row = 0;
    while row < names.len() {
        names[row] = REGISTRY[row].name;
        row += 1;
    }
    names
}

/// Most pixels for the methods with a color guided filter, which hold several planes in double precision.
pub const GUIDED_PIXELS_MAX: usize = 16_000_000;

/// Options of the guided filter, for the methods that use it.
const GUIDED: &str = "guided filter radius 50, eps 0.001";

const REGISTRY: &[MethodInfo] = &[
    MethodInfo {
        name: "hscm",
        what: "homomorphic filter, median, CLAHE, colour merge, circular mask",
        source: "Oppenheim, Schafer and Stockham 1968 (filter); Zuiderveld 1994 (CLAHE)",
        options: "r_high 2.5, r_low 0.5, cutoff 32, eps 0.01, median 5, clip_limit 2, grid 8x8, circle (0.45, 0.33, 0.44)",
        pixels_max: None,
        default: || Method::Hscm(hscm::Options::default()),
    },
    MethodInfo {
        name: "clahe",
        what: "contrast-limited adaptive histogram equalisation of the luma, chroma kept",
        source: "Zuiderveld 1994",
        options: "clip_limit 2, grid 8x8",
        pixels_max: None,
        default: || Method::Clahe,
    },
    MethodInfo {
        name: "grey_world",
        what: "each channel scaled so that all means are equal",
        source: "Buchsbaum 1980",
        options: "none",
        pixels_max: None,
        default: || Method::GrayWorld,
    },
    MethodInfo {
        name: "ulap",
        what: "restoration: distance from the loss of red, background light, inverted image model",
        source: "Song, Wang, Huang and Tjondronegoro 2018",
        options: GUIDED,
        pixels_max: Some(GUIDED_PIXELS_MAX),
        default: || Method::Ulap,
    },
    MethodInfo {
        name: "suir",
        what: "restoration: green and blue dehazed, red balanced, exposure of the input kept",
        source: "Li, Cong, Pang and Wang 2016",
        options: GUIDED,
        pixels_max: Some(GUIDED_PIXELS_MAX),
        default: || Method::Suir,
    },
    MethodInfo {
        name: "ibla",
        what: "restoration: distance from blurriness and the loss of red, background light, inverted image model",
        source: "Peng and Cosman 2017",
        options: GUIDED,
        pixels_max: Some(GUIDED_PIXELS_MAX),
        default: || Method::Ibla,
    },
    MethodInfo {
        name: "rd",
        what: "channel means drawn together, channels stretched to Rayleigh distributions in two halves, saturation and value",
        source: "Abdul Ghani and Mat Isa 2014",
        options: "alpha 0.4, saturation and value tails 1 %",
        pixels_max: None,
        default: || Method::Rd,
    },
    MethodInfo {
        name: "rghs",
        what: "green and blue raised, channels stretched relative to their modes, lightness and colours in CIE Lab",
        source: "Huang, Wang, Song, Sequeira and Mavromatis 2018",
        options: "channel tails 0.5 %, lightness tails 1 %",
        pixels_max: None,
        default: || Method::Rghs,
    },
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_listed_method_parses_to_its_own_name() {
        for (name, info) in METHODS.iter().zip(registry()) {
            assert_eq!(*name, info.name);
            assert_eq!(Method::parse(name).map(|method| method.name()), Some(*name));
        }
        assert_eq!(Method::parse("HSCM"), None);
    }
}
