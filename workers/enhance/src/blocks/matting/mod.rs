//! Refinement of a plane by the matting Laplacian of a picture (Levin, Lischinski and Weiss 2008, "A closed-form
//! solution to natural image matting", eq. 12).
//!
//! `x` solves `(L + λ E) x = λ p`: close to `p`, and in each window of 3 × 3 pixels nearly an affine function of the
//! colors. `L` is the sum over all complete windows k of `δ_ij - (1 + (I_i - μ_k)ᵀ V_k⁻¹ (I_j - μ_k)) / 9`; I colors,
//! μ_k their mean, V_k their covariance with 1e-7/9 on its diagonal. Rows of `L` sum to 0, so constants are preserved.
//!
//! The smallest eigenvalue of the system is λ: if the residual is a share s of `λ p`, the RMS error of `x` is at most s
//! times the RMS of `p`.

mod chebyshev;
mod cholesky;
mod front;
mod gradients;
mod laplacian;
mod tile;
mod windows;

use std::iter::zip;

use imaging::Plane;

use super::guided::{Guide, guided};
use crate::variant::Variant;
use chebyshev::System;
use cholesky::CholeskyFactor;
use laplacian::Laplacian;

/// Pictures of this many pixels or more use the larger λ.
const LARGE: usize = 180_000;
/// λ below and from [`LARGE`] on.
const CLOSENESS: [f64; 2] = [1e-5, 1e-2];
/// Final residual of the reference iteration relative to the right-hand side.
const REFERENCE_RESIDUAL: f64 = 1e-9;
/// Final residual of large pictures: the RMS error of `x` is at most this share of the RMS of `p`.
const LARGE_RESIDUAL: f64 = 1e-3;

/// The system of a picture, prepared for several planes.
pub struct Matting<'g> {
    guide: &'g Guide,
    closeness: f64,
    solver: Solver,
}

/// A guessed plane and its refinement; `None` if guessing does not pay.
pub struct Ahead(Option<[Plane<f64>; 2]>);

enum Solver {
    /// A side below 3: there is no complete window.
    Nothing,
    /// The reference: conjugate gradients in f64.
    Gradients(Laplacian),
    /// Large pictures: faster steps in f32.
    Chebyshev(System),
    /// Small λ, where the iteration would need thousands of steps: factorized once for all planes.
    Factored(CholeskyFactor),
}

impl<'g> Matting<'g> {
    /// Prepares the system of a guide, from its codes only.
    #[must_use]
    pub fn new(guide: &'g Guide, variant: Variant) -> Self {
        let (width, height) = guide.channels()[0].size();
        let is_large = width * height >= LARGE;
        let closeness = CLOSENESS[usize::from(is_large)];
        let channels = guide.channels();
        let solver = match variant {
            _ if width < 3 || height < 3 => Solver::Nothing,
            Variant::Reference => Solver::Gradients(Laplacian::new(channels)),
            Variant::Fast if is_large => Solver::Chebyshev(System::new(channels, closeness)),
            Variant::Fast => Solver::Factored(CholeskyFactor::new(&Laplacian::new(channels), closeness)),
        };
        Self {
            guide,
            closeness,
            solver,
        }
    }

    /// Refines a plane of the picture's size.
    ///
    /// # Panics
    /// If the sizes differ.
    #[must_use]
    pub fn refined(&self, plane: &Plane<f64>) -> Plane<f64> {
        let [refined] = self.solved([plane], LARGE_RESIDUAL);
        refined
    }

    /// Refines a plane and, if planes share their steps, an approximately known second one from which
    /// [`Self::refined_near`] continues.
    ///
    /// # Panics
    /// If the sizes differ.
    #[must_use]
    pub fn refined_beside(
        &self,
        plane: &Plane<f64>,
        guess: impl FnOnce() -> Plane<f64>,
    ) -> (Plane<f64>, Ahead) {
        if !matches!(self.solver, Solver::Chebyshev(_)) {
            return (self.refined(plane), Ahead(None));
        }
        let guess = guess();
        let [refined, start] = self.solved([plane, &guess], LARGE_RESIDUAL);
        (refined, Ahead(Some([guess, start])))
    }

