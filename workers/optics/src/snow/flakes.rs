//! Which particles a camera meets.

use imaging::cancel;
use imaging::random::Stream;
use spec::Snow;

use super::{TAIL, World, largest_m};
use crate::eye::Eye;

/// Cells hold this many particles on average, unless they would be wider than [`WIDEST_CELL_M`].
const PER_CELL: f64 = 8.0;
const WIDEST_CELL_M: f64 = 16.0;
/// Draws of one particle, and most particles of one cell: with a mean of 8 one chance in 10^150.
const DRAWS: u64 = 5;
const MOST_IN_CELL: u64 = 200;
/// Discs end at this many σ at the latest, where 1e-14 of the opacity is left.
pub(super) const REACH: f64 = 8.0;

/// A particle in view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flake {
    /// Its place in camera axes, m.
    pub place: [f64; 3],
    /// Its radius, m.
    pub radius_m: f64,
    /// Its distance from the camera, m.
    pub range_m: f64,
    /// Where it is in the picture, pixels.
    pub center: [f64; 2],
    /// σ of its disc, pixels.
    pub sigma: f64,
    /// Opacity in the middle of the disc without any water.
    pub opacity: f64,
}

/// The particles between the two depths whose discs can reach into a frame of this size, the farthest first.
#[must_use]
pub fn flakes(eye: &Eye, snow: &Snow, world: World, size: (usize, usize)) -> Vec<Flake> {
    let mut found = Vec::new();
    if snow.density_per_m3 > 0.0 && snow.near_m < snow.far_m {
        let cells = Cells::new(eye, snow, world, size);
        cells.each(|place, radius_m| found.extend(seen(eye, snow, place, radius_m, size)));
    }
    // No two particles are at one place, so that the order does not depend on how they were found.
    found.sort_by(|a, b| b.range_m.total_cmp(&a.range_m));
    found
}

fn seen(
    eye: &Eye,
    snow: &Snow,
    place: [f64; 3],
    radius_m: f64,
    (width, height): (usize, usize),
) -> Option<Flake> {
    let [x, y, z] = place;
    if !(snow.near_m..=snow.far_m).contains(&z) {
        return None;
    }
    let camera = &eye.camera;
    let size = camera.focal_px * radius_m / z;
    let sigma = size.max(0.5);
    let center = [
        camera.cx + camera.focal_px * x / z,
        camera.cy + camera.focal_px * y / z,
    ];
    let reaches =
        |center: f64, side: usize| center >= -REACH * sigma && center <= side as f64 - 1.0 + REACH * sigma;
    (reaches(center[0], width) && reaches(center[1], height)).then(|| Flake {
        place,
        radius_m,
        range_m: (x * x + y * y + z * z).sqrt(),
        center,
        sigma,
        opacity: (size / sigma).powi(2),
    })
}

/// The cells of the world that a camera may see.
struct Cells<'a> {
    eye: &'a Eye,
    snow: &'a Snow,
    dice: Stream,
    index: u64,
    /// Side of a cell, m, and its mean number of particles.
    side: f64,
    mean: f64,
    /// First and last cell of the box around the view.
    box_of: [[i64; 3]; 2],
    /// Slopes x/z and y/z of the sides of the view, in half widths, and how far beyond them a disc can reach, m.
    slopes: [(f64, f64); 2],
    margin: f64,
}

impl<'a> Cells<'a> {
    fn new(eye: &'a Eye, snow: &'a Snow, world: World, (width, height): (usize, usize)) -> Self {
        let side = (PER_CELL / snow.density_per_m3).cbrt().min(WIDEST_CELL_M);
        let camera = &eye.camera;
        let slopes = [(width, camera.cx), (height, camera.cy)].map(|(pixels, middle)| {
            // Half a pixel of σ, that many times, beyond the outermost pixels.
            let beyond = 0.5 * REACH;
            (
                (-beyond - middle) / camera.focal_px,
                (pixels as f64 - 1.0 + beyond - middle) / camera.focal_px,
            )
        });
        let margin = REACH * largest_m(snow);
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for depth in [snow.near_m, snow.far_m] {
            for across in [slopes[0].0 * depth - margin, slopes[0].1 * depth + margin] {
                for down in [slopes[1].0 * depth - margin, slopes[1].1 * depth + margin] {
                    let corner = eye.to_world([across, down, depth]);
                    for axis in 0..3 {
                        low[axis] = low[axis].min(corner[axis]);
                        high[axis] = high[axis].max(corner[axis]);
                    }
                }
            }
        }
        Self {
            eye,
            snow,
            dice: Stream::stage(world.seed, "snow"),
            index: world.index,
            side,
            mean: snow.density_per_m3 * side.powi(3),
            box_of: [low, high].map(|corner| corner.map(|v| (v / side).floor() as i64)),
            slopes,
            margin,
        }
    }

    /// Calls with the place in camera axes and the radius of every particle.
    fn each(&self, mut take: impl FnMut([f64; 3], f64)) {
        let [low, high] = self.box_of;
        for i in low[0]..=high[0] {
            for j in low[1]..=high[1] {
                cancel::check();
                for k in low[2]..=high[2] {
                    if self.in_view([i, j, k]) {
                        self.cell([i, j, k], &mut take);
                    }
                }
            }
        }
    }

    /// Whether the ball around a cell meets the view.
    fn in_view(&self, cell: [i64; 3]) -> bool {
        let middle = self.eye.to_camera(cell.map(|v| self.side * (v as f64 + 0.5)));
        let radius = 0.5 * 3.0f64.sqrt() * self.side + self.margin;
        let ahead = middle[2] + radius >= self.snow.near_m && middle[2] - radius <= self.snow.far_m;
        ahead
            && self.slopes.iter().zip(middle).all(|((least, most), v)| {
                // Distances from the two planes through the eye.
                let out =
                    |slope: f64, sign: f64| sign * (v - slope * middle[2]) / (1.0 + slope * slope).sqrt();
                out(*least, -1.0) <= radius && out(*most, 1.0) <= radius
            })
    }

    fn cell(&self, cell: [i64; 3], take: &mut impl FnMut([f64; 3], f64)) {
        let base = address(cell);
        let count = poisson(self.dice.unit(self.index, base), self.mean);
        for particle in 0..count {
            let draw = |choice: u64| self.dice.unit(self.index, base + 1 + DRAWS * particle + choice);
            let world = [0, 1, 2].map(|axis| self.side * (cell[axis] as f64 + draw(axis as u64)));
            // A normal number after Box and Muller 1958.
            let length = (-2.0 * (1.0 - draw(3)).ln()).sqrt();
            let normal = length * (std::f64::consts::TAU * draw(4)).cos();
            let radius = self.snow.radius_m * (self.snow.radius_spread * normal.clamp(-TAIL, TAIL)).exp();
            take(self.eye.to_camera(world), radius);
        }
    }
}

/// Cells within ±2^17 along each axis have addresses of their own, with room for their particles.
fn address(cell: [i64; 3]) -> u64 {
    let place = cell.map(|v| v.wrapping_add(1 << 17) as u64 & 0x3_ffff);
    (place[0] << 46) | (place[1] << 28) | (place[2] << 10)
}

/// How many of a Poisson distribution with this mean: the inverse of its distribution function at u.
fn poisson(u: f64, mean: f64) -> u64 {
    let mut term = (-mean).exp();
    let (mut sum, mut count) = (term, 0);
    while sum <= u && count < MOST_IN_CELL {
        count += 1;
        term *= mean / count as f64;
        sum += term;
    }
    count
}
