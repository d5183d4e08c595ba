//! A water of a user's own: the same rules and the same self-tests as for the shipped ones.

use super::{Preset, behaviour, diffuse_in_disguise, pure_water, self_test};
use crate::water::{Water, WaterError};

/// The longest name and the longest text of a source, in characters.
const LONGEST_NAME: usize = 64;
const LONGEST_TEXT: usize = 1000;
const MOST_CAVEATS: usize = 16;
/// What a camera of visible light sees, and a little more, nm.
const LEAST_NM: f64 = 300.0;
const MOST_NM: f64 = 1000.0;
/// The types that a water may be of.
pub const JERLOV_TYPES: [&str; 15] = [
    "I", "IA", "IB", "II", "III", "1C", "3C", "5C", "7C", "9C", "1", "3", "5", "7", "9",
];

/// What a user gives. Arrays are red, green, blue; coefficients in 1/m; absent means unknown.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct NewWater {
    /// 1..=64 letters, digits, `.`, `_` and `-`, the first a letter or digit.
    pub name: String,
    /// Jerlov's type, if it is one: I to III, 1C to 9C, 1 to 9.
    pub jerlov_type: Option<String>,
    /// Where the numbers come from.
    pub source: String,
    /// Under what terms they may be used.
    pub licence: Option<String>,
    /// What others should know.
    pub caveats: Vec<String>,
    /// Wavelengths that stand for red, green and blue, nm, falling.
    pub wavelength_nm: Option<[f64; 3]>,
    /// a.
    pub absorption: Option<[f64; 3]>,
    /// b.
    pub scattering: Option<[f64; 3]>,
    /// c; with a and b it is their sum.
    pub beam_attenuation: Option<[f64; 3]>,
    /// K_d.
    pub diffuse_attenuation: Option<[f64; 3]>,
    /// b_b/b.
    pub backscatter_fraction: Option<f64>,
    /// Veiling light, linear.
    pub veiling_light: Option<[f64; 3]>,
}

/// What is wrong with a water of a user's own.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum OwnError {
    /// A text or a wavelength breaks its rule.
    #[error("{field} {problem}")]
    Field {
        /// The field.
        field: &'static str,
        /// What is wrong with it.
        problem: String,
    },
    /// The numbers contradict each other or leave a gap.
    #[error(transparent)]
    Water(#[from] WaterError),
    /// A self-test fails.
    #[error("the self-test finds: {0}")]
    Defect(String),
}

impl OwnError {
    /// The field that has to change; none where the water as a whole is wrong.
    #[must_use]
    pub fn field(&self) -> Option<&'static str> {
        match self {
            Self::Field { field, .. } => Some(field),
            Self::Water(error) => Some(error.field()),
            Self::Defect(_) => None,
        }
    }
}

/// The preset of a user's water, tested alone and beside those of the same source.
///
/// # Errors
/// Everything that is wrong with it, together.
pub fn own(new: &NewWater, others: &[Preset]) -> Result<Preset, Vec<OwnError>> {
    let mut errors = texts(new);
    errors.extend(wavelengths(new.wavelength_nm));
    let preset = preset(new);
    // Where a, b and c are all given, c has to be their sum: the request takes all three to check it.
    let mut request = preset.request();
    request.beam_attenuation = new.beam_attenuation;
    errors.extend(Water::validate(&request).into_iter().map(OwnError::Water));
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
            behaviour::test(&preset, behaviour::OURS)
                .into_iter()
                .map(OwnError::Defect),
        );
    }
    if !errors.is_empty() {
        return Err(errors);
    }
    let disguised = new.beam_attenuation.and_then(|c| {
        let whose = if new.diffuse_attenuation == Some(c) { "this water itself" } else { diffuse_in_disguise(c)? };
        Some(format!("its beam attenuation is the K_d of {whose}: K_d is the decay of daylight with depth, and too small"))
    });
    let warnings = pure_water::warnings(&preset)
        .into_iter()
        .chain(disguised)
        .collect();
    Ok(Preset { warnings, ..preset })
}

fn preset(new: &NewWater) -> Preset {
    let channels = |values: Option<[f64; 3]>| values.map_or([None; 3], |values| values.map(Some));
    let sum = new
        .absorption
        .zip(new.scattering)
        .map(|(a, b)| [0, 1, 2].map(|i| a[i] + b[i]));
    Preset {
        jerlov_type: new.jerlov_type.clone(),
        caveats: new.caveats.clone(),
        wavelength_nm: channels(new.wavelength_nm),
        absorption: channels(new.absorption),
        scattering: channels(new.scattering),
        beam_attenuation: channels(sum.or(new.beam_attenuation)),
        diffuse_attenuation: channels(new.diffuse_attenuation),
        backscatter_fraction: new.backscatter_fraction,
        veiling_light: new.veiling_light,
        derived: sum
            .filter(|_| new.beam_attenuation.is_none())
            .map(|_| "beam_attenuation_per_m")
            .into_iter()
            .collect(),
        ..Preset::unknown(
            &new.name,
            &new.source,
            new.licence.as_deref().unwrap_or("unknown"),
        )
    }
}

