//! Blur of what is out of focus: each pixel gathers over a disc as large as its own circle of confusion.
//!
//! `r_b = f (A/2) |1/v(Z) - 1/v(Z_f)|` pixels at range Z: f of the lens in air, A the diameter of the aperture, Z_f what is in
//! focus. v(Z) is where the lens sees a point: Z in air, Z/n behind a flat port, and behind a dome of radius r_d at
//! `r_d + 1/((n-1)/r_d + n/(Z - r_d))`. A pixel of the disc weighs the share of its 8×8 points within the radius; the border
//! is mirrored with its edge. What is near does not bleed over the edge of what is behind it: each pixel knows its own range alone.
//!
//! The fast form computes the picture for [`LEVELS`] radii between the least and the greatest and blends the two nearest.

use imaging::{Plane, Rgb, cancel, vectorized};
use spec::{Defocus, Port};

/// Radii of the fast form.
pub const LEVELS: usize = 8;
/// Below this radius in pixels everywhere there is no blur.
pub const SHARP_PX: f64 = 0.25;
/// Largest radius in pixels: more light than that of a disc of 129 pixels is beyond what a gather of this kind is for.
pub const MOST_PX: f64 = 64.0;
/// Columns that are summed together.
const COLUMNS: usize = 32;
/// Points of a pixel along a side.
const POINTS: usize = 8;

/// The circle of confusion of a lens by range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Focus {
    /// `f A/2`, pixels times meters.
    scale: f64,
    /// 1/v of what is in focus, 1/m.
    sharp: f64,
    port: Option<Port>,
}

impl Focus {
    /// That of a lens with this focal length in air, in pixels.
    #[must_use]
    pub fn new(law: Defocus, focal_px: f64, port: Option<Port>) -> Self {
        Self {
            scale: focal_px * law.aperture_m / 2.0,
            sharp: nearness(law.focus_m, port),
            port,
        }
    }

    /// The radius in pixels of what is at a range in the water, at most [`MOST_PX`]; no range is infinitely far.
    #[must_use]
    pub fn radius_px(&self, range_m: f64) -> f64 {
        let is_there = range_m.is_finite() && range_m > 0.0;
        let range_m = if is_there { range_m } else { f64::INFINITY };
        (self.scale * (nearness(range_m, self.port) - self.sharp).abs()).min(MOST_PX)
    }

    /// The radius of every pixel.
    #[must_use]
    pub fn radii(&self, range: &Plane<f32>) -> Plane<f32> {
        range.map(|&meters| self.radius_px(f64::from(meters)) as f32)
    }
}

/// `1/v(Z)`, 1/m.
fn nearness(range_m: f64, port: Option<Port>) -> f64 {
    match port {
        None | Some(Port::None {}) => 1.0 / range_m,
        Some(Port::Flat { n_w, .. }) => n_w[1] / range_m,
        Some(Port::Dome { n_w, radius_m }) => {
            let n = n_w[1];
            // What touches the dome is seen at the dome.
            let beyond = (range_m - radius_m).max(0.0);
            1.0 / (radius_m + 1.0 / ((n - 1.0) / radius_m + n / beyond))
        }
    }
}

/// A quadrant of a disc's weights, row by row: `weights[dy][dx]`, the whole disc sums to 1.
struct Disc {
    weights: Vec<Vec<f64>>,
}

impl Disc {
    fn new(radius: f64) -> Self {
        let reach = (radius + 0.5).floor().max(0.0) as usize;
        let square = radius * radius;
        let point = |pixel: usize, k: usize| pixel as f64 + (k as f64 + 0.5) / POINTS as f64 - 0.5;
        let count = |dx: usize, dy: usize| {
            let rows = (0..POINTS).map(|k| point(dy, k));
            let inside = rows.map(|y| {
                let columns = (0..POINTS).map(|k| point(dx, k));
                columns.filter(|x| x * x + y * y <= square).count()
            });
            inside.sum::<usize>() as f64
        };
        let mut weights: Vec<Vec<f64>> = (0..=reach)
            .map(|dy| (0..=reach).map(|dx| count(dx, dy)).collect())
            .collect();
        let times = |k: usize| if k == 0 { 1.0 } else { 2.0 };
        let rows = weights.iter().enumerate();
        let sum: f64 = rows
            .flat_map(|(dy, row)| {
                row.iter()
                    .enumerate()
                    .map(move |(dx, w)| w * times(dx) * times(dy))
            })
            .sum();
        if sum == 0.0 {
            // Smaller than the distance of two points: the pixel itself.
            return Self {
                weights: vec![vec![1.0]],
            };
        }
        for row in &mut weights {
            row.iter_mut().for_each(|weight| *weight /= sum);
            let used = row
                .iter()
                .rposition(|&weight| weight > 0.0)
                .map_or(0, |last| last + 1);
            row.truncate(used);
        }
        weights.retain(|row| !row.is_empty());
        Self { weights }
    }
}

