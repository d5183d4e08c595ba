//! Groups of surface points that are shaded together, one array per quantity, so that the compiler vectorizes the
//! loops.

pub(crate) use imaging::simd::{larger, smaller};
use imaging::vector::{Vec3, vec3};

pub(crate) const LANES: usize = 32;

/// One quantity of all points.
pub(crate) type Lane = [f32; LANES];

pub(crate) const ZEROS: Lane = [0.0; LANES];

/// A vector quantity of all points.
pub(crate) type Lane3 = [Lane; 3];

/// A vector quantity of point `i`.
#[inline(always)]
pub(crate) fn load<const COUNT: usize>(lanes: &[[f32; COUNT]; 3], i: usize) -> Vec3 {
    vec3(lanes[0][i], lanes[1][i], lanes[2][i])
}

/// Sets a vector quantity of point `i`.
#[inline(always)]
pub(crate) fn store<const COUNT: usize>(lanes: &mut [[f32; COUNT]; 3], i: usize, v: Vec3) {
    lanes[0][i] = v.x;
    lanes[1][i] = v.y;
    lanes[2][i] = v.z;
}

/// 0 below `low`, 1 above `high`, smooth between.
#[inline(always)]
pub(crate) fn ramp(value: f32, low: f32, high: f32) -> f32 {
    let share = clamp01((value - low) * (1.0 / (high - low)));
    share * share * (3.0 - 2.0 * share)
}

/// Clamps to 0..1. Two selections avoid the NaN handling of `clamp` and `max`.
#[inline(always)]
pub(crate) fn clamp01(value: f32) -> f32 {
    larger(smaller(value, 1.0), 0.0)
}

#[inline(always)]
pub(crate) fn largest(v: Vec3) -> f32 {
    larger(larger(v.x, v.y), v.z)
}

#[inline(always)]
pub(crate) fn smallest(v: Vec3) -> f32 {
    smaller(smaller(v.x, v.y), v.z)
}

#[inline(always)]
pub(crate) fn mix(a: f32, b: f32, share: f32) -> f32 {
    a + (b - a) * share
}

/// Rounds to the nearest integer for |value| below 2²²; `round` would be a library call without SSE 4.1.
#[inline(always)]
pub(crate) fn nearest_integer(value: f32) -> f32 {
    const SHIFT: f32 = 12_582_912.0;
    (value + SHIFT) - SHIFT
}

/// The largest integer not above the value, for |value| below 2²².
#[inline(always)]
pub(crate) fn floor(value: f32) -> f32 {
    let rounded = nearest_integer(value);
    rounded - if rounded > value { 1.0 } else { 0.0 }
}

/// Sine of an angle in turns, to 0.0011 (a parabola, refined once); period 1 for any angle below 2²² turns.
#[inline(always)]
pub(crate) fn sin_turns(turns: f32) -> f32 {
    let rest = turns - nearest_integer(turns);
    let parabola = 8.0 * rest - 16.0 * rest * rest.abs();
    parabola + 0.225 * (parabola * parabola.abs() - parabola)
}

/// Cosine of an angle in turns, to 0.0011.
#[inline(always)]
pub(crate) fn cos_turns(turns: f32) -> f32 {
    sin_turns(turns + 0.25)
}

/// The angle of (x, y) from the x axis in radians, -pi..=pi, to 1e-4 (a polynomial of the tangent on 0..1; after
/// Abramowitz and Stegun 1964, 4.4.47). 0 at the origin.
#[inline(always)]
pub(crate) fn angle(y: f32, x: f32) -> f32 {
    let (ax, ay) = (x.abs(), y.abs());
    let t = smaller(ax, ay) / larger(larger(ax, ay), 1e-30);
    let s = t * t;
    let low = t * (0.999_866 + s * (-0.330_299_5 + s * (0.180_141 + s * (-0.085_133 + s * 0.020_835_1))));
    let right = if ay > ax {
        std::f32::consts::FRAC_PI_2 - low
    } else {
        low
    };
    let upper = if x < 0.0 {
        std::f32::consts::PI - right
    } else {
        right
    };
    if y < 0.0 { -upper } else { upper }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waves_follow_sine_and_cosine() {
        for i in -40..40 {
            let turns = i as f32 * 0.061;
            let (sin, cos) = (turns * std::f32::consts::TAU).sin_cos();
            assert!((sin_turns(turns) - sin).abs() < 1.2e-3, "{turns}");
            assert!((cos_turns(turns) - cos).abs() < 1.2e-3, "{turns}");
        }
    }

    #[test]
    fn angles_are_those_of_all_four_quadrants() {
        for i in -31..32 {
            let wanted = i as f32 * 0.1;
            let (sin, cos) = wanted.sin_cos();
            assert!((angle(3.0 * sin, 3.0 * cos) - wanted).abs() < 1e-4, "{wanted}");
        }
        assert_eq!(angle(0.0, 0.0), 0.0);
    }

    #[test]
    fn floor_goes_down_on_both_sides_of_zero() {
        assert_eq!(
            [-1.5, -1.0, -0.25, 0.0, 0.75, 2.0].map(floor),
            [-2.0, -1.0, -1.0, 0.0, 0.0, 2.0]
        );
    }
}