    /// Refines the guessed plane. Only its difference from the guess is solved for, to a residual of at most twice that
    /// of [`Self::refined`].
    ///
    /// # Panics
    /// If the sizes differ.
    #[must_use]
    pub fn refined_near(&self, plane: &Plane<f64>, ahead: Ahead) -> Plane<f64> {
        let Some([mut change, mut refined]) = ahead.0 else {
            return self.refined(plane);
        };
        zip(change.data_mut(), plane.data()).for_each(|(guess, value)| *guess = value - *guess);
        let residual = LARGE_RESIDUAL * deviation(plane) / deviation(&change);
        if residual < 1.0 {
            let [change] = self.solved([&change], residual);
            zip(refined.data_mut(), change.data()).for_each(|(value, change)| *value += change);
        }
        refined
    }

    fn solved<const N: usize>(&self, planes: [&Plane<f64>; N], residual: f64) -> [Plane<f64>; N] {
        let size = self.guide.channels()[0].size();
        assert!(
            planes.iter().all(|plane| plane.size() == size),
            "the planes have the picture's size"
        );
        match &self.solver {
            Solver::Nothing => planes.map(Plane::clone),
            Solver::Gradients(laplacian) => planes.map(|plane| {
                let start = guided(self.guide, plane, Variant::Reference);
                gradients::solved(laplacian, self.closeness, plane, &start, REFERENCE_RESIDUAL)
            }),
            Solver::Chebyshev(system) => system.solved(planes, residual),
            Solver::Factored(factor) => {
                planes.map(|plane| factor.solved(plane.map(|value| self.closeness * value)))
            }
        }
    }
}

