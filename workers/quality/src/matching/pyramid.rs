//! Gray pictures of decreasing size.
//!
//! Level l has the sides `round(W / 1.2^l)` and `round(H / 1.2^l)` and is interpolated bilinearly from level l - 1 with
//! weights in steps of 1/256. The pyramid has at most eight levels and ends before a level without room for a patch.

use imaging::{Plane, cancel, vectorized};

/// Ratio of the sides of neighboring levels.
pub(crate) const SCALE: f64 = 1.2;
/// Most levels.
pub(crate) const LEVELS: usize = 8;
/// Half the side of the square a feature depends on, at its level: patch of radius 15 and smoothing of radius 3.
pub(crate) const REACH_PX: usize = 18;

/// Steps of an interpolation weight.
const STEPS: f64 = 256.0;

/// The levels, the whole picture first.
pub(crate) fn build(gray: Plane<u8>) -> Vec<Plane<u8>> {
    let (width, height) = gray.size();
    let mut levels = Vec::with_capacity(LEVELS);
    let mut next = Some(gray);
    while let Some(level) = next.take().filter(has_room) {
        levels.push(level);
        if levels.len() < LEVELS {
            let factor = SCALE.powi(levels.len() as i32);
            let [width, height] = [width, height].map(|side| (side as f64 / factor).round() as usize);
            next = Some(resize(&levels[levels.len() - 1], width, height));
        }
    }
    levels
}

fn has_room(level: &Plane<u8>) -> bool {
    level.width().min(level.height()) > 2 * REACH_PX
}

/// Two neighboring samples and the weight of the second in 1/256.
#[derive(Clone, Copy)]
struct Tap {
    first: usize,
    second: usize,
    weight: u16,
}

/// The taps of an axis, pixel centers at half integers, clamped to the edge.
fn taps(from: usize, to: usize) -> Vec<Tap> {
    let ratio = from as f64 / to as f64;
    let tap = |i: usize| {
        let position = ((i as f64 + 0.5) * ratio - 0.5).max(0.0);
        let first = (position as usize).min(from - 1);
        Tap {
            first,
            second: (first + 1).min(from - 1),
            weight: ((position - first as f64) * STEPS).round() as u16,
        }
    };
    (0..to).map(tap).collect()
}

fn resize(source: &Plane<u8>, width: usize, height: usize) -> Plane<u8> {
    let columns = taps(source.width(), width);
    let mut resized = Plane::filled(width, height, 0u8);
    let mut blended = vec![0u16; source.width()];
    for (y, row) in taps(source.height(), height).into_iter().enumerate() {
        cancel::check();
        vectorized!(blend(
            source.row(row.first),
            source.row(row.second),
            row.weight,
            &mut blended
        ));
        for (pixel, column) in resized.row_mut(y).iter_mut().zip(&columns) {
            let (first, second) = (
                u32::from(blended[column.first]),
                u32::from(blended[column.second]),
            );
            let weight = u32::from(column.weight);
            *pixel = ((first * (256 - weight) + second * weight + (1 << 15)) >> 16) as u8;
        }
    }
    resized
}

#[inline(always)]
fn blend(upper: &[u8], lower: &[u8], weight: u16, blended: &mut [u16]) {
    for ((blended, &upper), &lower) in blended.iter_mut().zip(upper).zip(lower) {
        *blended = u16::from(upper) * (256 - weight) + u16::from(lower) * weight;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half a code of rounding, and weights off by 1/512 along two axes of up to 255 codes of contrast.
    const TOLERANCE: f64 = 0.5 + 2.0 * 255.0 / 512.0;

    fn interpolate(source: &Plane<u8>, x: f64, y: f64) -> f64 {
        let [(left, across), (top, down)] =
            [(x, source.width()), (y, source.height())].map(|(position, side)| {
                let position = position.clamp(0.0, side as f64 - 1.0);
                (position.floor() as usize, position.fract())
            });
        let sample = |x: usize, y: usize| {
            f64::from(source.pixel(x.min(source.width() - 1), y.min(source.height() - 1)))
        };
        let upper = sample(left, top) * (1.0 - across) + sample(left + 1, top) * across;
        let lower = sample(left, top + 1) * (1.0 - across) + sample(left + 1, top + 1) * across;
        upper * (1.0 - down) + lower * down
    }

    #[test]
    fn interpolation_agrees_with_its_definition() {
        let source = Plane::from_fn(53, 41, |x, y| (x * x * 7 + y * 31 + x * y * 3) as u8);
        for (width, height) in [(44, 34), (52, 40), (53, 41), (1, 1)] {
            let resized = resize(&source, width, height);
            let (across, down) = (53.0 / width as f64, 41.0 / height as f64);
            for y in 0..height {
                for x in 0..width {
                    let expected = interpolate(
                        &source,
                        (x as f64 + 0.5) * across - 0.5,
                        (y as f64 + 0.5) * down - 0.5,
                    );
                    let difference = (f64::from(resized.pixel(x, y)) - expected).abs();
                    assert!(difference <= TOLERANCE, "{x} {y}: {difference}");
                }
            }
        }
        assert_eq!(resize(&source, 53, 41), source);
    }

    #[test]
    fn levels_end_where_a_patch_has_no_room() {
        let sizes = |width, height| {
            build(Plane::filled(width, height, 9u8))
                .iter()
                .map(Plane::size)
                .collect::<Vec<_>>()
        };
        assert_eq!(
            sizes(768, 492),
            [
                (768, 492),
                (640, 410),
                (533, 342),
                (444, 285),
                (370, 237),
                (309, 198),
                (257, 165),
                (214, 137)
            ]
        );
        assert_eq!(sizes(50, 44), [(50, 44), (42, 37)]);
        assert!(sizes(36, 500).is_empty() && sizes(1, 1).is_empty());
    }
}
