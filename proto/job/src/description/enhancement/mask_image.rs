//! A drawn mask. The description contains it, so that every machine renders the same frame.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use imaging::Plane;
use imaging::codec::{decode_mask, read_sides};
use serde::Deserialize;
use serde::de::Error;

/// Maximum length of the text. The record of every frame contains it; the outline of a robot at 1920 × 1080 needs 3 KB.
const MAX_TEXT_BYTES: usize = 16 << 10;

/// Maximum pixels of a mask. A small file can hold many equal pixels, and every frame decodes it.
const MAX_PIXELS: usize = 16 << 20;

/// The file of a drawn mask. Its pixels are decoded where a frame is enhanced: a description is read far more often.
#[derive(Debug, Clone, PartialEq)]
pub struct MaskImage {
    file: Vec<u8>,
}

impl MaskImage {
    /// Reads base64 of a file, without decoding it.
    ///
    /// # Errors
    /// The reason in words.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        if text.len() > MAX_TEXT_BYTES {
            let bytes = text.len();
            return Err(format!(
                "has {bytes} bytes of base64; at most {MAX_TEXT_BYTES} are allowed: write it as PNG with 1 bit per pixel"
            ));
        }
        let file = STANDARD.decode(text);
        let file = file.map_err(|error| format!("is not base64: {error}"))?;
        Ok(Self { file })
    }

    /// A mask that can be decoded, from a gray picture file without loss: PNG, BMP, TIFF or WebP.
    ///
    /// # Errors
    /// As [`Self::decode`].
    pub fn from_file(file: Vec<u8>) -> Result<Self, String> {
        let mask = Self { file };
        mask.decode().map(|_| mask)
    }

    /// 255 where the picture is kept and 0 elsewhere.
    ///
    /// # Errors
    /// The reason in words.
    pub fn decode(&self) -> Result<Plane<u8>, String> {
        let (width, height) = read_sides(&self.file).ok_or("is not a picture")?;
        if width.saturating_mul(height) > MAX_PIXELS {
            return Err(format!(
                "has {width}×{height} pixels; at most {MAX_PIXELS} are allowed"
            ));
        }
        let codes = decode_mask(&self.file).map_err(|error| format!("cannot be decoded: {error}"))?;
        Ok(codes.map(|&code| if code == 0 { 0 } else { u8::MAX }))
    }

    /// Columns and rows, if the file is a picture.
    pub(crate) fn sides(&self) -> Option<(usize, usize)> {
        read_sides(&self.file)
    }
}

impl<'de> Deserialize<'de> for MaskImage {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        Self::parse(&text).map_err(|why| D::Error::custom(format!("the mask {why}")))
    }
}

#[cfg(test)]
mod tests {
    use imaging::codec::encode_png;

    use super::*;

    fn written(plane: Plane<u8>) -> String {
        STANDARD.encode(encode_png(&plane.into()).unwrap())
    }

    #[test]
    fn black_pixels_are_removed() {
        let drawn = Plane::new(3, 1, vec![0u8, 1, 255]).unwrap();
        let mask = MaskImage::parse(&written(drawn)).unwrap();
        assert_eq!(mask.decode().unwrap().data(), [0, 255, 255]);
    }

    #[test]
    fn what_is_no_mask_is_refused_with_the_reason() {
        let whole = written(Plane::filled(40, 30, 255u8));
        let noise = Plane::from_fn(200, 200, |x, y| ((x * 7919 + y * 104_729) % 251) as u8);
        let cases = [
            ("%".to_owned(), "is not base64"),
            (STANDARD.encode("a text"), "is not a picture"),
            (whole[..whole.len() / 8 * 4].to_owned(), "cannot be decoded"),
            (written(noise), "at most 16384 are allowed"),
        ];
        for (text, reason) in cases {
            let error = MaskImage::parse(&text)
                .and_then(|mask| mask.decode())
                .unwrap_err();
            assert!(error.contains(reason), "{error}");
        }
        let vast = encode_png(&Plane::filled(5000, 5000, 0u8).into()).unwrap();
        let error = MaskImage::from_file(vast).unwrap_err();
        assert!(error.contains("has 5000×5000 pixels"), "{error}");
    }
}
