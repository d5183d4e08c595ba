//! Model error of lamp light: measured in six waters, with the phase function of Fournier and Forand and b_b/b 0.0183, by
//! `cargo run --release -p truth --example lamps` (docs/science/truth.md).

use crate::lamp::{Lamp, Lighting};
use crate::plan::SceneBounds;
use crate::plan::stage::ModelError;
use crate::turbidity::Field;
use crate::water::Water;

/// Distances of the measured walls, m.
const WALLS_M: [f64; 3] = [1.0, 2.0, 4.0];
/// Distances of the measured cameras from their lamp, m.
const CAMERAS_M: [f64; 3] = [0.3, 0.5, 1.0];
/// Distances up to this factor from a measured one use its error.
const NEAR: f64 = 1.5;
/// A coefficient b, or b/a, within this factor of a measured one is near it.
const ALIKE: f64 = 1.6;

/// Chain over truth in one water, least and greatest.
struct Measured {
    absorption: f64,
    scattering: f64,
    /// On a wall within 20 degrees of the axis: points and spots, by distance of the wall.
    surface: [[f64; 3]; 2],
    /// In the water, looking up to 40 degrees toward and away from a point lamp, by distance of the camera.
    point_glow: [[f64; 2]; 3],
    /// In the water, looking along the axis of a spot.
    spot_glow: [f64; 3],
}

const fn measured(
    absorption: f64,
    scattering: f64,
    surface: [[f64; 3]; 2],
    point_glow: [[f64; 2]; 3],
    spot_glow: [f64; 3],
) -> Measured {
    Measured {
        absorption,
        scattering,
        surface,
        point_glow,
        spot_glow,
    }
}

const MEASURED: [Measured; 6] = [
    measured(
        0.114,
        0.037,
        [[0.96, 0.93, 0.86], [0.97, 0.93, 0.87]],
        [[0.69, 1.07], [0.70, 0.93], [0.65, 1.05]],
        [0.59, 0.58, 0.55],
    ),
    measured(
        0.179,
        0.219,
        [[0.80, 0.64, 0.41], [0.82, 0.66, 0.44]],
        [[0.59, 0.99], [0.58, 0.91], [0.50, 0.83]],
        [0.41, 0.34, 0.23],
    ),
    measured(
        0.099,
        0.447,
        [[0.63, 0.40, 0.16], [0.66, 0.43, 0.19]],
        [[0.55, 0.86], [0.39, 0.70], [0.29, 0.58]],
        [0.24, 0.17, 0.07],
    ),
    measured(
        0.118,
        0.675,
        [[0.50, 0.25, 0.064], [0.53, 0.28, 0.08]],
        [[0.41, 0.81], [0.34, 0.66], [0.21, 0.44]],
        [0.19, 0.10, 0.03],
    ),
    measured(
        0.157,
        1.267,
        [[0.27, 0.075, 0.006], [0.31, 0.094, 0.009]],
        [[0.28, 0.62], [0.18, 0.46], [0.07, 0.21]],
        [0.07, 0.03, 0.002],
    ),
    measured(
        0.366,
        1.824,
        [[0.16, 0.025, 0.0007], [0.18, 0.033, 0.001]],
        [[0.24, 0.54], [0.14, 0.35], [0.05, 0.11]],
        [0.04, 0.008, 0.0003],
    ),
];

/// Light of lamps on surfaces.
pub(super) fn surfaces(conditions: &Conditions<'_>) -> Option<ModelError> {
    let (lighting, measured) = single(conditions)?;
    let (_, farthest) = conditions.bounds.range_m?;
    let wall = nearest(&WALLS_M, farthest)?;
    let found = lighting
        .lamps
        .iter()
        .map(|lamp| measured.surface[usize::from(lamp.is_spot())][wall]);
    let at = format!("{} m", WALLS_M[wall]);
    Some(measured.describe("on surfaces", found.map(|share| [share; 2]), &at))
}

/// Light of lamps in the water.
pub(super) fn glow(conditions: &Conditions<'_>) -> Option<ModelError> {
    let (lighting, measured) = single(conditions)?;
    if lighting.phase.rise > 0.0 {
        return None;
    }
    let found = |lamp: &Lamp| {
        let camera = nearest(&CAMERAS_M, lamp.distance_m())?;
        Some(if lamp.is_spot() {
            [measured.spot_glow[camera]; 2]
        } else {
            measured.point_glow[camera]
        })
    };
    let found: Option<Vec<[f64; 2]>> = lighting.lamps.iter().map(found).collect();
    let at = "a lamp beside the camera";
    Some(measured.describe("in the water", found?.into_iter(), at))
}

