//! Derivation of values missing from a preset or request, and all the checks.
//!
//! G = a + 0.05 b and γ(Z) = f (0.009 + 0.009 b Z) are fits to Monte Carlo runs in Fournier–Forand and Henyey–Greenstein
//! waters up to b Z of about 6. A derived veiling light has the color of daylight at the depth, exp(−K_d h), and by
//! convention the brightness `veil_gain` in its brightest channel, since a camera exposes.

mod above;
mod checks;
mod scatter;

use super::WaterError;
use super::model::{Scatter, Water};
use crate::daylight::DaylightModel;
use crate::lamp::AVERAGE_BACKSCATTER_FRACTION;
use crate::medium::{Ambient, Medium};
use crate::preset::{self, Channels, Preset, all_known};
pub(super) use checks::Request;
use checks::{Checks, Coefficients};
use scatter::scaled_scatter;

const VEIL_GAIN: f64 = 0.3;
const VEIL_DEPTH_M: f64 = 5.0;

/// Printed tables round a, b and c to three decimals each.
const SUM_SLACK_PER_M: f64 = 0.002;
const CHANNELS: [char; 3] = ['R', 'G', 'B'];

/// The checked numbers of a water, before daylight is solved for: a description is checked for thousands of draws.
pub(super) struct Inputs {
    preset: Option<&'static Preset>,
    absorption: Option<[f64; 3]>,
    pub(super) scattering: Option<[f64; 3]>,
    attenuation: [f64; 3],
    /// Given, or of the preset.
    diffuse_attenuation: Option<[f64; 3]>,
    /// `None` in daylight, which sets it.
    veiling_light: Option<[f64; 3]>,
    backscatter_fraction: Option<f64>,
    scatter: Scatter,
    daylight: Option<above::Inputs>,
    derived: Vec<&'static str>,
}

/// Checks a request.
///
/// # Errors
/// All contradictions and gaps.
pub(super) fn check(request: &Request<'_>, focal_px: f64) -> Result<Inputs, Vec<WaterError>> {
    let water = request.medium;
    let optics = &water.optics;
    let mut checks = Checks::default();
    checks.limits(request);
    let preset = optics.preset.as_deref().and_then(|name| checks.preset(name));
    // An unknown preset may contain any other number.
    let is_complete = preset.is_some() || optics.preset.is_none();
    // A given beam attenuation replaces the preset's whole decomposition: a and b of another water would contradict it.
    let decomposition = preset.filter(|_| optics.beam_attenuation_per_m.is_none());
    let part = |given: Option<[f64; 3]>, own: fn(&Preset) -> Channels| {
        given.or(decomposition.and_then(|preset| all_known(own(preset))))
    };
    let absorption = part(optics.absorption_per_m, |preset| preset.absorption);
    let scattering = part(optics.scattering_per_m, |preset| preset.scattering);
    let sum = absorption.zip(scattering).map(|(a, b)| each(|i| a[i] + b[i]));
    match sum {
        Some(sum) => checks.sum(sum, optics.beam_attenuation_per_m),
        None => {
            for (field, part) in [("absorption_per_m", absorption), ("scattering_per_m", scattering)] {
                checks.within_attenuation(field, part, optics.beam_attenuation_per_m);
            }
        }
    }
    let attenuation = part(optics.beam_attenuation_per_m.or(sum), |preset| {
        preset.beam_attenuation
    });
    if attenuation.is_none() && is_complete {
        let reason = "give it, or both absorption_per_m and scattering_per_m";
        checks.missing("beam_attenuation_per_m", reason);
    }
    let backscatter_fraction = optics
        .backscatter_fraction
        .or(preset.and_then(|p| p.backscatter_fraction));
    let known = above::Known {
        absorption,
        scattering,
        backscatter_fraction,
        is_complete,
        focal_px,
    };
    let daylight = checks.daylight(request, &known);
    let diffuse_attenuation = optics
        .diffuse_attenuation_per_m
        .or(preset.and_then(|p| all_known(p.diffuse_attenuation)));
    let veiling_light = checks.veil(request, preset, diffuse_attenuation, is_complete);
    let coefficients = Coefficients {
        absorption,
        scattering,
        attenuation,
        focal_px,
    };
    let scatter = checks.scatter(water, &coefficients);
    checks.lamps(request, scattering.is_some() || !is_complete);
    if !checks.errors.is_empty() {
        return Err(checks.errors);
    }
    Ok(Inputs {
        preset,
        absorption,
        scattering,
        attenuation: attenuation.expect("its absence is an error above"),
        diffuse_attenuation,
        veiling_light,
        backscatter_fraction,
        scatter,
        daylight,
        derived: checks.derived,
    })
}

