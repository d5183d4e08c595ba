//! How much of the light from all around falls on a surface, by its slope.

use std::f64::consts::TAU;

use super::field::Shape;
use crate::legendre::gauss_legendre;

/// Slopes of the table, from facing down to facing up.
pub const SLOPES: usize = 33;
/// Cosines and azimuths of the quadrature.
const COSINES: usize = 32;
const AZIMUTHS: usize = 64;

/// The irradiance of surfaces over that of a horizontal one that faces up, `∫ Φ(μ) max(n·v, 0) dv` over the same with n up, at the
/// cosines `−1 + k/16` of the normal from the vertical: by 32 Gauss–Legendre nodes in μ and 64 azimuths. The last is 1.
#[must_use]
pub fn share_by_slope(shape: &Shape) -> [f64; SLOPES] {
    let rule: Vec<[f64; 3]> = gauss_legendre(COSINES)
        .into_iter()
        .map(|(rise, weight)| [rise, (1.0 - rise * rise).sqrt(), weight * shape.phi(rise)])
        .collect();
    let azimuths: Vec<f64> = (0..AZIMUTHS)
        .map(|i| ((i as f64 + 0.5) * TAU / AZIMUTHS as f64).cos())
        .collect();
    let irradiance = |slope: f64| -> f64 {
        let across = (1.0 - slope * slope).max(0.0).sqrt();
        let of = |[rise, level, weight]: &[f64; 3]| {
            let facing = azimuths
                .iter()
                .map(|cosine| (across * level * cosine + slope * rise).max(0.0));
            weight * facing.sum::<f64>()
        };
        rule.iter().map(of).sum()
    };
    let upward = irradiance(1.0);
    std::array::from_fn(|k| irradiance(-1.0 + k as f64 / 16.0) / upward)
}

/// The share at a cosine, between those of the table.
pub(super) fn between(table: &[f64; SLOPES], slope: f64) -> f64 {
    let place = ((slope + 1.0) * 16.0).clamp(0.0, 32.0);
    let k = (place as usize).min(SLOPES - 2);
    let share = place - k as f64;
    table[k] * (1.0 - share) + table[k + 1] * share
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn even_light_falls_on_all_slopes_alike() {
        let even = Shape {
            horizon: 0.1,
            p: 0.0,
            q: 0.0,
        };
        for share in share_by_slope(&even) {
            assert!((share - 1.0).abs() < 2e-3, "{share}");
        }
    }

    #[test]
    fn what_faces_up_is_brightest_and_the_table_is_met_at_its_slopes() {
        let table = share_by_slope(&Shape::of_water(0.179, 0.004));
        assert!((table[SLOPES - 1] - 1.0).abs() < 1e-15);
        assert!(table.windows(2).all(|pair| pair[0] < pair[1]), "{table:?}");
        for (k, share) in table.iter().enumerate() {
            assert!((between(&table, -1.0 + k as f64 / 16.0) - share).abs() < 1e-12);
        }
        assert_eq!(between(&table, 1.0 + 1e-7), table[SLOPES - 1]);
    }
}