/// Every pixel's own disc in f64.
#[must_use]
pub fn blur_reference(picture: &Rgb<f64>, radii: &Plane<f64>) -> Rgb<f64> {
    let (width, height) = picture.size();
    let mut known: Option<(f64, Disc)> = None;
    Rgb::from_fn(width, height, |x, y| {
        let radius = radii.pixel(x, y);
        let disc = match known.take() {
            Some((of, disc)) if of == radius => disc,
            _ => Disc::new(radius),
        };
        let gather = |plane: &Plane<f64>| {
            let mut sum = 0.0;
            for (dy, row) in disc.weights.iter().enumerate() {
                for (dx, weight) in row.iter().enumerate() {
                    for (sy, sx) in signs(dx, dy) {
                        let x = mirrored(x as isize + sx * dx as isize, width);
                        let y = mirrored(y as isize + sy * dy as isize, height);
                        sum += weight * plane.pixel(x, y);
                    }
                }
            }
            sum
        };
        let pixel = picture.planes().each_ref().map(gather);
        known = Some((radius, disc));
        pixel
    })
}

/// The quadrants that a place of the first one stands for.
fn signs(dx: usize, dy: usize) -> impl Iterator<Item = (isize, isize)> {
    let ways = |d: usize| if d == 0 { &[1][..] } else { &[1, -1][..] };
    ways(dy)
        .iter()
        .flat_map(move |&sy| ways(dx).iter().map(move |&sx| (sy, sx)))
}

/// The picture with every pixel blurred by its radius.
///
/// # Panics
/// When picture and radii differ in size.
#[must_use]
pub fn blur(picture: &Rgb<f32>, radii: &Plane<f32>) -> Rgb<f32> {
    let (width, height) = picture.size();
    assert_eq!(radii.size(), (width, height), "a radius for each pixel");
    let levels = Levels::of(radii);
    let discs: Vec<Disc> = levels.radii().map(Disc::new).collect();
    let margin = discs.iter().map(|disc| disc.weights.len()).max().unwrap_or(1);
    let planes = picture.planes().each_ref().map(|plane| {
        let padded = pad(plane, margin);
        let mut blurred = vec![0.0f32; width * height];
        for (y, out) in blurred.chunks_mut(width.max(1)).enumerate() {
            cancel::check();
            for (level, disc) in discs.iter().enumerate() {
                if let Some((from, to)) = levels.span(level, radii.row(y)) {
                    let sums = gather(&padded, disc, margin, y, (from, to));
                    levels.add(level, &radii.row(y)[from..to], &sums, &mut out[from..to]);
                }
            }
        }
        Plane::new(width, height, blurred).expect("a sample for each pixel")
    });
    Rgb::new(planes).expect("three planes of one picture")
}

/// Radii at equal steps, between which pixels are blended.
struct Levels {
    least: f32,
    step: f32,
}

impl Levels {
    fn of(radii: &Plane<f32>) -> Self {
        let all = || radii.data().iter().copied();
        let (least, most) = (all().fold(f32::INFINITY, f32::min), all().fold(0.0, f32::max));
        Self {
            least,
            step: (most - least).max(0.0) / (LEVELS - 1) as f32,
        }
    }

    fn radii(&self) -> impl Iterator<Item = f64> {
        let count = if self.step > 0.0 { LEVELS } else { 1 };
        (0..count).map(|level| f64::from(self.least + self.step * level as f32))
    }

    /// How much of a level a radius takes.
    fn weight(&self, level: usize, radius: f32) -> f32 {
        if self.step > 0.0 {
            let place = (radius - self.least) / self.step;
            (1.0 - (place - level as f32).abs()).max(0.0)
        } else {
            1.0
        }
    }

    /// The columns between which a level is needed.
    fn span(&self, level: usize, radii: &[f32]) -> Option<(usize, usize)> {
        let needs = |radius: &f32| self.weight(level, *radius) > 0.0;
        let from = radii.iter().position(needs)?;
        let to = radii.iter().rposition(needs)? + 1;
        Some((from, to))
    }

    fn add(&self, level: usize, radii: &[f32], sums: &[f32], out: &mut [f32]) {
        for ((out, sum), &radius) in out.iter_mut().zip(sums).zip(radii) {
            *out += self.weight(level, radius) * sum;
        }
    }
}

/// The index inside `0..n` that stands for `i`: `c b a | a b c | c b a`, any way outside.
fn mirrored(i: isize, n: usize) -> usize {
    let folded = i.rem_euclid(2 * n as isize);
    folded.min(2 * n as isize - 1 - folded) as usize
}

/// The plane with mirrored borders of this width.
fn pad(plane: &Plane<f32>, margin: usize) -> Plane<f32> {
    let (width, height) = plane.size();
    let inside = |i: usize, side: usize| mirrored(i as isize - margin as isize, side);
    let columns: Vec<usize> = (0..width + 2 * margin).map(|x| inside(x, width)).collect();
    let rows = (0..height + 2 * margin).map(|y| plane.row(inside(y, height)));
    let data = rows.flat_map(|row| columns.iter().map(|&x| row[x])).collect();
    Plane::new(width + 2 * margin, height + 2 * margin, data).expect("a margin on all sides")
}

