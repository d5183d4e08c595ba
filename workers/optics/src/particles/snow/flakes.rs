//! Particles in the view of a camera.

use imaging::cancel;
use imaging::random::Stream;
use imaging::vector::dot;
use spec::Snow;

use super::spot::Spot;
use super::world::{RADII, Seeing, World, largest_m};
use crate::eye::Eye;

/// Cells hold this many particles on average, unless they would be wider than [`WIDEST_CELL_M`].
const PER_CELL: f64 = 8.0;
const WIDEST_CELL_M: f64 = 16.0;
/// Reach of the smallest disc and its edge, px.
const EDGE_PX: f64 = 1.0;
/// Draws of one particle, and most particles of one cell: with a mean of 8 one chance in 10^150.
const DRAWS: u64 = 4;
const MOST_IN_CELL: u64 = 200;
/// A particle in view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flake {
    /// Its position in camera axes, m.
    pub place: [f64; 3],
    /// Its radius, m.
    pub radius_m: f64,
    /// Its distance from the camera, m.
    pub range_m: f64,
    /// Where it is in the picture, pixels.
    pub center: [f64; 2],
    /// Its disc in the picture.
    pub spot: Spot,
    /// Opacity in the middle of the spot without any water.
    pub opacity: f64,
}

/// Parts of an aggregate: at least three, at most this many.
const MOST_PARTS: u64 = 8;

/// The particles between the two depths whose spots can reach into a frame of this size, the farthest first; of an aggregate
/// each of its parts.
#[must_use]
pub fn flakes(eye: &Eye, snow: &Snow, world: World, size: (usize, usize), seeing: &Seeing<'_>) -> Vec<Flake> {
    let mut found = Vec::new();
    if snow.density_per_m3 > 0.0 && snow.near_m < snow.far_m {
        // A camera in a current sees the same as one moving against it in still water.
        let eye = &carried(eye, snow, seeing.time_s);
        let cells = Cells::new(eye, snow, world, size, seeing);
        cells.each(|place, radius_m| found.extend(seen(eye, snow, place, radius_m, size, seeing)));
    }
    // All particles have different positions, so that the order does not depend on the search.
    found.sort_by(|a, b| b.range_m.total_cmp(&a.range_m));
    found
}

/// A camera that the current has carried back for some time.
fn carried(eye: &Eye, snow: &Snow, time_s: f64) -> Eye {
    let mut eye = *eye;
    if let Some(drift) = snow.drift_m_per_s {
        (0..3).for_each(|i| eye.world_from_camera[i][3] -= drift[i] * time_s);
    }
    eye
}

fn seen(
    eye: &Eye,
    snow: &Snow,
    place: [f64; 3],
    radius_m: f64,
    (width, height): (usize, usize),
    seeing: &Seeing<'_>,
) -> Option<Flake> {
    let [x, y, z] = place;
    if !(snow.near_m..=snow.far_m).contains(&z) {
        return None;
    }
    let camera = &eye.camera;
    let range_m = (x * x + y * y + z * z).sqrt();
    let size = camera.focal_px * radius_m / z;
    let streak = snow.drift_m_per_s.map_or([0.0; 2], |drift| {
        let [right, down, ahead] = eye.turned(drift);
        let scale = camera.focal_px * seeing.exposure_s / z;
        let streak = [right - x / z * ahead, down - y / z * ahead].map(|v| v * scale);
        let length = streak[0].hypot(streak[1]);
        streak.map(|v| v * (MOST_STREAK_PX / length.max(MOST_STREAK_PX)))
    });
    let (spot, opacity) = Spot::of(size, (seeing.blur_px)(range_m), streak);
    let center = [
        camera.cx + camera.focal_px * x / z,
        camera.cy + camera.focal_px * y / z,
    ];
    let reaches =
        |center: f64, side: usize, reach: f64| center >= -reach && center <= side as f64 - 1.0 + reach;
    let [across, down] = spot.reach();
    (reaches(center[0], width, across) && reaches(center[1], height, down)).then_some(Flake {
        place,
        radius_m,
        range_m,
        center,
        spot,
        opacity,
    })
}

/// Longer streaks are cut, px.
const MOST_STREAK_PX: f64 = 256.0;

