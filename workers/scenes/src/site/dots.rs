//! Scattered dots: round bumps, at most one in each cell of a lattice.

use super::lanes::{LANES, Lane, Lane3, clamp01, floor};
use super::noise::{Noise, PRIMES, gradient, hash, lattice};

/// The lattice of dots stands askew, so that no surface shows its rows.
const ASKEW: [[f32; 3]; 3] = [[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]];

#[inline(always)]
fn turned(p: [f32; 3]) -> [f32; 3] {
    ASKEW.map(|row| row[0] * p[0] + row[1] * p[1] + row[2] * p[2])
}

#[inline(always)]
fn turned_back(p: [f32; 3]) -> [f32; 3] {
    [0, 1, 2].map(|c| ASKEW[0][c] * p[0] + ASKEW[1][c] * p[1] + ASKEW[2][c] * p[2])
}

#[inline(always)]
pub(super) fn put_dots(
    dots: &mut Noise,
    position: &Lane3,
    footprint: &Lane,
    per_metre: f32,
    radius: f32,
    share: f32,
    key: u32,
) {
    for i in 0..LANES {
        let p = turned([position[0][i], position[1][i], position[2][i]]).map(|p| p * per_metre);
        let cell = p.map(floor);
        let corner = [
            lattice(cell[0]).wrapping_mul(PRIMES[0]) ^ key,
            lattice(cell[1]).wrapping_mul(PRIMES[1]),
            lattice(cell[2]).wrapping_mul(PRIMES[2]),
        ];
        let jitter = gradient(corner[0], corner[1], corner[2]).map(|g| 0.5 + g * (0.5 - radius));
        let kind = (hash(corner[0], corner[1], corner[2]) >> 8) as i32 as f32 * (1.0 / 16_777_216.0);
        let size = radius * (0.45 + 0.55 * kind / share);
        let away = [
            p[0] - cell[0] - jitter[0],
            p[1] - cell[1] - jitter[1],
            p[2] - cell[2] - jitter[2],
        ];
        let near = (away[0] * away[0] + away[1] * away[1] + away[2] * away[2]) / (size * size);
        let inside = clamp01(1.0 - near);
        let seen = clamp01(2.0 - 4.0 * per_metre * footprint[i]) * if kind < share { 1.0 } else { 0.0 };
        let steep = if near < 1.0 {
            -4.0 * near * per_metre / (size * size)
        } else {
            0.0
        };
        dots.value[i] = seen * inside * (2.0 - inside);
        let slope = turned_back(away);
        for axis in 0..3 {
            dots.slope[axis][i] = seen * steep * slope[axis];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::site::noise::Place;

    #[test]
    fn dots_slope_as_they_rise() {
        let at = |x: f32| {
            let position = [[x; LANES], [0.4; LANES], [0.7; LANES]];
            let place = Place {
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
            let difference = (at(x + 1e-3).0 - at(x - 1e-3).0) / 2e-3;
            assert!(
                (difference - at(x).1).abs() < 0.15,
                "{x}: {difference} {}",
                at(x).1
            );
            steepest = steepest.max(difference);
        }
        assert!(steepest > 1.0);
    }
}
