//! Custom waters: the same rules and the same self-tests as for the shipped ones.

mod behavior;

use spec::{Fault, Invalid, Optics, OwnWater};

use crate::preset::{self, Preset, diffuse_in_disguise, self_test};
use crate::water::{Water, WaterError};

/// Errors of a custom water.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum OwnError {
    /// Wavelengths out of order.
    #[error("wavelength_nm is {0:?}: red, green and blue must fall in this order")]
    Order([f64; 3]),
    /// The numbers contradict each other or are incomplete.
    #[error(transparent)]
    Water(#[from] WaterError),
    /// A self-test fails.
    #[error("the self-test finds: {0}")]
    Defect(String),
}

impl OwnError {
    /// The field to change; `None` if the error concerns the water as a whole.
    #[must_use]
    pub fn field(&self) -> Option<&'static str> {
        match self {
            Self::Order(_) => Some("wavelength_nm"),
            Self::Water(error) => Some(error.field()),
            Self::Defect(_) => None,
        }
    }
}

/// Reads a custom water and its preset, tested together with `others`, the earlier custom waters.
///
/// # Errors
/// Every error together: fields, limits, contradictions, and failures of the self-tests.
pub fn parse_own(bytes: &[u8], others: &[Preset]) -> Result<(OwnWater, Preset), Invalid> {
    let fault = |error: OwnError| Fault {
        path: error.field().into_iter().collect(),
        message: error.to_string(),
        missing: matches!(error, OwnError::Water(WaterError::Missing { .. })),
    };
    OwnWater::parse(bytes, |water| {
        own(water, others).map_err(|errors| errors.into_iter().map(fault).collect())
    })
}

/// The preset of a custom water, tested alone and together with those of the same source.
///
/// # Errors
/// Everything that is wrong with it, together.
pub fn own(new: &OwnWater, others: &[Preset]) -> Result<Preset, Vec<OwnError>> {
    let [red, green, blue] = new.wavelength_nm;
    let mut errors = Vec::new();
    if !(red > green && green > blue) {
        errors.push(OwnError::Order(new.wavelength_nm));
    }
    let preset = preset_of(new);
    // If a, b and c are all given, c has to be their sum: the description needs all three for the check.
    let optics = Optics {
        beam_attenuation_per_m: new.beam_attenuation_per_m,
        ..preset.optics()
    };
    let contradictions = Water::validate(&optics.into(), false);
    errors.extend(contradictions.into_iter().map(OwnError::Water));
    if errors.is_empty() {
        let beside: Vec<Preset> = others
            .iter()
            .filter(|other| other.source == preset.source)
            .cloned()
            .chain([preset.clone()])
            .collect();
        let known = self_test(&beside[..beside.len() - 1]);
        let found = self_test(&beside)
            .into_iter()
            .filter(|defect| !known.contains(defect));
        errors.extend(found.map(|defect| OwnError::Defect(format!("{}: {}", defect.preset, defect.what))));
        errors.extend(
            behavior::test(&preset, behavior::OURS)
                .into_iter()
                .map(OwnError::Defect),
        );
    }
    if !errors.is_empty() {
        return Err(errors);
    }
    let disguised = new.beam_attenuation_per_m.and_then(|c| {
        let whose = if new.diffuse_attenuation_per_m == Some(c) { "this water itself" } else { diffuse_in_disguise(c)? };
        Some(format!("its beam attenuation is the K_d of {whose}: K_d is the decay of daylight with depth, and too small"))
    });
    let warnings = preset::warnings(&preset).into_iter().chain(disguised).collect();
    Ok(Preset { warnings, ..preset })
}

