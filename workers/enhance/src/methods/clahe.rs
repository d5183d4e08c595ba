//! CLAHE only: the luma equalized as in HSCM (Zuiderveld 1994), with the chroma of the input, `C' = C + Y' - Y`.

use imaging::Raster;
use spec::Clahe;

use super::hscm::{self, Luma, clahe};
use crate::result::{Enhanced, raster};

/// Equalizes a picture of at least one pixel. Gray stays gray; 16 bit is reduced to 8.
#[must_use]
pub(super) fn enhance(picture: &Raster, parameters: &Clahe) -> Enhanced {
    let luma = clahe::clahe(&picture.to_rgb8().to_gray8(), parameters.tiles, parameters.clip);
    let (channels, codes) = hscm::with_luma(picture, luma);
    Enhanced::new(
        raster(picture, channels, codes),
        hscm::warnings(&Luma::new(picture), parameters.tiles),
    )
}

#[cfg(test)]
mod tests {
    use imaging::{Plane, Samples};

    use super::*;

    #[test]
    fn a_gray_picture_becomes_its_equalized_plane() {
        let gray = Plane::from_fn(40, 24, |x, y| (x + y) as u8);
        let expected = clahe::clahe(&gray, [8, 8], 2.0);
        let enhanced = enhance(&Raster::from(gray), &Clahe::default());
        assert_eq!(enhanced.picture.samples(), &Samples::U8(expected.into_data()));
    }
}
