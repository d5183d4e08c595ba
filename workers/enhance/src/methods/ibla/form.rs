//! The variants of IBLA, which refine planes by the matting Laplacian or by the guided filter.

use imaging::{Plane, Rgb8};

use super::blurriness::blurriness;
use super::light::BackgroundLight;
use crate::blocks::{Guide, Matting, guided};
use crate::methods::method::Method;
use crate::variant::Variant;

/// Refinement of blurriness, which determines the light, and of closeness, which determines the transmittance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IblaRefinement {
    /// Both by matting: the method `ibla`.
    Matting,
    /// Both by the guided filter: `ibla_guided`.
    Guided,
}

impl IblaRefinement {
    /// The exact variant and the fast one.
    pub const ALL: [Self; 2] = [Self::Matting, Self::Guided];

    /// Name of the method.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Matting => "ibla",
            Self::Guided => "ibla_guided",
        }
    }

    /// Method of this variant.
    #[must_use]
    pub fn method(self) -> Method {
        Method::parse(self.name()).expect("each variant is a method")
    }

    /// Refines blurriness: `P_b`.
    pub(super) fn refined(self, guide: &Guide, plane: &Plane<f64>, variant: Variant) -> Plane<f64> {
        match self {
            Self::Matting => Matting::new(guide, variant).refined(plane),
            Self::Guided => guided(guide, plane, variant),
        }
    }
}

/// The three candidate colors of the background light of a picture of at least one pixel. With refined blurriness
/// `P_b`, small where the picture is blurred, they are in this order
///
/// - the mean color of the thousandth of the pixels with the smallest `P_b`, at least one pixel,
/// - that of the quadtree region with the lowest variance of luma, the same for all variants,
/// - that of the quadtree region with the smallest mean `P_b`,
///
/// each red, green and blue in 0..=1 of the codes.
#[must_use]
pub fn candidates(picture: &Rgb8, form: IblaRefinement, variant: Variant) -> [[f64; 3]; 3] {
    let refined = form.refined(&Guide::new(picture), &blurriness(picture, variant), variant);
    BackgroundLight::new(picture, &refined, variant).candidates
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run_variant;

    #[test]
    fn forms_are_the_methods_of_their_names() {
        let picture = Rgb8::from_fn(60, 40, |x, y| {
            [(x * 3) as u8, (y * 5) as u8, ((x * y) % 97) as u8]
        });
        let raster = picture.clone().into();
        let results = IblaRefinement::ALL.map(|form| {
            let result = run_variant(&form.method(), &raster, Variant::Fast).unwrap();
            assert_eq!(result, super::super::restored(&raster, Variant::Fast, form));
            result
        });
        assert_ne!(results[0], results[1]);
        let [matting, guided] = IblaRefinement::ALL.map(|form| candidates(&picture, form, Variant::Fast));
        assert_eq!(matting[1], guided[1]);
        assert!(
            guided
                .as_flattened()
                .iter()
                .all(|value| (0.0..=1.0).contains(value))
        );
    }
}