fn texts(new: &NewWater) -> Vec<OwnError> {
    let mut errors = Vec::new();
    let mut refuse = |field, problem: String| errors.push(OwnError::Field { field, problem });
    let plain = |c: char| c.is_ascii_alphanumeric() || "._-".contains(c);
    let starts = new.name.starts_with(|c: char| c.is_ascii_alphanumeric());
    if !starts || new.name.len() > LONGEST_NAME || !new.name.chars().all(plain) {
        let rule = "must be 1 to 64 of A-Z a-z 0-9 . _ - and begin with a letter or digit";
        refuse("name", format!("{:?} {rule}", shortened(&new.name)));
    }
    if let Some(kind) = new
        .jerlov_type
        .as_deref()
        .filter(|kind| !JERLOV_TYPES.contains(kind))
    {
        let rule = format!("{:?} is none of {}", shortened(kind), JERLOV_TYPES.join(", "));
        refuse("jerlov_type", rule);
    }
    if new.source.trim().is_empty() {
        refuse("source", "is empty: say where the numbers come from".to_owned());
    }
    let licence = new.licence.as_deref().unwrap_or_default();
    let texts = [("source", new.source.as_str()), ("licence", licence)];
    let caveats = new.caveats.iter().map(|caveat| ("caveats", caveat.as_str()));
    for (field, text) in texts.into_iter().chain(caveats) {
        if text.chars().count() > LONGEST_TEXT {
            refuse(
                field,
                format!(
                    "has {} characters, the limit is {LONGEST_TEXT}",
                    text.chars().count()
                ),
            );
        }
    }
    if new.caveats.len() > MOST_CAVEATS {
        refuse(
            "caveats",
            format!("has {} entries, the limit is {MOST_CAVEATS}", new.caveats.len()),
        );
    }
    errors
}

fn wavelengths(given: Option<[f64; 3]>) -> Option<OwnError> {
    let problem = match given {
        None => "is missing: the wavelengths in nm that stand for red, green and blue".to_owned(),
        Some(nm) if !nm.iter().all(|nm| (LEAST_NM..=MOST_NM).contains(nm)) => {
            format!("is {nm:?}, the limit is {LEAST_NM}..={MOST_NM} nm each")
        }
        Some(nm) if !(nm[0] > nm[1] && nm[1] > nm[2]) => {
            format!("is {nm:?}: red, green and blue must fall in this order")
        }
        Some(_) => return None,
    };
    Some(OwnError::Field {
        field: "wavelength_nm",
        problem,
    })
}

fn shortened(text: &str) -> String {
    text.chars().take(LONGEST_NAME + 1).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn good() -> NewWater {
        NewWater {
            name: "harbour".to_owned(),
            source: "a transmissometer".to_owned(),
            wavelength_nm: Some([650.0, 550.0, 450.0]),
            absorption: Some([0.4, 0.2, 0.5]),
            scattering: Some([1.0, 1.1, 1.3]),
            diffuse_attenuation: Some([0.6, 0.4, 0.8]),
            ..NewWater::default()
        }
    }

    fn errors(new: &NewWater, others: &[Preset]) -> Vec<String> {
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
        let wrong = NewWater {
            name: "../x".to_owned(),
            jerlov_type: Some("XII".to_owned()),
            source: " ".to_owned(),
            wavelength_nm: Some([450.0, 550.0, 650.0]),
            absorption: Some([-0.4, 0.2, f64::NAN]),
            scattering: None,
            diffuse_attenuation: None,
            ..good()
        };
        let found = errors(&wrong, &[]);
        for words in [
            "name \"../x\"",
            "jerlov_type \"XII\"",
            "source is empty",
            "must fall in this order",
            "absorption_per_m is -0.4 in channel R",
            "absorption_per_m is NaN in channel B",
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
        let kind = |kind: &str| NewWater {
            jerlov_type: Some(kind.to_owned()),
            ..good()
        };
        let clear = own(&kind("1C"), &[]).unwrap();
        let clearer = NewWater {
            absorption: Some([0.3, 0.1, 0.4]),
            name: "other".to_owned(),
            ..kind("9C")
        };
        let clearer = NewWater {
            diffuse_attenuation: Some([0.6, 0.4, 0.8]),
            ..clearer
        };
        let found = errors(&clearer, std::slice::from_ref(&clear));
        assert!(
            found[0].contains("other: less beam attenuation than harbour in red"),
            "{found:?}"
        );
        let transmission = NewWater {
            absorption: Some([0.3, 0.96, 0.98]),
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
        let sum = NewWater {
            beam_attenuation: Some([2.0; 3]),
            ..good()
        };
        assert!(errors(&sum, &[])[0].contains("absorption and scattering sum to 1.4"));
        let thin = NewWater {
            absorption: None,
            scattering: None,
            beam_attenuation: Some([0.36, 0.063, 0.019]),
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
