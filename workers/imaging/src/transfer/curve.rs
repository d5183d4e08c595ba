//! The transfer curve, value by value.

/// End of the linear part of the curve, encoded and in light; and its slope.
pub(super) const DARK_ENCODED: f64 = 0.040_45;

pub(super) const DARK_LIGHT: f64 = DARK_ENCODED / SLOPE;

pub(super) const SLOPE: f64 = 12.92;

/// Linear light of an sRGB-encoded value; the linear part extends below 0, the curve above 1.
#[must_use]
pub fn decode(v: f64) -> f64 {
    if v <= DARK_ENCODED {
        v / SLOPE
    } else {
        decode_bright(v)
    }
}

/// sRGB-encoded value of linear light; the inverse of [`decode`].
#[must_use]
pub fn encode(l: f64) -> f64 {
    if l <= DARK_LIGHT {
        l * SLOPE
    } else {
        encode_bright(l)
    }
}

pub(super) fn decode_bright(v: f64) -> f64 {
    libm::pow((v + 0.055) / 1.055, 2.4)
}

pub(super) fn encode_bright(l: f64) -> f64 {
    1.055 * libm::pow(l, 1.0 / 2.4) - 0.055
}
