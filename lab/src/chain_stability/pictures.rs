//! Pictures side by side.

use imaging::{Rgb, Rgb8, transfer};

const GAP_PX: usize = 8;

/// Linear pictures of one size in a row, with white between.
pub(super) fn row(pictures: &[Rgb<f32>]) -> Rgb8 {
    let shown: Vec<Rgb8> = pictures.iter().map(|p| transfer::encode_rgb8(p).0).collect();
    let (width, height) = shown.first().map_or((1, 1), |p| (p.width(), p.height()));
    let step = width + GAP_PX;
    Rgb8::from_fn(step * shown.len() - GAP_PX, height, |x, y| {
        let inside = Some(x % step).filter(|x| *x < width);
        inside.map_or([255; 3], |inside| shown[x / step].pixel(inside, y))
    })
}

/// The difference of two pictures, multiplied by `gain`.
pub(super) fn difference(one: &Rgb<f32>, other: &Rgb<f32>, gain: f32) -> Rgb<f32> {
    Rgb::from_fn(one.width(), one.height(), |x, y| {
        let (a, b) = (one.pixel(x, y), other.pixel(x, y));
        [0, 1, 2].map(|c| gain * (a[c] - b[c]).abs())
    })
}