/// The cells of the world that a camera may see.
struct Cells<'a> {
    eye: &'a Eye,
    snow: &'a Snow,
    dice: Stream,
    parts: Stream,
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
    fn new(
        eye: &'a Eye,
        snow: &'a Snow,
        world: World,
        (width, height): (usize, usize),
        seeing: &Seeing<'_>,
    ) -> Self {
        let side = (PER_CELL / snow.density_per_m3).cbrt().min(WIDEST_CELL_M);
        let camera = &eye.camera;
        // Half a streak on either side, and the same for particles that move towards the camera from outside the frame.
        let speed = snow.drift_m_per_s.map_or(0.0, |drift| dot(drift, drift).sqrt());
        let drawn_out = (camera.focal_px * speed * seeing.exposure_s / snow.near_m).min(MOST_STREAK_PX);
        let slopes = [(width, camera.cx), (height, camera.cy)].map(|(pixels, middle)| {
            // The least disc and the widest blur beyond the outermost pixels.
            let beyond = EDGE_PX + seeing.most_blur_px(snow) + drawn_out;
            (
                (-beyond - middle) / camera.focal_px,
                (pixels as f64 - 1.0 + beyond - middle) / camera.focal_px,
            )
        });
        let margin = 2.0 * largest_m(snow);
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
            parts: Stream::stage(world.seed, "snow-parts"),
            index: world.index,
            side,
            mean: snow.density_per_m3 * side.powi(3),
            box_of: [low, high].map(|corner| corner.map(|v| (v / side).floor() as i64)),
            slopes,
            margin,
        }
    }

    /// A number of a part of a particle of this world, uniform in 0..1.
    fn part(&self, address: u64, part: u64, choice: u64) -> f64 {
        let index = self.index.wrapping_mul(MOST_PARTS + 1) + part;
        self.parts.unit(index, address + choice)
    }

    /// An aggregate: a chain of parts, each touching one before it, whose areas add up to the particle's. Marine aggregates
    /// are loose and stringy (Alldredge and Silver 1988).
    fn aggregate(&self, address: u64, place: [f64; 3], radius: f64, take: &mut impl FnMut([f64; 3], f64)) {
        let count = 3 + (self.part(address, MOST_PARTS, 0) * (MOST_PARTS - 2) as f64) as u64;
        let weight = |part: u64| 0.25 + self.part(address, part, 0);
        let sum: f64 = (0..count).map(|part| weight(part).powi(2)).sum();
        let radius_of = |part: u64| radius * weight(part) / sum.sqrt();
        let mut places: Vec<[f64; 3]> = vec![place];
        for part in 1..count {
            let before = (self.part(address, part, 1) * part as f64) as usize;
            let away = 0.9 * (radius_of(part) + radius_of(before as u64));
            let rise = 2.0 * self.part(address, part, 2) - 1.0;
            let (sin, cos) = (std::f64::consts::TAU * self.part(address, part, 3)).sin_cos();
            let flat = (1.0 - rise * rise).sqrt();
            let [x, y, z] = places[before];
            places.push([x + away * flat * cos, y + away * flat * sin, z + away * rise]);
        }
        for (part, place) in places.into_iter().enumerate() {
            take(self.eye.to_camera(place), radius_of(part as u64));
        }
    }

    /// The radius that belongs to a uniform number by Junge's law `n(r) ∝ r^−s` between the least radius and [`RADII`] times it.
    fn junge(&self, slope: f64, u: f64) -> f64 {
        let power = 1.0 - slope;
        self.snow.radius_m * (1.0 - u * (1.0 - RADII.powf(power))).powf(1.0 / power)
    }

    /// Calls with the position in camera axes and the radius of every particle.
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

    /// Whether the ball around a cell intersects the view.
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
            let radius = self.junge(self.snow.spectrum, draw(3));
            let address = base + 1 + DRAWS * particle;
            let share = self.snow.aggregates;
            if share > 0.0 && self.part(address, MOST_PARTS, 1) < share {
                self.aggregate(address, world, radius, take);
            } else {
                take(self.eye.to_camera(world), radius);
            }
        }
    }
}

/// Cells within ±2^17 along each axis have distinct addresses, with room for their particles.
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