/// The water of a request: checked, and with its daylight solved for.
pub(super) fn resolve(request: &Request<'_>, focal_px: f64) -> Result<Water, Vec<WaterError>> {
    let inputs = check(request, focal_px)?;
    let water = request.medium;
    let daylight = inputs.daylight.map(above::Inputs::solve);
    let diffuse_attenuation = daylight
        .map(|daylight| {
            daylight
                .fields
                .each_ref()
                .map(|field| field.decay / daylight.scale)
        })
        .or(inputs.diffuse_attenuation);
    let scale = water.range_scale;
    let scaled = |values: [f64; 3]| values.map(|v| v * scale);
    Ok(Water {
        preset: inputs.preset.map(|p| p.name.as_str()),
        absorption: inputs.absorption.map(scaled),
        scattering: inputs.scattering.map(scaled),
        direct_attenuation: scaled(inputs.attenuation),
        backscatter_attenuation: scaled(
            water
                .optics
                .backscatter_attenuation_per_m
                .unwrap_or(inputs.attenuation),
        ),
        diffuse_attenuation,
        veiling_light: daylight
            .map(|daylight| daylight.horizon_light())
            .or(inputs.veiling_light)
            .expect("its absence is an error of the check"),
        radiance_gain: above::gain(request, daylight.as_ref())
            .unwrap_or_else(|| radiance_gain(water.ambient, decay(request, diffuse_attenuation))),
        scatter: scaled_scatter(inputs.scatter, scale),
        backscatter_fraction: inputs
            .backscatter_fraction
            .unwrap_or(AVERAGE_BACKSCATTER_FRACTION),
        glow_phase: water.airlight_phase,
        daylight,
        holes: water.holes,
        derived: inputs.derived,
    })
}

/// exp(−K_d h) if depth and K_d are known.
fn decay(request: &Request<'_>, diffuse_attenuation: Option<[f64; 3]>) -> Option<[f64; 3]> {
    let known = request.medium.depth_m.zip(diffuse_attenuation);
    known.map(|(h, kd)| kd.map(|k| (-k * h).exp()))
}

fn each(value: impl FnMut(usize) -> f64) -> [f64; 3] {
    [0, 1, 2].map(value)
}

fn radiance_gain(ambient: Ambient, decay: Option<[f64; 3]>) -> [f64; 3] {
    let decay = decay.unwrap_or([1.0; 3]);
    match ambient {
        Ambient::None => [1.0; 3],
        Ambient::Absolute => decay,
        Ambient::Exposed => {
            let brightest = decay.into_iter().fold(f64::MIN_POSITIVE, f64::max);
            decay.map(|e| e / brightest)
        }
    }
}

impl Checks {
    /// Every number within the limits of its field.
    fn limits(&mut self, request: &Request<'_>) {
        let Medium {
            optics,
            range_scale,
            depth_m,
            holes,
            daylight,
            ..
        } = request.medium;
        let described = spec::Water {
            range_scale: *range_scale,
            depth_m: *depth_m,
            ..spec::Water::default()
        };
        let all = [
            spec::beyond(optics),
            optics.forward_scatter.iter().flat_map(spec::beyond).collect(),
            spec::beyond(&described),
            spec::beyond(holes),
            daylight.iter().flat_map(DaylightModel::beyond).collect(),
        ];
        let all = all.into_iter().flatten();
        self.errors.extend(all.map(WaterError::Beyond));
    }