/// Light of lamps on surfaces with multiple scattering.
pub(super) fn followed_surfaces(conditions: &Conditions<'_>) -> Option<ModelError> {
    let lighting = followed(conditions)?;
    let (_, farthest) = conditions.bounds.range_m?;
    nearest(&WALLS_M, farthest)?;
    let has_spots = lighting.lamps.iter().any(Lamp::is_spot);
    let ratio = if has_spots { [0.89, 1.31] } else { [0.98, 1.04] };
    let [least, most] = ratio;
    let about =
        format!("light on surfaces {least:.2}-{most:.2} of the truth, measured in six waters at 1 to 4 m");
    Some(ModelError::found(ratio, about))
}

/// Airlight of lamps with multiple scattering.
pub(super) fn followed_glow(conditions: &Conditions<'_>) -> Option<ModelError> {
    let lighting = followed(conditions)?;
    let is_near = |lamp: &Lamp| nearest(&CAMERAS_M, lamp.distance_m()).is_some();
    let has_spots = lighting.lamps.iter().any(Lamp::is_spot);
    let ratio = match (lighting.phase.rise > 0.0, has_spots) {
        (false, false) => [0.71, 1.23],
        (false, true) => [0.62, 1.60],
        (true, false) => [0.84, 1.22],
        (true, true) => [0.84, 1.57],
    };
    let [least, most] = ratio;
    let about = format!(
        "light in the water {least:.2}-{most:.2} of the truth, measured in six waters for a lamp beside the camera"
    );
    (lighting.lamps.iter().all(is_near)).then(|| ModelError::found(ratio, about))
}

fn followed<'a>(conditions: &Conditions<'a>) -> Option<&'a Lighting> {
    let lighting = conditions
        .lighting
        .filter(|lighting| lighting.absorption.is_some())?;
    alike(lighting).map(|_| lighting)
}

fn single<'a>(conditions: &Conditions<'a>) -> Option<(&'a Lighting, &'static Measured)> {
    let lighting = conditions
        .lighting
        .filter(|lighting| lighting.absorption.is_none())?;
    alike(lighting).map(|measured| (lighting, measured))
}

/// The measured water that even water is like, by the channel that scatters most.
fn alike(lighting: &Lighting) -> Option<&'static Measured> {
    if lighting.patches.is_some() {
        return None;
    }
    let channels = [0, 1, 2].map(|i| {
        let b = lighting.scattering[i];
        (lighting.attenuation[i] - b, b)
    });
    let (a, b) = channels
        .into_iter()
        .max_by(|one, other| one.1.total_cmp(&other.1))?;
    let apart = |measured: &Measured| {
        let ratio = (b / a) / (measured.scattering / measured.absorption);
        (b / measured.scattering).ln().abs().max(ratio.ln().abs())
    };
    let nearest = MEASURED
        .iter()
        .min_by(|one, other| apart(one).total_cmp(&apart(other)))?;
    (apart(nearest) <= ALIKE.ln()).then_some(nearest)
}

/// Which of some distances is nearest to another, in its logarithm.
fn nearest(measured: &[f64], meters: f64) -> Option<usize> {
    let apart = |i: &usize| (meters / measured[*i]).ln().abs();
    let nearest = (0..measured.len()).min_by(|one, other| apart(one).total_cmp(&apart(other)))?;
    (apart(&nearest) <= NEAR.ln()).then_some(nearest)
}

impl Measured {
    fn describe(&self, what: &str, found: impl Iterator<Item = [f64; 2]>, at: &str) -> ModelError {
        let (low, high) = found.fold((f64::INFINITY, 0.0f64), |(low, high), [least, greatest]| {
            (low.min(least), high.max(greatest))
        });
        let share = if low == high {
            format!("{low}")
        } else {
            format!("{low}-{high}")
        };
        let (a, b) = (self.absorption, self.scattering);
        let about = format!("light {what} {share} of the truth, measured at a {a}, b {b} per meter for {at}");
        ModelError::found([low, high], about)
    }
}

/// Conditions of a measurement.
#[derive(Debug, Clone, Copy)]
pub struct Conditions<'a> {
    /// The water.
    pub water: &'a Water,
    /// The lamps; `None` without.
    pub lighting: Option<&'a Lighting>,
    /// Patches of turbidity; `None` in even water.
    pub patches: Option<&'a Field>,
    /// The scene.
    pub bounds: &'a SceneBounds,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_distance_takes_the_nearest_that_was_measured_or_none() {
        assert_eq!(nearest(&WALLS_M, 2.6), Some(1));
        assert_eq!(nearest(&WALLS_M, 3.0), Some(2));
        assert_eq!((nearest(&WALLS_M, 0.5), nearest(&WALLS_M, 7.0)), (None, None));
    }
}
