//! How much of the light from all around falls on a surface, by its slope.

use std::f64::consts::TAU;

/// Slopes of the table, from facing down to facing up.
pub const SLOPES: usize = 33;
const AZIMUTHS: usize = 64;

/// The irradiance of surfaces over that of a horizontal one that faces up, `∫ L(μ) max(n·v, 0) dv` over the same with n up, at the
/// cosines `−1 + k/16` of the normal from the vertical. `rule` holds the cosines μ of a quadrature with their weights, `radiance` L at
/// them; 64 azimuths. The last is 1.
///
/// # Panics
/// Without a radiance for each node.
#[must_use]
pub fn share_by_slope(rule: &[[f64; 2]], radiance: &[f64]) -> [f64; SLOPES] {
    assert_eq!(rule.len(), radiance.len(), "a radiance for each node");
    let azimuths: [f64; AZIMUTHS] = std::array::from_fn(|i| ((i as f64 + 0.5) * TAU / AZIMUTHS as f64).cos());
    let irradiance = |slope: f64| -> f64 {
        let across = (1.0 - slope * slope).max(0.0).sqrt();
        let nodes = rule.iter().zip(radiance).map(|(&[rise, weight], light)| {
            let level = (1.0 - rise * rise).max(0.0).sqrt();
            let facing = azimuths
                .iter()
                .map(|cosine| (across * level * cosine + slope * rise).max(0.0));
            weight * light * facing.sum::<f64>()
        });
        nodes.sum()
    };
    let upward = irradiance(1.0).max(f64::MIN_POSITIVE);
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
    use crate::legendre::gauss_legendre;

    fn rule() -> Vec<[f64; 2]> {
        gauss_legendre(32)
            .into_iter()
            .map(|(x, weight)| [x, weight])
            .collect()
    }

    #[test]
    fn even_light_falls_on_all_slopes_alike() {
        for share in share_by_slope(&rule(), &[0.3; 32]) {
            assert!((share - 1.0).abs() < 2e-3, "{share}");
        }
    }

    #[test]
    fn what_faces_up_is_brightest_and_the_table_is_met_at_its_slopes() {
        let rule = rule();
        let radiance: Vec<f64> = rule.iter().map(|[rise, _]| (2.0 * rise).exp()).collect();
        let table = share_by_slope(&rule, &radiance);
        assert!((table[SLOPES - 1] - 1.0).abs() < 1e-15);
        assert!(table.windows(2).all(|pair| pair[0] < pair[1]), "{table:?}");
        for (k, share) in table.iter().enumerate() {
            assert!((between(&table, -1.0 + k as f64 / 16.0) - share).abs() < 1e-12);
        }
        assert_eq!(between(&table, 1.0 + 1e-7), table[SLOPES - 1]);
    }
}
