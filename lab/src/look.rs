//! Statistics of pictures that rendered frames and underwater photographs can be compared by.

use std::f64::consts::PI;

use imaging::{Plane, Rgb8, transfer};

use crate::statistics::{mean, median};

/// Side of the blocks for estimating grain, px, and the share of blocks that counts as flat.
const BLOCK_PX: usize = 16;
const FLAT: f64 = 0.2;
/// Minimum share of open water in a picture.
const LEAST_WATER: f64 = 0.02;
/// Width of the compared bands of structures and water along their common outline, px.
const BAND_PX: usize = 14;
/// Fewest pixels of each band.
const LEAST_BAND: usize = 50;
/// Categories that are not structures: open water and seabed.
const OPEN_WATER: u16 = 0;
const SEABED: u16 = 1;

/// The contrast of structures against water; its sign matters.
pub const BRIGHTER: &str = "structures brighter than water, frames";

/// Named values of a picture; `None` if they do not apply.
pub type Values = Vec<(&'static str, Option<f64>)>;

/// Lightness of the picture, of structures against the water next to them, and of the center against the corners, and the share of
/// visible water. `visible` holds the categories that can be seen.
#[must_use]
pub fn measure_lightness(picture: &Rgb8, visible: &Plane<u16>) -> Values {
    let lightness = lightness_plane(picture);
    let water = visible.data().iter().filter(|&&code| code == OPEN_WATER).count();
    vec![
        ("median L*", Some(median(lightness.data().iter().copied()))),
        (BRIGHTER, contrast_at_outline(&lightness, visible)),
        ("center − corners, L*", Some(center_minus_corners(&lightness))),
        (
            "water, % of pixels",
            Some(100.0 * water as f64 / visible.data().len() as f64),
        ),
    ]
}

/// Features of photographs that renderings often lack, with their usual range in photographs: uneven water, daylight, clipped
/// highlights, coarse variation, grain. Code 0 of `semantics` is open water.
#[must_use]
pub fn measure_photograph(picture: &Rgb8, semantics: &Plane<u16>) -> Values {
    let (width, height) = (picture.width(), picture.height());
    let gray = Plane::from_fn(width, height, |x, y| {
        let [r, g, b] = picture.pixel(x, y).map(f64::from);
        0.299 * r + 0.587 * g + 0.114 * b
    });
    let lightness = lightness_plane(picture);
    let water: Vec<f64> = (lightness.data().iter().zip(semantics.data()))
        .filter(|(_, code)| **code == OPEN_WATER)
        .map(|(l, _)| *l)
        .collect();
    let has_water = water.len() as f64 >= LEAST_WATER * (width * height) as f64;
    let band = width * (height / 5);
    let (top, bottom) = (
        &lightness.data()[..band],
        &lightness.data()[width * height - band..],
    );
    let clipped = picture
        .data()
        .chunks_exact(3)
        .filter(|codes| codes.iter().any(|&code| code >= 254));
    let clipped = 100.0 * clipped.count() as f64 / (width * height) as f64;
    vec![
        (
            "spread of L* within water (3 to 8)",
            has_water.then(|| spread(&water)),
        ),
        (
            "top − bottom, L* (by day 5 to 25)",
            Some(mean(top) - mean(bottom)),
        ),
        ("clipped, % (with lamps 0.05 to 4)", Some(clipped)),
        ("entropy, bit (5.6 to 6.9)", Some(entropy(&gray))),
        ("grain, codes (0.4 to 1.2)", Some(grain(&gray))),
    ]
}

fn spread(values: &[f64]) -> f64 {
    let middle = mean(values);
    (values.iter().map(|v| (v - middle).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
}

/// L* of sRGB codes.
fn lightness_plane(picture: &Rgb8) -> Plane<f64> {
    Plane::from_fn(picture.width(), picture.height(), |x, y| {
        let [r, g, b] = picture
            .pixel(x, y)
            .map(|code| transfer::decode(f64::from(code) / 255.0));
        let y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        if y > 216.0 / 24_389.0 {
            116.0 * y.cbrt() - 16.0
        } else {
            24_389.0 / 27.0 * y
        }
    })
}

/// Mean L* of structures minus that of open water within [`BAND_PX`] of each other.
fn contrast_at_outline(lightness: &Plane<f64>, visible: &Plane<u16>) -> Option<f64> {
    let water = visible.map(|&code| code == OPEN_WATER);
    let structure = visible.map(|&code| code != OPEN_WATER && code != SEABED);
    Some(mean_next_to(lightness, &structure, &water)? - mean_next_to(lightness, &water, &structure)?)
}

/// The mean within a mask and [`BAND_PX`] of another; `None` for few pixels.
fn mean_next_to(lightness: &Plane<f64>, mask: &Plane<bool>, other: &Plane<bool>) -> Option<f64> {
    let (width, height) = mask.size();
    let rows = Plane::from_fn(width, height, |x, y| band(x, width).any(|x| other.pixel(x, y)));
    let near = Plane::from_fn(width, height, |x, y| band(y, height).any(|y| rows.pixel(x, y)));
    let pixels = lightness.data().iter().zip(mask.data().iter().zip(near.data()));
    let inside = pixels.filter(|(_, (inside, near))| **inside && **near);
    let inside: Vec<f64> = inside.map(|(l, _)| *l).collect();
    (inside.len() >= LEAST_BAND).then(|| mean(&inside))
}

fn band(position: usize, side: usize) -> std::ops::Range<usize> {
    position.saturating_sub(BAND_PX)..(position + BAND_PX + 1).min(side)
}

/// Mean L* of the middle third of both sides minus that of the four corners of a sixth of the sides.
fn center_minus_corners(lightness: &Plane<f64>) -> f64 {
    let (width, height) = lightness.size();
    let (mut center, mut corners) = (Vec::new(), Vec::new());
    for (x, y) in (0..width * height).map(|index| (index % width, index / width)) {
        // The distance from the middle, from 0 to 1 along each side.
        let [across, down] = [(x, width), (y, height)]
            .map(|(position, side)| ((2 * position + 1) as f64 / side as f64 - 1.0).abs());
        match (across, down) {
            (across, down) if across.max(down) < 1.0 / 3.0 => center.push(lightness.pixel(x, y)),
            (across, down) if across.min(down) > 2.0 / 3.0 => corners.push(lightness.pixel(x, y)),
            _ => {}
        }
    }
    mean(&center) - mean(&corners)
}

fn entropy(gray: &Plane<f64>) -> f64 {
    let mut counts = [0.0f64; 256];
    for v in gray.data() {
        counts[v.round().clamp(0.0, 255.0) as usize] += 1.0;
    }
    let all = gray.data().len() as f64;
    let terms = counts.iter().filter(|&&count| count > 0.0);
    terms.map(|count| -count / all * (count / all).log2()).sum()
}

/// Noise of the flattest blocks, codes, from the mean of an operator that cancels linear gradients (Immerkær 1996).
fn grain(gray: &Plane<f64>) -> f64 {
    let (width, height) = gray.size();
    let mut blocks = Vec::new();
    for top in (1..height.saturating_sub(BLOCK_PX)).step_by(BLOCK_PX) {
        for left in (1..width.saturating_sub(BLOCK_PX)).step_by(BLOCK_PX) {
            let mut sum = 0.0;
            for (x, y) in (0..BLOCK_PX * BLOCK_PX).map(|i| (left + i % BLOCK_PX, top + i / BLOCK_PX)) {
                let rows = [y - 1, y, y + 1].map(|y| &gray.row(y)[x - 1..x + 2]);
                let outer = [rows[0], rows[2]].map(|row| row[0] - 2.0 * row[1] + row[2]);
                let middle = 2.0 * rows[1][0] - 4.0 * rows[1][1] + 2.0 * rows[1][2];
                sum += (outer[0] + outer[1] - middle).abs();
            }
            blocks.push((PI / 2.0).sqrt() / 6.0 * sum / (BLOCK_PX * BLOCK_PX) as f64);
        }
    }
    blocks.sort_by(f64::total_cmp);
    let flat = blocks.get((FLAT * blocks.len() as f64) as usize);
    flat.copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use imaging::random::Stream;

    use super::*;

    fn value(values: &Values, start: &str) -> Option<f64> {
        values.iter().find(|(name, _)| name.starts_with(start)).unwrap().1
    }

    #[test]
    fn white_noise_has_its_grain() {
        let dice = Stream::stage(3, "look");
        let plane = Plane::from_fn(256, 256, |x, y| {
            // A sum of twelve uniform numbers is nearly normal, with standard deviation 1.
            let sum: f64 = (0..12).map(|k| dice.unit((y * 256 + x) as u64, k)).sum();
            100.0 + 2.0 * (sum - 6.0)
        });
        assert!((grain(&plane) - 2.0).abs() < 0.3, "{}", grain(&plane));
    }

    #[test]
    fn a_picture_that_darkens_downwards_falls() {
        let picture = Rgb8::from_fn(64, 50, |_, y| [(200 - 3 * y) as u8; 3]);
        let look = measure_photograph(&picture, &Plane::filled(64, 50, OPEN_WATER));
        assert!(value(&look, "top").unwrap() > 30.0 && value(&look, "clipped") == Some(0.0));
        assert!(value(&look, "spread").unwrap() > 10.0);
        assert!((value(&look, "entropy").unwrap() - 50f64.log2()).abs() < 1e-9);
    }

    #[test]
    fn structures_are_compared_with_the_water_next_to_them_alone() {
        // A structure of code 2 on the left; the water brightens away from it.
        let visible = Plane::from_fn(90, 30, |x, _| if x < 30 { 2 } else { OPEN_WATER });
        let picture = Rgb8::from_fn(90, 30, |x, _| {
            if x < 30 {
                [90; 3]
            } else if x < 50 {
                [60; 3]
            } else {
                [200; 3]
            }
        });
        let look = measure_lightness(&picture, &visible);
        assert!(value(&look, "structures").unwrap() > 5.0, "{look:?}");
        assert!((value(&look, "water").unwrap() - 200.0 / 3.0).abs() < 1e-9);
        assert!(value(&look, "center").unwrap() < 0.0);
        let alone = measure_lightness(&picture, &Plane::filled(90, 30, SEABED));
        assert_eq!(value(&alone, "structures"), None);
    }
}
