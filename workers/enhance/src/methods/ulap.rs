//! ULAP: restoration by the underwater light attenuation prior (Song, Wang, Huang and Tjondronegoro 2018).
//!
//! 1. `d = 0.53214829 + 0.51309827 max(G, B) - 0.91066194 R`, refined by the guided filter: water absorbs red first, so the
//!    difference grows with distance.
//! 2. Background light `B_c`: the color with the largest R² + G² + B² among the farthest thousandth of the pixels.
//! 3. `D = 10 (norm(d) + d0)`, d0 from [`distance_offset`]; `t_c = N_c^D` with N = (0.83, 0.95, 0.97), clipped to 0.1..=0.9.
//! 4. `J_c = (c - B_c) / t_c + B_c`.
//!
//! Symbols: `c` a channel in 0..=1; `d` relative distance; `N_c` residual energy of a channel per unit of distance.
//!
//! Known failures: a small `t_R` amplifies the remaining red and makes the picture red; in a gray picture d depends on
//! brightness only, so bright counts as distant. A picture of one color is unchanged.

use imaging::{Plane, Raster, vectorized};
use spec::Guided;

use crate::blocks::{Guide, Veil, brightest_of, distance_of, distance_offset, guided, restore};
use crate::result::{Enhanced, OfGray};
use crate::signs::{self, Signs};
use crate::variant::Variant;
use crate::warning::Warning;

/// Residual energy of red, green and blue after a unit of distance.
const RESIDUAL: [f64; 3] = [0.83, 0.95, 0.97];
/// Units of distance between the nearest and the farthest pixel.
const DEPTH: f64 = 10.0;
/// Least and greatest transmittance.
const TRANSMITTANCE: (f64, f64) = (0.1, 0.9);

/// Restores a picture of at least one pixel. The result is colored; 16 bit is reduced to 8.
#[must_use]
pub(crate) fn enhance(picture: &Raster, parameters: &Guided, variant: Variant) -> Enhanced {
    let colors = picture.to_rgb8();
    let mut prior = Plane::filled(colors.width(), colors.height(), 0.0);
    vectorized!(attenuation_prior(colors.data(), prior.data_mut()));
    let distance = guided(&Guide::new(&colors).with_parameters(parameters), &prior, variant);
    drop(prior);
    let light = brightest_of(&colors, &distance, variant).map(|code| f64::from(code) / 255.0);
    let nearest = distance_offset(&colors, light);
    let distance = distance_of(distance, nearest, DEPTH);
    let veil = Veil {
        light,
        attenuation: RESIDUAL.map(|residual| -residual.ln()),
        transmittance: TRANSMITTANCE,
    };
    let restored = restore(&colors, &distance, &veil, variant);
    let others: &[signs::FailureSign] = &[
        (Warning::Gray, Signs::is_gray),
        (Warning::RedCast, Signs::turned_red),
    ];
    let warnings = signs::warnings(&colors, &restored, others);
    Enhanced::from_colors(picture, &restored, OfGray::Color, warnings)
}

/// `d` of step 1.
#[inline(always)]
fn attenuation_prior(codes: &[u8], prior: &mut [f64]) {
    for (value, p) in prior.iter_mut().zip(codes.chunks_exact(3)) {
        *value = 0.532_148_29
            + (0.513_098_27 * f64::from(p[1].max(p[2])) - 0.910_661_94 * f64::from(p[0])) / 255.0;
    }
}

#[cfg(test)]
mod tests {
    use imaging::Rgb8;

    use super::*;

    fn ulap(colors: Rgb8, variant: Variant) -> Rgb8 {
        enhance(&Raster::from(colors), &Guided::default(), variant)
            .picture
            .to_rgb8()
    }

    #[test]
    fn one_color_and_black_come_back() {
        for pixel in [[0; 3], [60, 120, 140], [255; 3]] {
            let picture = Rgb8::from_fn(40, 30, |_, _| pixel);
            for variant in [Variant::Fast, Variant::Reference] {
                assert_eq!(ulap(picture.clone(), variant), picture, "{pixel:?}");
            }
        }
    }

    #[test]
    fn contrast_lost_on_the_way_comes_back() {
        // Dark spots far away, veiled nearly to the color of the water.
        let picture = Rgb8::from_fn(120, 80, |x, y| match (x > 60, (x / 4 + y / 4) % 2) {
            (true, 0) => [30, 110, 120],
            (true, _) => [25, 95, 104],
            (false, 0) => [120, 130, 120],
            (false, _) => [60, 70, 60],
        });
        let restored = ulap(picture.clone(), Variant::Fast);
        let contrast =
            |picture: &Rgb8| i32::from(picture.pixel(81, 41)[1]) - i32::from(picture.pixel(85, 41)[1]);
        assert!(contrast(&restored).abs() > contrast(&picture).abs());
    }
}