/// The root of the sum of squared distances from the mean.
fn deviation(plane: &Plane<f64>) -> f64 {
    let mean = plane.data().iter().sum::<f64>() / plane.data().len() as f64;
    let squares = plane.data().iter().map(|value| (value - mean) * (value - mean));
    squares.sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use imaging::Rgb8;

    use super::*;

    const VARIANTS: [Variant; 2] = [Variant::Fast, Variant::Reference];

    fn textured(width: usize, height: usize) -> Rgb8 {
        Rgb8::from_fn(width, height, |x, y| {
            let edge = if 3 * x > 2 * y + 9 { 90 } else { 20 };
            [
                edge + (x * y % 7) as u8,
                edge + (5 * x % 11) as u8,
                60 + (3 * y % 13) as u8,
            ]
        })
    }

    fn plane(width: usize, height: usize) -> Plane<f64> {
        Plane::from_fn(width, height, |x, y| ((7 * x + 3 * y * y) % 17) as f64 / 17.0)
    }

    #[test]
    fn a_constant_comes_back_and_small_pictures_stay() {
        for (width, height) in [(1, 1), (2, 9), (3, 3), (40, 31)] {
            let guide = Guide::new(&textured(width, height));
            for variant in VARIANTS {
                let matting = Matting::new(&guide, variant);
                for value in matting.refined(&Plane::filled(width, height, 0.7)).data() {
                    assert!(
                        (value - 0.7).abs() < 1e-6,
                        "{width}×{height} {variant:?}: {value}"
                    );
                }
            }
        }
        let plane = plane(2, 9);
        let guide = Guide::new(&textured(2, 9));
        assert_eq!(Matting::new(&guide, Variant::Fast).refined(&plane), plane);
    }

    #[test]
    fn factors_and_gradients_agree() {
        for (width, height) in [(3, 3), (5, 4), (9, 30), (41, 37), (64, 50)] {
            let guide = Guide::new(&textured(width, height));
            let plane = plane(width, height);
            let [fast, reference] = VARIANTS.map(|variant| Matting::new(&guide, variant).refined(&plane));
            let squares = fast
                .data()
                .iter()
                .zip(reference.data())
                .map(|(a, b)| (a - b).powi(2));
            let error = (squares.sum::<f64>() / plane.data().len() as f64).sqrt();
            assert!(error < 1e-7, "{width}×{height}: {error}");
        }
    }

    /// Largest error of a large picture relative to the range of `p`, which is 1 here.
    const LARGE_AGREEMENT: f64 = 2e-3;

    #[test]
    fn large_pictures_agree_with_the_reference_as_far_as_their_residual_says() {
        let (width, height) = (533, 347);
        let noise = |x: usize, y: usize| (x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca6b)) >> 7;
        let contents: [(&str, Rgb8); 3] = [
            ("texture", textured(width, height)),
            (
                "flat",
                Rgb8::from_fn(width, height, |x, _| {
                    if x < 200 { [60, 120, 140] } else { [61, 120, 140] }
                }),
            ),
            (
                "noise",
                Rgb8::from_fn(width, height, |x, y| {
                    [noise(x, y) as u8, noise(y, x) as u8, noise(x + y, x) as u8]
                }),
            ),
        ];
        for (name, picture) in contents {
            let guide = Guide::new(&picture);
            let plane = plane(width, height);
            let [fast, reference] = VARIANTS.map(|variant| Matting::new(&guide, variant).refined(&plane));
            let errors = fast
                .data()
                .iter()
                .zip(reference.data())
                .map(|(a, b)| (a - b).abs());
            let (squares, most) =
                errors.fold((0.0, 0.0f64), |(squares, most), e| (squares + e * e, most.max(e)));
            let rms = (squares / plane.data().len() as f64).sqrt();
            assert!(
                rms < LARGE_RESIDUAL && most < LARGE_AGREEMENT,
                "{name}: {rms:e}, {most:e}"
            );
        }
    }

    #[test]
    fn a_guess_however_wrong_leads_to_the_plane() {
        let (width, height) = (533, 347);
        let guide = Guide::new(&textured(width, height));
        let matting = Matting::new(&guide, Variant::Fast);
        let (first, second) = (
            plane(width, height),
            plane(width, height).map(|value| value * value),
        );
        let expected = [&first, &second].map(|plane| matting.refined(plane));
        for wrong in [0.0, 1e-4, 0.03, 1.0] {
            let guess = || {
                Plane::from_fn(width, height, |x, y| {
                    second.pixel(x, y) + wrong * first.pixel(y, x / 2)
                })
            };
            let (beside, ahead) = matting.refined_beside(&first, guess);
            let near = matting.refined_near(&second, ahead);
            for (got, expected) in [beside, near].iter().zip(&expected) {
                let errors = zip(got.data(), expected.data()).map(|(a, b)| (a - b).abs());
                let most = errors.fold(0.0, f64::max);
                assert!(most < LARGE_AGREEMENT, "{wrong}: {most:e}");
            }
        }
    }

    #[test]
    fn gray_pictures_and_two_colors_are_no_exception() {
        let gray = Rgb8::from_fn(50, 41, |x, y| [((x * 5 + y * y) % 256) as u8; 3]);
        let two = Rgb8::from_fn(
            50,
            41,
            |x, y| if (x * y) % 3 == 0 { [0; 3] } else { [255, 0, 255] },
        );
        for picture in [gray, two] {
            let guide = Guide::new(&picture);
            let [fast, reference] =
                VARIANTS.map(|variant| Matting::new(&guide, variant).refined(&plane(50, 41)));
            for (fast, reference) in fast.data().iter().zip(reference.data()) {
                assert!((fast - reference).abs() < 1e-6, "{fast} for {reference}");
            }
        }
    }

    #[test]
    fn of_one_color_the_plane_becomes_smooth() {
        let guide = Guide::new(&Rgb8::from_fn(24, 24, |_, _| [60, 120, 140]));
        let plane = plane(24, 24);
        let mean = plane.data().iter().sum::<f64>() / plane.data().len() as f64;
        for variant in VARIANTS {
            let refined = Matting::new(&guide, variant).refined(&plane);
            assert!(refined.data().iter().all(|value| (value - mean).abs() < 0.05));
        }
    }
}
