//! The style blend of Algorithm 1: `I_α = α M + (1 − α) F` in sRGB-encoded values, M the styled picture.

use imaging::{Rgb, transfer};

/// Blends a styled picture (sRGB-encoded, 0..=1) into a linear one and returns linear light. α is clamped to 0..=1: 0 keeps the
/// linear picture, 1 the styled one. A styled picture larger than the frame (a network that pads) is cropped from the top left.
///
/// # Panics
/// When the styled picture is smaller than the frame.
#[must_use]
pub fn style_blend(linear: &Rgb<f32>, styled: &Rgb<f32>, alpha: f64) -> Rgb<f32> {
    let alpha = if alpha.is_nan() {
        0.0
    } else {
        alpha.clamp(0.0, 1.0)
    };
    if alpha == 0.0 {
        return linear.clone();
    }
    let (width, height) = linear.size();
    assert!(
        styled.width() >= width && styled.height() >= height,
        "the styled picture covers the frame"
    );
    let alpha = alpha as f32;
    let mut encoded = transfer::encode_unit(linear);
    for (plane, styled) in encoded.planes_mut().into_iter().zip(styled.planes()) {
        for (y, row) in plane.chunks_exact_mut(width).enumerate() {
            for (sample, styled) in row.iter_mut().zip(styled.row(y)) {
                *sample = alpha * styled.clamp(0.0, 1.0) + (1.0 - alpha) * *sample;
            }
        }
    }
    transfer::decode_unit(&encoded)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alpha_weights_the_styled_picture() {
        let linear = Rgb::from_fn(1, 1, |_, _| [0.0f32; 3]);
        let styled = Rgb::from_fn(2, 2, |x, y| [if x + y == 0 { 1.0f32 } else { 0.0 }; 3]);
        assert_eq!(style_blend(&linear, &styled, 0.0), linear);
        assert_eq!(style_blend(&linear, &styled, 1.0).pixel(0, 0), [1.0; 3]);
        let half = style_blend(&linear, &styled, 0.5).pixel(0, 0)[0];
        assert!((f64::from(half) - transfer::decode(0.5)).abs() < 1e-6);
    }
}
