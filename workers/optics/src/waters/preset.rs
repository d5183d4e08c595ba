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
mod table;

pub(crate) use pure_water::warnings;
pub use registry::{diffuse_in_disguise, expected_defects, find, presets};
pub use self_test::{Defect, self_test};

use spec::Optics;
pub use table::{Channels, Preset, all_known};

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
