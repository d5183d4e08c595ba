//! Reading a water of a user's own.

use optics::preset::{NewWater, OwnError, Preset, all_known, own};
use optics::water::WaterError;
use serde::Deserialize;
use serde_json::{Map, Value, json};

use crate::check::{Checker, Place};
use crate::fields::OWN_WATER;
use crate::invalid::{FieldError, Invalid};
use crate::json;
use crate::vocabulary::Vocabulary;

/// A water of a user's own that has passed all checks.
#[derive(Debug, Clone, PartialEq)]
pub struct OwnWater {
    /// Its numbers, with its warnings.
    pub preset: Preset,
    /// As it was submitted, in canonical form.
    pub description: String,
    /// The fields of `water.optics` that stand for its name in a job.
    pub optics: Map<String, Value>,
}

/// What passed the table of fields.
#[derive(Default, Deserialize)]
#[serde(default)]
struct Body {
    name: String,
    source: String,
    licence: Option<String>,
    caveats: Vec<String>,
    jerlov_type: Option<String>,
    wavelength_nm: Option<[f64; 3]>,
    absorption_per_m: Option<[f64; 3]>,
    scattering_per_m: Option<[f64; 3]>,
    beam_attenuation_per_m: Option<[f64; 3]>,
    diffuse_attenuation_per_m: Option<[f64; 3]>,
    backscatter_fraction: Option<f64>,
    veiling_light: Option<[f64; 3]>,
}

const COEFFICIENTS: [&str; 4] = [
    "/absorption_per_m",
    "/scattering_per_m",
    "/beam_attenuation_per_m",
    "/diffuse_attenuation_per_m",
];

impl OwnWater {
    /// Reads and checks a water, alone and beside `others`, the waters that users have given before.
    ///
    /// # Errors
    /// Every error together: fields, limits, contradictions, and what the self-tests find.
    pub fn parse(bytes: &[u8], others: &[Preset]) -> Result<Self, Invalid> {
        let value = json::read(bytes)?;
        let vocabulary = Vocabulary::default();
        let mut checker = Checker {
            vocabulary: &vocabulary,
            seed: 0,
            errors: Vec::new(),
        };
        let Some(node) = checker.node(&Place::default(), &OWN_WATER, false, &value) else {
            return Err(Invalid(checker.errors));
        };
        let canonical = node.canonical();
        let body = Body::deserialize(&canonical).unwrap_or_default();
        let has_error = |pointer: &str| checker.errors.iter().any(|error| error.pointer == pointer);
        let in_numbers = COEFFICIENTS.iter().any(|&field| {
            checker
                .errors
                .iter()
                .any(|error| error.pointer.starts_with(field))
        });
        let new = body.into();
        let tested = own(&new, others);
        let more: Vec<FieldError> = tested
            .as_ref()
            .err()
            .into_iter()
            .flatten()
            // A number that is refused is neither missing nor known.
            .filter(|error| !(in_numbers && matches!(error, OwnError::Water(WaterError::Missing { .. }))))
            .map(|error| {
                let pointer = error.field().map(|field| format!("/{field}")).unwrap_or_default();
                FieldError::new(&pointer, error.to_string())
            })
            .filter(|error| !has_error(&error.pointer))
            .collect();
        checker.errors.extend(more);
        match tested {
            Ok(preset) if checker.errors.is_empty() => Ok(Self {
                optics: optics(&new, &preset),
                preset,
                description: canonical.to_string(),
            }),
            _ => Err(Invalid(checker.errors)),
        }
    }
}

impl From<Body> for NewWater {
    fn from(body: Body) -> Self {
        Self {
            name: body.name,
            jerlov_type: body.jerlov_type,
            source: body.source,
            licence: body.licence,
            caveats: body.caveats,
            wavelength_nm: body.wavelength_nm,
            absorption: body.absorption_per_m,
            scattering: body.scattering_per_m,
            beam_attenuation: body.beam_attenuation_per_m,
            diffuse_attenuation: body.diffuse_attenuation_per_m,
            backscatter_fraction: body.backscatter_fraction,
            veiling_light: body.veiling_light,
        }
    }
}

/// The beam attenuation is left to a and b where both are known.
fn optics(new: &NewWater, preset: &Preset) -> Map<String, Value> {
    let parts = new.absorption.is_some() && new.scattering.is_some();
    let beam = all_known(preset.beam_attenuation).filter(|_| !parts);
    let fields = [
        ("absorption_per_m", json!(new.absorption)),
        ("scattering_per_m", json!(new.scattering)),
        ("beam_attenuation_per_m", json!(beam)),
        ("diffuse_attenuation_per_m", json!(new.diffuse_attenuation)),
        ("backscatter_fraction", json!(new.backscatter_fraction)),
        ("veiling_light", json!(new.veiling_light)),
    ];
    let known = fields.into_iter().filter(|(_, value)| !value.is_null());
    known.map(|(field, value)| (field.to_owned(), value)).collect()
}
