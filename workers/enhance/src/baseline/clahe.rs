//! CLAHE alone: the luma equalized in a grid of 8 × 8 tiles with a clip limit of 2 mean bins (Zuiderveld 1994), and the
//! chroma of the input kept, `C' = C + Y' - Y`.

use imaging::{Channels, Raster};

use crate::hscm::{self, Luma, clahe, merge};
use crate::result::{Enhanced, OfGray};

/// Tiles across and down.
pub const GRID: (usize, usize) = (8, 8);
/// Contrast limit, in mean bins.
pub const CLIP_LIMIT: f64 = 2.0;

/// Equalizes a picture of at least one pixel. Gray stays gray; 16 bit is reduced to 8.
#[must_use]
pub(crate) fn enhance(picture: &Raster) -> Enhanced {
    let mut colors = picture.to_rgb8();
    let luma = clahe::clahe(&colors.to_gray8(), GRID, CLIP_LIMIT);
    let warnings = hscm::warnings(&Luma::of(picture), GRID);
    if picture.channels() == Channels::Gray {
        for (pixel, &code) in colors.data_mut().chunks_exact_mut(3).zip(luma.data()) {
            pixel.fill(code);
        }
    } else {
        let merged = merge::merge(colors.data(), luma.data());
        colors.data_mut().copy_from_slice(&merged);
    }
    Enhanced::unmasked(picture, colors, OfGray::Gray, warnings)
}

#[cfg(test)]
mod tests {
    use imaging::{Plane, Samples};

    use super::*;

    #[test]
    fn a_gray_picture_becomes_its_equalized_plane() {
        let gray = Plane::from_fn(40, 24, |x, y| (x + y) as u8);
        let expected = clahe::clahe(&gray, GRID, CLIP_LIMIT);
        let enhanced = enhance(&Raster::from(gray));
        assert_eq!(enhanced.picture.samples(), &Samples::U8(expected.into_data()));
    }
}