/// The sums over a disc about some pixels of a row. Rows above and below are added first, then columns left and right.
fn gather(padded: &Plane<f32>, disc: &Disc, margin: usize, y: usize, (from, to): (usize, usize)) -> Vec<f32> {
    let mut sums = vec![0.0f32; to - from];
    let mut pair = vec![0.0f32; to - from + 2 * margin];
    for (dy, weights) in disc.weights.iter().enumerate() {
        let row = |y: usize| &padded.row(y)[from..to + 2 * margin];
        let (above, below) = (row(y + margin - dy), row(y + margin + dy));
        let rows = if dy == 0 {
            above
        } else {
            vectorized!(join(&mut pair, above, below));
            &pair
        };
        vectorized!(weigh(&mut sums, rows, weights, margin));
    }
    sums
}

#[inline(always)]
fn join(pair: &mut [f32], above: &[f32], below: &[f32]) {
    for ((pair, above), below) in pair.iter_mut().zip(above).zip(below) {
        *pair = above + below;
    }
}

#[inline(always)]
fn weigh(sums: &mut [f32], rows: &[f32], weights: &[f64], margin: usize) {
    let rest = sums.len() % COLUMNS;
    let whole = sums.len() - rest;
    let (blocks, last) = sums.split_at_mut(whole);
    for (block, sums) in blocks.chunks_exact_mut(COLUMNS).enumerate() {
        // As many as registers hold: a sum is read and written once for a row of the disc.
        let mut own = [0.0; COLUMNS];
        own.copy_from_slice(sums);
        weigh_block(&mut own, rows, weights, margin + block * COLUMNS);
        sums.copy_from_slice(&own);
    }
    weigh_block(last, rows, weights, margin + whole);
}

/// Adds the weighted columns on both sides of some, of which the first is at `middle` of the rows.
#[inline(always)]
fn weigh_block(sums: &mut [f32], rows: &[f32], weights: &[f64], middle: usize) {
    let length = sums.len();
    for (dx, &weight) in weights.iter().enumerate() {
        let weight = weight as f32;
        let left = &rows[middle - dx..][..length];
        if dx == 0 {
            for (sum, left) in sums.iter_mut().zip(left) {
                *sum += weight * left;
            }
            continue;
        }
        let right = &rows[middle + dx..][..length];
        for ((sum, left), right) in sums.iter_mut().zip(left).zip(right) {
            *sum += weight * (left + right);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disc_is_round_and_sums_to_one() {
        for radius in [0.0, 0.05, 0.25, 0.5, 1.0, 1.7, 4.2, 11.0] {
            let disc = Disc::new(radius);
            let times = |k: usize| if k == 0 { 1.0 } else { 2.0 };
            let rows = disc.weights.iter().enumerate();
            let sum: f64 = rows
                .flat_map(|(dy, row)| {
                    row.iter()
                        .enumerate()
                        .map(move |(dx, w)| w * times(dx) * times(dy))
                })
                .sum();
            assert!((sum - 1.0).abs() < 1e-12, "{radius}: {sum}");
            for (dy, row) in disc.weights.iter().enumerate() {
                for (dx, weight) in row.iter().enumerate() {
                    let mirrored = disc.weights.get(dx).and_then(|row| row.get(dy));
                    assert_eq!(mirrored, Some(weight), "{radius} at ({dx}, {dy})");
                }
            }
        }
    }

    #[test]
    fn what_is_in_focus_is_sharp_and_blur_grows_away_from_it() {
        let law = Defocus {
            aperture_m: 0.01,
            focus_m: 1.0,
        };
        let dome = Port::Dome {
            n_w: [1.34; 3],
            radius_m: 0.1,
        };
        for port in [None, Some(dome)] {
            let focus = Focus::new(law, 800.0, port);
            assert_eq!(focus.radius_px(1.0), 0.0);
            assert!(focus.radius_px(2.0) > 0.5 && focus.radius_px(4.0) > focus.radius_px(2.0));
            assert_eq!(focus.radius_px(f64::NAN), focus.radius_px(f64::INFINITY));
            assert!(focus.radius_px(0.05) <= MOST_PX);
        }
        // In air: 800 * 0.005 * (1 - 1/2).
        assert!((Focus::new(law, 800.0, None).radius_px(2.0) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_dome_shows_infinity_at_four_radii() {
        let dome = Port::Dome {
            n_w: [1.34; 3],
            radius_m: 0.1,
        };
        let far = 1.0 / nearness(f64::INFINITY, Some(dome));
        assert!((far / 0.1 - 3.94).abs() < 0.01, "{far}");
    }
}
