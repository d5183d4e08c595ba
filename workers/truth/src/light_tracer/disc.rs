//! The phase function averaged over a small disc of directions.

use std::f64::consts::PI;

use crate::phase::Phase;

/// Half angle of the disc, degrees.
const HALF_DEG: f64 = 5.0;
/// Angles of the table, in even steps from 0 to 180 degrees.
const STEPS: usize = 1800;

/// Mean of p over a disc around a direction, by the angle of that direction.
pub(super) struct LookDisc {
    means: Vec<f64>,
}

impl LookDisc {
    pub(super) fn new(phase: &Phase) -> Self {
        let means = (0..=STEPS).map(|step| mean(phase, PI * step as f64 / STEPS as f64));
        Self {
            means: means.collect(),
        }
    }

    /// The mean at a cosine, linearly interpolated.
    pub(super) fn mean(&self, cosine: f64) -> f64 {
        let place = cosine.clamp(-1.0, 1.0).acos() / PI * STEPS as f64;
        let step = (place as usize).min(STEPS - 1);
        let part = place - step as f64;
        self.means[step] + part * (self.means[step + 1] - self.means[step])
    }
}

/// The light of each ring of scattering angles, times the ring's share inside the disc.
fn mean(phase: &Phase, angle: f64) -> f64 {
    let half = HALF_DEG.to_radians();
    let solid = 2.0 * PI * (1.0 - half.cos());
    // Rings much narrower than the disc, over the angles inside it.
    let (low, high) = ((angle - half).max(0.0), (angle + half).min(PI));
    let rings = 400;
    let light = (0..rings).map(|k| {
        let [inner, outer] = [k, k + 1].map(|k| low + (high - low) * (k as f64 / rings as f64).powi(2));
        let share = phase.share_within(angle_versine(outer)) - phase.share_within(angle_versine(inner));
        share * share_in_disc(angle, angle_versine(0.5 * (inner + outer)))
    });
    light.sum::<f64>() / solid
}

/// Share of a ring, by the versine of its angle, inside the disc around a direction at an angle.
fn share_in_disc(angle: f64, versine: f64) -> f64 {
    let half = HALF_DEG.to_radians();
    let (sin, cos) = angle.sin_cos();
    let (ring_cos, ring_sin) = (1.0 - versine, (versine * (2.0 - versine)).max(0.0).sqrt());
    let product = sin * ring_sin;
    let gap = half.cos() - cos * ring_cos;
    if product <= 1e-15 {
        return f64::from(u8::from(gap <= 0.0));
    }
    (gap / product).clamp(-1.0, 1.0).acos() / PI
}

fn angle_versine(angle: f64) -> f64 {
    2.0 * (0.5 * angle).sin().powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disc_holds_the_mean_of_the_phase_function() {
        let phase = Phase::henyey_greenstein(0.9);
        let disc = LookDisc::new(&phase);
        let half = HALF_DEG.to_radians();
        let forward = phase.share_within(1.0 - half.cos()) / (2.0 * PI * (1.0 - half.cos()));
        assert!((disc.mean(1.0) / forward - 1.0).abs() < 1e-3);
        for degrees in [60.0f64, 120.0, 170.0] {
            let cosine = degrees.to_radians().cos();
            let ratio = disc.mean(cosine) / phase.density(1.0 - cosine);
            assert!((ratio - 1.0).abs() < 0.02, "{degrees}: {ratio}");
        }
    }
}
