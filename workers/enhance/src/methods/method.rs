//! A method of enhancement with its parameters.

use spec::{Enhancement, Ibla, IblaRefinement, Step};

/// Limit of the methods that hold several f64 planes or a dozen f32 ones.
const PLANES_PIXELS_MAX: usize = 16_000_000;

/// Distance of IBLA refined by the guided filter from IBLA refined by matting: the 95 % quantile over rendered frames of the
/// RMS difference in linear light, as measured by `fathom-lab ibla`.
pub const IBLA_GUIDED_DISTANCE: f64 = 1.7e-1;

/// A method with its parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Method(pub Step);

impl Method {
    /// The method of this name with its defaults.
    #[must_use]
    pub fn parse(name: &str) -> Option<Self> {
        Enhancement::of_method(name)?.steps.pop().map(Self)
    }

    /// IBLA with this refinement and defaults otherwise.
    #[must_use]
    pub fn ibla(refine: IblaRefinement) -> Self {
        Self(Step::Ibla(Ibla {
            refine,
            ..Ibla::default()
        }))
    }

    /// The name that [`Method::parse`] reads.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.0.name()
    }

    /// Short description and source.
    #[must_use]
    pub fn about(&self) -> &'static str {
        self.0.about()
    }

    /// Pixel limit; `None` if only memory limits it.
    pub(super) fn pixels_max(&self) -> Option<usize> {
        match self.0 {
            Step::Ulap(_)
            | Step::Suir(_)
            | Step::Ibla(_)
            | Step::Dcp(_)
            | Step::Udcp(_)
            | Step::Fusion(_)
            | Step::Mlle(_) => Some(PLANES_PIXELS_MAX),
            Step::Hscm(_)
            | Step::Clahe(_)
            | Step::GrayWorld(_)
            | Step::Rd(_)
            | Step::Rghs(_)
            | Step::Onnx(_) => None,
        }
    }

    /// Distance from its authors' published results, as a sentence without its full stop. It was measured with the
    /// defaults for the definition in f64; the fast variant follows that within the tolerances of the `agreement` tests.
    #[must_use]
    pub fn against_published(&self) -> &'static str {
        match &self.0 {
            Step::Suir(_) => {
                "median 43 dB to public code of the method on 20 photos; 7 % of the pixels turn red"
            }
            Step::Ibla(ibla) if ibla.refine == IblaRefinement::Guided => {
                "median 34.5 dB to the results published with the 45 photos of U45, 5 of them below 17 dB"
            }
            Step::Ibla(_) => {
                "its definition in f64 reproduces 45 of the 45 results published with the photos of U45 bit for bit"
            }
            Step::Dcp(_) => {
                "not measured against its authors' results; median 30 dB to a public program on 5 pictures"
            }
            Step::Udcp(_) => {
                "not measured against its authors' results; median 32 dB to a public program on 5 pictures"
            }
            Step::Fusion(_) => {
                "not measured against its authors' results; median 38 dB to a public program on 5 pictures"
            }
            Step::Mlle(_) => {
                "not measured against its authors' results; median 35 dB to a public program on 5 pictures"
            }
            _ => "not measured against its authors' results",
        }
    }
}

#[cfg(test)]
mod tests {
    use spec::METHODS;

    use super::*;

    #[test]
    fn every_listed_method_parses_to_its_own_name() {
        for name in METHODS {
            let method = Method::parse(name).unwrap();
            assert_eq!(method.name(), *name);
            assert!(!method.about().is_empty());
        }
        assert_eq!(Method::parse("HSCM"), None);
    }

    #[test]
    fn methods_say_how_far_they_are_from_published_results() {
        let said = |name: &str| Method::parse(name).unwrap().against_published();
        assert!(said("ibla").contains("45 of the 45") && said("ibla").contains("U45"));
        let guided = Method::ibla(IblaRefinement::Guided);
        assert!(guided.against_published().contains("34.5 dB"));
        assert!(said("suir").contains("43 dB") && said("suir").contains("7 %"));
        assert!(said("hscm").starts_with("not measured"));
    }
}