fn preset_of(new: &OwnWater) -> Preset {
    let channels = |values: Option<[f64; 3]>| values.map_or([None; 3], |values| values.map(Some));
    let sum = new
        .absorption_per_m
        .zip(new.scattering_per_m)
        .map(|(a, b)| [0, 1, 2].map(|i| a[i] + b[i]));
    Preset {
        jerlov_type: new.jerlov_type.clone(),
        caveats: new.caveats.clone(),
        wavelength_nm: new.wavelength_nm.map(Some),
        absorption: channels(new.absorption_per_m),
        scattering: channels(new.scattering_per_m),
        beam_attenuation: channels(sum.or(new.beam_attenuation_per_m)),
        diffuse_attenuation: channels(new.diffuse_attenuation_per_m),
        backscatter_fraction: new.backscatter_fraction,
        veiling_light: new.veiling_light,
        derived: sum
            .filter(|_| new.beam_attenuation_per_m.is_none())
            .map(|_| "beam_attenuation_per_m")
            .into_iter()
            .collect(),
        ..Preset::unknown(&new.name, &new.source, &new.licence)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn good() -> OwnWater {
        OwnWater {
            name: "harbour".to_owned(),
            source: "a transmissometer".to_owned(),
            licence: "unknown".to_owned(),
            wavelength_nm: [650.0, 550.0, 450.0],
            absorption_per_m: Some([0.4, 0.2, 0.5]),
            scattering_per_m: Some([1.0, 1.1, 1.3]),
            diffuse_attenuation_per_m: Some([0.6, 0.4, 0.8]),
            ..OwnWater::default()
        }
    }

    fn errors(new: &OwnWater, others: &[Preset]) -> Vec<String> {
        own(new, others)
            .unwrap_err()
            .iter()
            .map(ToString::to_string)
            .collect()
    }

    #[test]
    fn a_good_water_is_complete_and_can_be_rendered() {
        let preset = own(&good(), &[]).unwrap();
        assert_eq!(preset.beam_attenuation[2], Some(1.8));
        assert_eq!(
            (preset.unrenderable(), preset.licence.as_str()),
            (None, "unknown")
        );
        assert!(preset.warnings.is_empty(), "{:?}", preset.warnings);
    }

    #[test]
    fn everything_that_is_wrong_is_said_at_once() {
        let wrong = OwnWater {
            wavelength_nm: [450.0, 550.0, 650.0],
            absorption_per_m: Some([-0.4, 0.2, f64::NAN]),
            scattering_per_m: None,
            diffuse_attenuation_per_m: None,
            ..good()
        };
        let found = errors(&wrong, &[]);
        for words in [
            "must fall in this order",
            "absorption_per_m is -0.4 in R",
            "absorption_per_m is NaN in B",
            "beam_attenuation_per_m is missing",
            "veiling_light is missing",
        ] {
            assert!(
                found.iter().any(|error| error.contains(words)),
                "{words}: {found:#?}"
            );
        }
    }

    #[test]
    fn a_water_against_the_order_of_its_source_is_refused() {
        let kind = |kind: &str| OwnWater {
            jerlov_type: Some(kind.to_owned()),
            ..good()
        };
        let clear = own(&kind("1C"), &[]).unwrap();
        let clearer = OwnWater {
            absorption_per_m: Some([0.3, 0.1, 0.4]),
            name: "other".to_owned(),
            ..kind("9C")
        };
        let clearer = OwnWater {
            diffuse_attenuation_per_m: Some([0.6, 0.4, 0.8]),
            ..clearer
        };
        let found = errors(&clearer, std::slice::from_ref(&clear));
        assert!(
            found[0].contains("other: less beam attenuation than harbour in red"),
            "{found:?}"
        );
        let transmission = OwnWater {
            absorption_per_m: Some([0.3, 0.96, 0.98]),
            ..kind("I")
        };
        assert!(
            errors(&transmission, &[])
                .iter()
                .any(|e| e.contains("clear water attenuates"))
        );
    }

    #[test]
    fn a_sum_that_does_not_add_up_is_refused_and_a_thin_water_is_warned_of() {
        let sum = OwnWater {
            beam_attenuation_per_m: Some([2.0; 3]),
            ..good()
        };
        assert!(errors(&sum, &[])[0].contains("absorption and scattering sum to 1.4"));
        let thin = OwnWater {
            absorption_per_m: None,
            scattering_per_m: None,
            beam_attenuation_per_m: Some([0.36, 0.063, 0.019]),
            ..good()
        };
        let warnings = own(&thin, &[]).unwrap().warnings;
        assert!(warnings[0].contains("below pure sea water"), "{warnings:?}");
        assert!(
            warnings[1].contains("the K_d of jerlov-I/solonenko2015"),
            "{warnings:?}"
        );
    }
}
