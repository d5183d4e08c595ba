//! Optical waters with their coefficients, sources and caveats.
//!
//! A number missing from a source is absent, never guessed. Absorption and scattering are stored; beam attenuation is their sum.
//! K_d, the decay of daylight with depth, is stored separately and never attenuates along a camera ray.

mod diffuse;
mod jerlov;
mod pure_water;
mod registry;
mod self_test;
mod single;

pub(crate) use pure_water::warnings;
pub use registry::{diffuse_in_disguise, expected_defects, find, presets};
pub use self_test::{Defect, self_test};

use spec::Optics;

/// Red, green, blue; a channel that is not known is absent.
pub type Channels = [Option<f64>; 3];

/// All three channels, if all are known.
#[must_use]
pub fn all_known(channels: Channels) -> Option<[f64; 3]> {
    let [Some(r), Some(g), Some(b)] = channels else {
        return None;
    };
    Some([r, g, b])
}

/// One water. Coefficients in 1/m; an absent number is unknown, never zero.
#[derive(Debug, Clone, PartialEq)]
pub struct Preset {
    /// Full name: water and source, such as `jerlov-3C/williamson2022`.
    pub name: String,
    /// Jerlov's type, such as `3C`, if it is one of them: the self-tests hold it against its neighbors.
    pub jerlov_type: Option<String>,
    /// Publication of the numbers.
    pub source: String,
    /// License terms, `unknown` if not known.
    pub licence: String,
    /// Caveats for users.
    pub caveats: Vec<String>,
    /// Wavelengths of red, green and blue, nm.
    pub wavelength_nm: Channels,
    /// Absorption a.
    pub absorption: Channels,
    /// Scattering b.
    pub scattering: Channels,
    /// Beam attenuation c = a + b.
    pub beam_attenuation: Channels,
    /// Diffuse attenuation K_d.
    pub diffuse_attenuation: Channels,
    /// Backscatter fraction b_b/b, if the source has one.
    pub backscatter_fraction: Option<f64>,
    /// Veiling light, linear, if the source has one.
    pub veiling_light: Option<[f64; 3]>,
    /// Fields computed from the source's numbers, by the names of the job description.
    pub derived: Vec<&'static str>,
    /// Below pure sea water and similar: worth knowing, but not a defect.
    pub warnings: Vec<String>,
    /// Defects found by the self-tests.
    pub defects: Vec<String>,
}

impl Preset {
    /// A water with all numbers unknown.
    #[must_use]
    pub fn unknown(name: &str, source: &str, licence: &str) -> Self {
        Self {
            name: name.to_owned(),
            jerlov_type: None,
            source: source.to_owned(),
            licence: licence.to_owned(),
            caveats: Vec::new(),
            wavelength_nm: [None; 3],
            absorption: [None; 3],
            scattering: [None; 3],
            beam_attenuation: [None; 3],
            diffuse_attenuation: [None; 3],
            backscatter_fraction: None,
            veiling_light: None,
            derived: Vec::new(),
            warnings: Vec::new(),
            defects: Vec::new(),
        }
    }

    /// The optics of this water by its numbers.
    #[must_use]
    pub fn optics(&self) -> Optics {
        let parts = all_known(self.absorption).zip(all_known(self.scattering));
        Optics {
            absorption_per_m: all_known(self.absorption),
            scattering_per_m: all_known(self.scattering),
            beam_attenuation_per_m: all_known(self.beam_attenuation).filter(|_| parts.is_none()),
            diffuse_attenuation_per_m: all_known(self.diffuse_attenuation),
            veiling_light: self.veiling_light,
            backscatter_fraction: self.backscatter_fraction,
            ..Optics::default()
        }
    }

    /// Why a frame cannot be rendered with this preset alone, if so.
    #[must_use]
    pub fn unrenderable(&self) -> Option<String> {
        if let Some(defect) = self
            .defects
            .iter()
            .find(|what| !registry::is_expected(&self.name, what))
        {
            return Some(format!("it fails its self-test: {defect}"));
        }
        let nothing = |channels: Channels| channels.iter().all(Option::is_none);
        let why = if all_known(self.beam_attenuation).is_some() {
            let veil = self.veiling_light.is_some() || all_known(self.diffuse_attenuation).is_some();
            (!veil).then_some("neither veiling light nor diffuse attenuation is known")
        } else if nothing(self.beam_attenuation) && nothing(self.scattering) {
            Some("only K_d is known, which does not attenuate along a camera ray")
        } else if self.wavelength_nm.iter().flatten().count() <= 1 {
            Some("it is known at one wavelength only")
        } else {
            Some("absorption or scattering is unknown at one of its wavelengths")
        };
        why.map(str::to_owned)
    }
}

#[cfg(test)]
mod tests;
