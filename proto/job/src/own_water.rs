//! User-defined waters as submitted.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};
use spec_derive::Described;

use crate::check::{Checker, Location};
use crate::described::Described;
use crate::invalid::{FieldError, Invalid};
use crate::json;
use crate::rules::Fault;
use crate::vocabulary::Vocabulary;
use crate::water::Optics;

/// Jerlov water types.
pub const JERLOV_TYPES: [&str; 15] = [
    "I", "IA", "IB", "II", "III", "1C", "3C", "5C", "7C", "9C", "1", "3", "5", "7", "9",
];

/// A user-defined water. Arrays are R, G, B; an absent value is unknown.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, Described)]
#[serde(default)]
pub struct OwnWater {
    /// name of the water in jobs
    #[field(fixed, names = WaterName)]
    pub name: String,
    /// source of the numbers
    #[field(fixed, names = Words)]
    pub source: String,
    /// license of the numbers
    #[field(fixed, names = Words, default = "unknown")]
    pub licence: String,
    /// notes for users of the water
    #[field(fixed, names = Words, max = 16, distinct, default = [])]
    pub caveats: Vec<String>,
    /// Jerlov type, checked against the neighboring types of the same source
    #[field(fixed, words = JERLOV_TYPES)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub jerlov_type: Option<String>,
    /// wavelengths of red, green and blue, in falling order
    #[field(fixed, within(300.0, 1000.0), unit = "nm")]
    pub wavelength_nm: [f64; 3],
    /// a
    #[field(fixed, within(0.0, 1000.0), unit = "1/m")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub absorption_per_m: Option<[f64; 3]>,
    /// b
    #[field(fixed, within(0.0, 1000.0), unit = "1/m")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scattering_per_m: Option<[f64; 3]>,
    /// c; a + b by default
    #[field(fixed, within(0.0, 1000.0), unit = "1/m")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beam_attenuation_per_m: Option<[f64; 3]>,
    /// K_d, the decay of daylight with depth
    #[field(fixed, within(0.0, 1000.0), unit = "1/m")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub diffuse_attenuation_per_m: Option<[f64; 3]>,
    /// b_b/b, for the airlight of lamps
    #[field(fixed, within(0.002, 0.5))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub backscatter_fraction: Option<f64>,
    /// backscatter radiance at infinite range, linear; derived from K_d by default
    #[field(fixed, within(0.0, 1000.0))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub veiling_light: Option<[f64; 3]>,
}

impl OwnWater {
    /// Parses a water and checks it, field by field and then with `test`, which checks the physics.
    ///
    /// # Errors
    /// All errors of fields and limits, and those of `test`.
    pub fn parse<T>(
        bytes: &[u8],
        test: impl FnOnce(&Self) -> Result<T, Vec<Fault>>,
    ) -> Result<(Self, T), Invalid> {
        let value = json::read(bytes)?;
        let vocabulary = Vocabulary::default();
        let mut checker = Checker::new(&vocabulary, 0);
        let Some(node) = checker.check(&Location::default(), &Self::SHAPE, false, &value) else {
            return Err(Invalid(checker.errors));
        };
        let water = Self::deserialize(node.canonical()).unwrap_or_default();
        let tested = test(&water);
        let mut errors = checker.errors;
        let more = tested.as_ref().err().map(|faults| new_errors(faults, &errors));
        errors.extend(more.into_iter().flatten());
        match tested {
            Ok(found) if errors.is_empty() => Ok((water, found)),
            _ => Err(Invalid(errors)),
        }
    }

    /// The submitted water in canonical form.
    #[must_use]
    pub fn description(&self) -> String {
        json!(self).to_string()
    }

    /// The fields of `water.optics` for this water in a job. The beam attenuation is derived from a and b if both are
    /// known.
    #[must_use]
    pub fn optics(&self) -> Map<String, Value> {
        let parts = self.absorption_per_m.is_some() && self.scattering_per_m.is_some();
        let optics = Optics {
            absorption_per_m: self.absorption_per_m,
            scattering_per_m: self.scattering_per_m,
            beam_attenuation_per_m: self.beam_attenuation_per_m.filter(|_| !parts),
            diffuse_attenuation_per_m: self.diffuse_attenuation_per_m,
            backscatter_fraction: self.backscatter_fraction,
            veiling_light: self.veiling_light,
            ..Optics::default()
        };
        match json!(optics) {
            Value::Object(fields) => fields,
            _ => Map::new(),
        }
    }
}

/// The faults of fields without an error so far. A rejected number is neither missing nor known.
fn new_errors(faults: &[Fault], errors: &[FieldError]) -> Vec<FieldError> {
    let in_numbers = [
        "/absorption_per_m",
        "/scattering_per_m",
        "/beam_attenuation_per_m",
        "/diffuse_attenuation_per_m",
    ]
    .into_iter()
    .any(|field| errors.iter().any(|error| error.pointer.starts_with(field)));
    faults
        .iter()
        .filter(|fault| !(in_numbers && fault.missing))
        .map(|fault| {
            let pointer: String = fault.path.iter().map(|step| format!("/{step}")).collect();
            FieldError::new(&pointer, fault.message.clone())
        })
        .filter(|new| {
            !errors
                .iter()
                .any(|error| is_at_or_below(&error.pointer, &new.pointer))
        })
        .collect()
}

fn is_at_or_below(pointer: &str, parent: &str) -> bool {
    let rest = pointer.strip_prefix(parent);
    rest.is_some_and(|rest| rest.is_empty() || !parent.is_empty() && rest.starts_with('/'))
}
