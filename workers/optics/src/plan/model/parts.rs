//! Model errors of the light of a frame, as numbers: measured on whole frames by
//! `cargo run --release -p renderer --example model_errors` (docs/science/truth.md).

use crate::daylight::{Daylight, SurfaceLight};
use crate::lamp::Lighting;
use crate::water::{Scatter, Water};

/// Measured distance of light from the truth, over the mean of the truth.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct LightError {
    /// Mean of the error.
    pub bias: f64,
    /// Root mean square of the errors of block means.
    pub rms: f64,
}

/// Sources of the light of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sources {
    Lamps,
    Daylight,
    Both,
}

/// The error of frames with one kind of light in one water, known by the channel that scatters most: medians over the frames.
struct MeasuredLight {
    sources: Sources,
    absorption: f64,
    scattering: f64,
    error: LightError,
}

const fn measured(
    sources: Sources,
    [absorption, scattering]: [f64; 2],
    [bias, rms]: [f64; 2],
) -> MeasuredLight {
    MeasuredLight {
        sources,
        absorption,
        scattering,
        error: LightError { bias, rms },
    }
}

/// Sites and plain jobs of `model_errors`, with 1/m and shares of the light.
const MEASURED: [MeasuredLight; 15] = [
    measured(Sources::Lamps, [0.009, 0.025], [0.011, 0.091]),
    measured(Sources::Lamps, [0.016, 0.047], [-0.013, 0.060]),
    measured(Sources::Lamps, [0.042, 0.135], [0.000, 0.039]),
    measured(Sources::Lamps, [0.066, 0.195], [-0.017, 0.062]),
    measured(Sources::Lamps, [0.114, 0.309], [0.003, 0.035]),
    measured(Sources::Lamps, [0.079, 0.358], [-0.002, 0.060]),
    measured(Sources::Daylight, [0.042, 0.135], [-0.030, 0.089]),
    measured(Sources::Daylight, [0.066, 0.195], [-0.028, 0.069]),
    measured(Sources::Daylight, [0.048, 0.215], [-0.029, 0.138]),
    measured(Sources::Daylight, [0.114, 0.309], [-0.024, 0.064]),
    measured(Sources::Both, [0.042, 0.135], [-0.031, 0.081]),
    measured(Sources::Both, [0.031, 0.175], [-0.021, 0.091]),
    measured(Sources::Both, [0.066, 0.195], [-0.030, 0.061]),
    measured(Sources::Both, [0.048, 0.215], [0.005, 0.107]),
    measured(Sources::Both, [0.065, 0.396], [0.026, 0.150]),
];
/// A coefficient b, or b/a, within this factor of a measured one is near it.
const ALIKE: f64 = 1.6;
/// K z of the measured frames by day, with a little more on both sides.
const DEPTHS: std::ops::RangeInclusive<f64> = 0.08..=4.0;
/// Largest b Z of the surfaces of the measured frames.
const THICKEST: f64 = 8.0;

/// The model errors that apply to the parts of a frame's light.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PartErrors {
    /// Of light that arrives unscattered from surfaces; `None` if such conditions were not measured.
    pub unscattered: Option<LightError>,
    /// Of the light of surfaces that arrives scattered.
    pub forward_scatter: Option<LightError>,
    /// Of the light that the water scatters toward the camera.
    pub backscatter: Option<LightError>,
    /// Farthest surfaces whose light was measured, m of the mean water.
    pub farthest_m: f64,
}

impl PartErrors {
    /// The measured errors of similar water and light. Turbid patches count as the mean water along each path.
    /// `is_reflectance`: the picture of the scene emits no light.
    #[must_use]
    pub fn find(water: &Water, lighting: Option<&Lighting>, is_reflectance: bool) -> Self {
        let sources = sources(water, lighting).filter(|_| is_reflectance);
        let Some((a, b)) = water.followed_absorption().zip(water.scattering()) else {
            return Self::of_emission(lighting, is_reflectance);
        };
        let most = (0..3).fold(0, |most, i| if b[i] > b[most] { i } else { most });
        let farthest_m = THICKEST / b[most].max(f64::MIN_POSITIVE);
        let found = sources
            .filter(|sources| *sources == Sources::Lamps || has_measured_sky(water))
            .and_then(|sources| find_alike(sources, a[most], b[most]));
        let Some(error) = found else {
            return Self::of_emission(lighting, is_reflectance);
        };
        let has_kernels = matches!(
            water.scatter(),
            Scatter::Jaffe {
                source: spec::ScatterSource::Radiance,
                tail: Some(_),
                ..
            }
        );
        Self {
            unscattered: Some(error),
            forward_scatter: has_kernels.then_some(error),
            backscatter: Some(error),
            farthest_m,
        }
    }

    /// The errors of other light. If surfaces only emit light, it falls as e^{−cZ} in the truth, too.
    fn of_emission(lighting: Option<&Lighting>, is_reflectance: bool) -> Self {
        let is_emitted = lighting.is_none() && !is_reflectance;
        Self {
            unscattered: is_emitted.then(LightError::default),
            farthest_m: f64::INFINITY,
            ..Self::default()
        }
    }
}

/// The sources of light on surfaces of reflectance; `None` if no frames with such sources were measured.
fn sources(water: &Water, lighting: Option<&Lighting>) -> Option<Sources> {
    let daylight = water.daylight().map(Daylight::surfaces);
    match (lighting.is_some(), daylight) {
        (true, None) if water.veiling_light() == [0.0; 3] => Some(Sources::Lamps),
        (false, Some(SurfaceLight::Normal)) => Some(Sources::Daylight),
        (true, Some(SurfaceLight::Normal)) => Some(Sources::Both),
        _ => None,
    }
}

/// Whether the depth is one of the measured frames by day, in every channel.
fn has_measured_sky(water: &Water) -> bool {
    water.daylight().is_some_and(|daylight| {
        let depths = daylight.fields().map(|field| field.decay * daylight.depth());
        depths.iter().all(|depth| DEPTHS.contains(depth))
    })
}

/// The error in the nearest measured water, if it is near.
fn find_alike(sources: Sources, a: f64, b: f64) -> Option<LightError> {
    let distances = MEASURED
        .iter()
        .filter(|measured| measured.sources == sources)
        .map(|measured| {
            let ratio = (b / a) / (measured.scattering / measured.absorption);
            let apart = (b / measured.scattering).ln().abs().max(ratio.ln().abs());
            (apart, measured.error)
        });
    let (apart, error) = distances.min_by(|(one, _), (other, _)| one.total_cmp(other))?;
    (apart <= ALIKE.ln()).then_some(error)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_water_takes_the_error_of_the_nearest_measured_one_with_the_same_light() {
        for measured in &MEASURED {
            let MeasuredLight {
                sources,
                absorption: a,
                scattering: b,
                error,
            } = *measured;
            assert_eq!(find_alike(sources, a, b), Some(error));
            assert!(error.bias.abs() <= error.rms && error.rms < 1.0, "{error:?}");
        }
        let [clearest, murkiest] = [f64::min, f64::max].map(|choose| {
            let all = MEASURED.iter().map(|measured| measured.scattering);
            all.reduce(choose).unwrap()
        });
        for b in [clearest / 1.7, murkiest * 1.7] {
            assert_eq!(find_alike(Sources::Lamps, b / 3.0, b), None, "b {b}");
        }
        assert_eq!(find_alike(Sources::Lamps, 0.195, 0.195), None, "another ratio");
    }
}