    fn missing(&mut self, field: &'static str, reason: &'static str) {
        self.errors.push(WaterError::Missing { field, reason });
    }

    fn preset(&mut self, name: &str) -> Option<&'static Preset> {
        let found = preset::find(name);
        if found.is_none() {
            let name = name.to_owned();
            self.errors.push(WaterError::UnknownPreset { name });
        }
        found
    }

    /// A given c is a + b.
    fn sum(&mut self, sum: [f64; 3], given: Option<[f64; 3]>) {
        let Some(c) = given else { return };
        for i in (0..3).filter(|&i| (c[i] - sum[i]).abs() > SUM_SLACK_PER_M) {
            self.errors.push(WaterError::Inconsistent {
                channel: CHANNELS[i],
                value: c[i],
                sum: sum[i],
            });
        }
    }

    /// Inputs of the airlight of lamps.
    fn lamps(&mut self, request: &Request<'_>, scatters: bool) {
        if !request.lamps {
            return;
        }
        if request.medium.optics.backscatter_fraction.is_none() {
            self.derived.push("backscatter_fraction");
        }
        if !scatters {
            let reason = "the glow of the water before the lamps comes from it";
            self.missing("scattering_per_m", reason);
        }
    }

    /// The given or derived veil; `None` in daylight, which sets it.
    fn veil(
        &mut self,
        request: &Request<'_>,
        preset: Option<&Preset>,
        diffuse_attenuation: Option<[f64; 3]>,
        is_complete: bool,
    ) -> Option<[f64; 3]> {
        let water = request.medium;
        if water.daylight.is_some() {
            return None;
        }
        let decay = self.decay(request, diffuse_attenuation);
        let given = water.optics.veiling_light;
        let veil = match given.or(preset.and_then(|p| p.veiling_light)) {
            Some(veil) if water.ambient == Ambient::Absolute => {
                return decay.map(|decay| each(|i| veil[i] * decay[i]));
            }
            Some(veil) => Some(veil),
            None => self.daylight_veil(request, diffuse_attenuation),
        };
        if veil.is_none() && is_complete {
            let reason = "give it, or diffuse_attenuation_per_m to derive its color from";
            self.missing("veiling_light", reason);
        }
        veil
    }

    /// The decay of ambient light with depth; an error if it is needed and not known.
    fn decay(&mut self, request: &Request<'_>, diffuse_attenuation: Option<[f64; 3]>) -> Option<[f64; 3]> {
        let decay = decay(request, diffuse_attenuation);
        if request.medium.ambient != Ambient::None && decay.is_none() {
            let field = if request.medium.depth_m.is_none() {
                "depth_m"
            } else {
                "diffuse_attenuation_per_m"
            };
            self.missing(field, "ambient light decays with it");
        }
        decay
    }

    /// The veil that daylight at the depth colors, where K_d is known.
    fn daylight_veil(
        &mut self,
        request: &Request<'_>,
        diffuse_attenuation: Option<[f64; 3]>,
    ) -> Option<[f64; 3]> {
        let depth_m = request.medium.depth_m.unwrap_or(VEIL_DEPTH_M);
        let daylight = diffuse_attenuation?.map(|k| (-k * depth_m).exp());
        self.derived.push("veiling_light");
        let brightest = daylight.into_iter().fold(f64::MIN_POSITIVE, f64::max);
        Some(daylight.map(|e| request.medium.optics.veil_gain.unwrap_or(VEIL_GAIN) * e / brightest))
    }

    /// Checks that a part of the beam attenuation does not exceed it in any channel.
    fn within_attenuation(&mut self, field: &'static str, part: Option<[f64; 3]>, whole: Option<[f64; 3]>) {
        let Some((part, whole)) = part.zip(whole) else {
            return;
        };
        for i in (0..3).filter(|&i| part[i] > whole[i]) {
            let (channel, value, limit) = (CHANNELS[i], part[i], whole[i]);
            self.errors.push(WaterError::MoreThanAttenuation {
                field,
                channel,
                value,
                limit,
            });
        }
    }
}
