//! A drawn mask. The description contains it, so that every machine renders the same frame.

use std::sync::Arc;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use imaging::Plane;
use imaging::codec::{decode_mask, read_sides};
use serde::Deserialize;
use serde::de::Error;

/// Maximum length of the text. The record of every frame contains it; the outline of a robot at 1920 × 1080 needs 3 KB.
const MAX_TEXT_BYTES: usize = 16 << 10;

/// Maximum pixels of a mask, the largest picture of the masked methods. A small file can hold many equal pixels.
const MAX_PIXELS: usize = 16 << 20;

/// The kept pixels of a picture of one size.
#[derive(Debug, Clone, PartialEq)]
pub struct MaskImage {
    kept: Arc<Plane<u8>>,
}

impl MaskImage {
    /// Reads a gray or black-and-white picture in base64.
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
        Self::decode(&file.map_err(|error| format!("is not base64: {error}"))?)
    }

    /// Decodes a gray picture file without loss: PNG, BMP, TIFF or WebP.
    ///
    /// # Errors
    /// The reason in words.
    pub fn decode(file: &[u8]) -> Result<Self, String> {
        let (width, height) = read_sides(file).ok_or("is not a picture")?;
        if width.saturating_mul(height) > MAX_PIXELS {
            return Err(format!(
                "has {width}×{height} pixels; at most {MAX_PIXELS} are allowed"
            ));
        }
        let codes = decode_mask(file).map_err(|error| format!("cannot be decoded: {error}"))?;
        let kept = codes.map(|&code| if code == 0 { 0 } else { u8::MAX });
        Ok(Self { kept: Arc::new(kept) })
    }

    /// 255 where the picture is kept and 0 elsewhere.
    #[must_use]
    pub fn kept(&self) -> &Plane<u8> {
        &self.kept
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
        assert_eq!(mask.kept().data(), [0, 255, 255]);
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
            let error = MaskImage::parse(&text).unwrap_err();
            assert!(error.contains(reason), "{error}");
        }
        let vast = encode_png(&Plane::filled(5000, 5000, 0u8).into()).unwrap();
        let error = MaskImage::decode(&vast).unwrap_err();
        assert!(error.contains("has 5000×5000 pixels"), "{error}");
    }
}
