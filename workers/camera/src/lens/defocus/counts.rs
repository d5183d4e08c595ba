//! Number of points within each pixel, for every disc up to a radius.
//!
//! A point is at `(a, b)/16` pixels from the center with odd a and b, so `a² + b² = 8k + 2` with an integer k, its
//! ring. A disc contains all rings up to one: radii within the same ring share a disc, and weights are integer counts.

use super::POINTS;

/// Length of a pixel's side in the units of a and b.
const SIDE: i32 = 2 * POINTS as i32;

/// The last ring within a radius in pixels; the innermost one if the radius contains no point or is NaN.
#[inline(always)]
pub(super) fn ring(radius_px: f64) -> i32 {
    // Scaling by a power of two is exact, so that the comparison equals that of the reference.
    let square = radius_px * radius_px * f64::from(SIDE * SIDE);
    ((square as i32).max(2) - 2) / 8
}

/// Points within each pixel of a disc.
pub(super) struct DiscCounts {
    /// Farthest row and column of a disc.
    reach: usize,
    pixels: Vec<PixelPoints>,
    /// Points up to each ring, pixel after pixel.
    growth: Vec<u8>,
    /// Reciprocal of the number of points of the disc, by ring.
    norms: Vec<f32>,
}

/// Position of a pixel's counts.
#[derive(Clone, Copy)]
struct PixelPoints {
    /// The ring before its first point.
    before: i32,
    /// Rings from there to its last point.
    rings: i32,
    start: usize,
}

impl DiscCounts {
    /// DiscCounts of all discs up to a radius in pixels.
    pub(super) fn up_to(radius_px: f64) -> Self {
        let last = ring(radius_px) as usize;
        let reach = (radius_px + 0.5) as usize;
        let mut added = vec![0u32; last + 1];
        let (mut pixels, mut growth) = (Vec::new(), Vec::new());
        for far in 0..=reach {
            for near in 0..=far {
                let rings = rings_of(near, far);
                let before = rings[0] - 1;
                pixels.push(PixelPoints {
                    before,
                    rings: rings[rings.len() - 1] - before,
                    start: growth.len(),
                });
                let all = before..=rings[rings.len() - 1];
                growth.extend(all.map(|ring| rings.partition_point(|&other| other <= ring) as u8));
                for ring in rings {
                    if let Some(added) = added.get_mut(ring as usize) {
                        *added += copies(near, far);
                    }
                }
            }
        }
        let mut total = 0;
        let norms = added.iter().map(|added| {
            total += added;
            (1.0 / f64::from(total)) as f32
        });
        Self {
            norms: norms.collect(),
            reach,
            pixels,
            growth,
        }
    }

    pub(super) fn reach(&self) -> usize {
        self.reach
    }

    /// Index of a pixel from its row and column distances, in either order.
    #[inline(always)]
    pub(super) fn pixel(dx: usize, dy: usize) -> usize {
        let (near, far) = if dx < dy { (dx, dy) } else { (dy, dx) };
        far * (far + 1) / 2 + near
    }

    /// Number of different pixels.
    pub(super) fn pixels(&self) -> usize {
        self.pixels.len()
    }

    /// Points of a disc within a pixel.
    #[inline(always)]
    pub(super) fn count(&self, pixel: usize, ring: i32) -> u8 {
        let PixelPoints { before, rings, start } = self.pixels[pixel];
        self.growth[start + (ring - before).clamp(0, rings) as usize]
    }

    /// Points of several discs within a pixel.
    #[inline(always)]
    pub(super) fn fill(&self, pixel: usize, discs: &[i32], counts: &mut [f32]) {
        let PixelPoints { before, rings, start } = self.pixels[pixel];
        let growth = &self.growth[start..=start + rings as usize];
        for (count, &ring) in counts.iter_mut().zip(discs) {
            *count = f32::from(growth[(ring - before).clamp(0, rings) as usize]);
        }
    }

    /// Reciprocal of the number of points of a disc.
    #[inline(always)]
    pub(super) fn norm(&self, ring: i32) -> f32 {
        self.norms[ring as usize]
    }
}

/// The rings of a pixel's points, ascending.
fn rings_of(near: usize, far: usize) -> Vec<i32> {
    let mut rings: Vec<i32> = points_of(near)
        .flat_map(|a| points_of(far).map(move |b| (a * a + b * b - 2) / 8))
        .collect();
    rings.sort_unstable();
    rings
}

/// The points of a pixel along an axis, in sixteenths of a pixel.
fn points_of(pixel: usize) -> impl Iterator<Item = i32> {
    (0..POINTS as i32).map(move |k| SIDE * pixel as i32 + 2 * k + 1 - SIDE / 2)
}

/// Number of pixels at these distances from the center.
fn copies(near: usize, far: usize) -> u32 {
    match (near, far) {
        (_, 0) => 1,
        (0, _) => 4,
        _ if near == far => 4,
        _ => 8,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of a pixel within a radius, by definition.
    fn points(dx: usize, dy: usize, radius: f64) -> u32 {
        let place = |pixel: usize, k: usize| pixel as f64 + (k as f64 + 0.5) / 8.0 - 0.5;
        let all = (0..64).map(|k| (place(dx, k % 8), place(dy, k / 8)));
        all.filter(|(x, y)| x * x + y * y <= radius * radius).count() as u32
    }

    #[test]
    fn counts_are_those_of_the_points_within_the_radius() {
        let counts = DiscCounts::up_to(7.3);
        // Radii on rings, next to them, and between them.
        let on_rings = (0..1700).step_by(3).map(|k| f64::from(8 * k + 2).sqrt() / 16.0);
        let all = on_rings.flat_map(|r| [r.next_down(), r, r.next_up(), r + 0.001]);
        for radius in all.filter(|&radius| (0.09..=7.3).contains(&radius)) {
            let mut total = 0;
            for dy in 0..=8 {
                for dx in 0..=8 {
                    let expected = points(dx, dy, radius);
                    total += expected << (u32::from(dx > 0) + u32::from(dy > 0));
                    let is_counted = dx.max(dy) <= counts.reach();
                    let pixel = DiscCounts::pixel(dx, dy);
                    let count = is_counted.then(|| counts.count(pixel, ring(radius)));
                    assert_eq!(
                        u32::from(count.unwrap_or(0)),
                        expected,
                        "{radius} at ({dx}, {dy})"
                    );
                }
            }
            let norm = counts.norm(ring(radius));
            assert_eq!(norm, (1.0 / f64::from(total)) as f32, "{radius}");
        }
    }

    #[test]
    fn radii_without_a_point_have_the_innermost_ring() {
        for radius in [0.0, 0.05, f64::NAN] {
            assert_eq!(ring(radius), 0);
        }
        assert_eq!(ring(64.0), (256 * 64 * 64 - 2) / 8);
    }
}
