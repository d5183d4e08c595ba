//! A picture to draw on. Text uses an embedded bitmap font, so the machine needs no font file.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};
use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendTextStyle, DrawingBackend, DrawingErrorKind, FontTransform,
};

use super::Never;

const HEIGHT: RasterHeight = RasterHeight::Size16;

pub(crate) struct Canvas<'a> {
    width: usize,
    height: usize,
    data: &'a mut [u8],
}

impl<'a> Canvas<'a> {
    /// A canvas over the interleaved samples of a picture of this size.
    pub(crate) fn new(width: usize, height: usize, data: &'a mut [u8]) -> Self {
        Self { width, height, data }
    }

    /// Mixes a color into a pixel; ignores pixels outside the picture.
    fn mix(&mut self, (x, y): BackendCoord, (r, g, b): (u8, u8, u8), weight: f64) {
        let inside = |v: i32, n: usize| usize::try_from(v).ok().filter(|&v| v < n);
        if let (Some(x), Some(y)) = (inside(x, self.width), inside(y, self.height)) {
            let at = 3 * (y * self.width + x);
            for (sample, new) in self.data[at..at + 3].iter_mut().zip([r, g, b]) {
                let mixed = f64::from(*sample) + weight * (f64::from(new) - f64::from(*sample));
                *sample = mixed.round() as u8;
            }
        }
    }
}

/// The glyph of a character, or a substitute if the font lacks it.
fn glyph(character: char) -> Option<noto_sans_mono_bitmap::RasterizedChar> {
    let plain = match character {
        '·' | '×' => 'x',
        '−' | '–' | '—' => '-',
        'µ' => 'u',
        'Δ' => 'd',
        other => other,
    };
    get_raster(plain, FontWeight::Regular, HEIGHT).or_else(|| get_raster('?', FontWeight::Regular, HEIGHT))
}

fn advance() -> i32 {
    get_raster_width(FontWeight::Regular, HEIGHT) as i32
}

impl DrawingBackend for Canvas<'_> {
    type ErrorType = Never;

    fn get_size(&self) -> (u32, u32) {
        (self.width as u32, self.height as u32)
    }

    fn ensure_prepared(&mut self) -> Result<(), DrawingErrorKind<Never>> {
        Ok(())
    }

    fn present(&mut self) -> Result<(), DrawingErrorKind<Never>> {
        Ok(())
    }

    fn draw_pixel(
        &mut self,
        point: BackendCoord,
        color: BackendColor,
    ) -> Result<(), DrawingErrorKind<Never>> {
        self.mix(point, color.rgb, color.alpha);
        Ok(())
    }

    fn estimate_text_size<S: BackendTextStyle>(
        &self,
        text: &str,
        _: &S,
    ) -> Result<(u32, u32), DrawingErrorKind<Never>> {
        Ok((
            text.chars().count() as u32 * advance() as u32,
            HEIGHT.val() as u32,
        ))
    }

    fn draw_text<S: BackendTextStyle>(
        &mut self,
        text: &str,
        style: &S,
        (x, y): BackendCoord,
    ) -> Result<(), DrawingErrorKind<Never>> {
        let (width, height) = (text.chars().count() as i32 * advance(), HEIGHT.val() as i32);
        let left = match style.anchor().h_pos {
            HPos::Left => 0,
            HPos::Center => -width / 2,
            HPos::Right => -width,
        };
        let top = match style.anchor().v_pos {
            VPos::Top => 0,
            VPos::Center => -height / 2,
            VPos::Bottom => -height,
        };
        let color = style.color();
        for (index, character) in text.chars().enumerate() {
            let Some(glyph) = glyph(character) else { continue };
            for (row, line) in glyph.raster().iter().enumerate() {
                for (column, &cover) in line.iter().enumerate() {
                    let u = left + index as i32 * advance() + column as i32;
                    let v = top + row as i32;
                    let (du, dv) = match style.transform() {
                        FontTransform::None => (u, v),
                        FontTransform::Rotate90 => (-v, u),
                        FontTransform::Rotate180 => (-u, -v),
                        FontTransform::Rotate270 => (v, -u),
                    };
                    if cover > 0 {
                        self.mix(
                            (x + du, y + dv),
                            color.rgb,
                            color.alpha * f64::from(cover) / 255.0,
                        );
                    }
                }
            }
        }
        Ok(())
    }
}
