//! Scattered dots: round bumps, at most one per cell of a lattice.

use crate::site::lanes::{LANES, Lane, Lane3, clamp01, floor};
use crate::site::lattice::{GRADIENT_UNIT, NoiseSample, gradient, hash, lattice};

/// Rotates the lattice, so that no surface shows its rows.
const ASKEW: [[f32; 3]; 3] = [[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]];

#[inline(always)]
pub(crate) fn put_dots(
    dots: &mut NoiseSample,
    position: &Lane3,
    footprint: &Lane,
    (per_meter, radius, share): (f32, f32, f32),
    key: u32,
) {
    let [a, b, c] = ASKEW;
    let growth = 0.55 / share;
    for i in 0..LANES {
        let [x, y, z] = [0, 1, 2].map(|axis| position[axis][i] * per_meter);
        let u = a[0] * x + a[1] * y + a[2] * z;
        let v = b[0] * x + b[1] * y + b[2] * z;
        let w = c[0] * x + c[1] * y + c[2] * z;
        let (cell_u, cell_v, cell_w) = (floor(u), floor(v), floor(w));
        let mixed = lattice([cell_u, cell_v, cell_w], key);
        let jitter = gradient(mixed);
        let kind = (hash(mixed) >> 8) as i32 as f32 * (1.0 / 16_777_216.0);
        let size = radius * (0.45 + growth * kind);
        let room = (0.5 - radius) * GRADIENT_UNIT;
        let away_u = u - cell_u - 0.5 - room * jitter[0];
        let away_v = v - cell_v - 0.5 - room * jitter[1];
        let away_w = w - cell_w - 0.5 - room * jitter[2];
        let inverse = 1.0 / (size * size);
        let near = (away_u * away_u + away_v * away_v + away_w * away_w) * inverse;
        let inside = clamp01(1.0 - near);
        let present = if kind < share { 1.0 } else { 0.0 };
        let seen = clamp01(2.0 - 4.0 * per_meter * footprint[i]) * present;
        let steep = -4.0 * near * per_meter * inverse;
        let steep = if near < 1.0 { seen * steep } else { 0.0 };
        dots.value[i] = seen * inside * (2.0 - inside);
        dots.slope[0][i] = steep * (a[0] * away_u + b[0] * away_v + c[0] * away_w);
        dots.slope[1][i] = steep * (a[1] * away_u + b[1] * away_v + c[1] * away_w);
        dots.slope[2][i] = steep * (a[2] * away_u + b[2] * away_v + c[2] * away_w);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::site::noise::NoisePoints;

    #[test]
    fn dots_slope_as_they_rise() {
        let dot_at = |x: f32| {
            let position = [[x; LANES], [0.4; LANES], [0.7; LANES]];
            let place = NoisePoints {
                position: &position,
                footprint: &[1e-6; LANES],
                finest: 1e-6,
            };
            let dots = place.dots(3.0, 0.4, 1.0, 3);
            (dots.value[0], dots.slope[0][0])
        };
        let mut steepest = 0.0f32;
        for i in 0..400 {
            let x = i as f32 * 0.01;
            let (before, here, after) = (dot_at(x - 1e-3), dot_at(x), dot_at(x + 1e-3));
            let difference = (after.0 - before.0) / 2e-3;
            // The rim is a kink: the slopes on its two sides differ.
            let kink = (after.1 - before.1).abs();
            assert!(
                (difference - here.1).abs() < 0.1 + kink,
                "{x}: {difference} {}",
                here.1
            );
            steepest = steepest.max(difference);
        }
        assert!(steepest > 1.0);
    }
}
