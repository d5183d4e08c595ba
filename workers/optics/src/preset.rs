//! Optical waters with their numbers, their source and what is wrong with them.
//!
//! A number that a source does not give is absent, never guessed. Absorption and scattering are stored; beam attenuation is
//! their sum. K_d, the decay of daylight with depth, stands beside them and never attenuates along a camera ray.

mod jerlov;
mod self_test;

pub use self_test::{Defect, self_test};

/// One water. Arrays are red, green, blue; coefficients in 1/m.
#[derive(Debug, Clone, PartialEq)]
pub struct Preset {
    /// Full name: water and source, such as `jerlov-3C/williamson2022`.
    pub name: &'static str,
    /// Where the numbers come from.
    pub source: &'static str,
    /// Under what terms they may be used, `unknown` if that is not known.
    pub licence: &'static str,
    /// What a user should know.
    pub caveats: &'static [&'static str],
    /// Wavelengths that stand for red, green and blue, nm.
    pub wavelength_nm: Option<[f64; 3]>,
    /// Absorption a.
    pub absorption: Option<[f64; 3]>,
    /// Scattering b.
    pub scattering: Option<[f64; 3]>,
    /// Beam attenuation c = a + b.
    pub beam_attenuation: Option<[f64; 3]>,
    /// Diffuse attenuation K_d.
    pub diffuse_attenuation: Option<[f64; 3]>,
    /// Veiling light, linear, if the source gives one.
    pub veiling_light: Option<[f64; 3]>,
}

impl Preset {
    /// Why a frame cannot be rendered with this preset alone, if so.
    #[must_use]
    pub fn unrenderable(&self) -> Option<&'static str> {
        if self.beam_attenuation.is_none() {
            return Some("absorption or scattering is unknown at one of its wavelengths");
        }
        (self.veiling_light.is_none() && self.diffuse_attenuation.is_none())
            .then_some("neither veiling light nor diffuse attenuation is known")
    }
}

/// Every preset; of several sources for one water the default comes first.
#[must_use]
pub fn presets() -> &'static [Preset] {
    &jerlov::PRESETS
}

/// The preset of a full name, or the default source of a bare one (`jerlov-3C`).
#[must_use]
pub fn find(name: &str) -> Option<&'static Preset> {
    let bare = |preset: &Preset| preset.name.split('/').next() == Some(name);
    presets()
        .iter()
        .find(|preset| preset.name == name || bare(preset))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bare_name_is_its_default_source() {
        assert_eq!(
            find("jerlov-3C").map(|p| p.name),
            Some("jerlov-3C/williamson2022")
        );
        assert_eq!(find("jerlov-9C").map(|p| p.name), Some("jerlov-9C/solonenko2015"));
        assert_eq!(
            find("jerlov-3C/solonenko2015").map(|p| p.name),
            Some("jerlov-3C/solonenko2015")
        );
        assert!(find("jerlov-4C").is_none() && find("jerlov").is_none());
    }

    #[test]
    fn attenuation_is_absorption_plus_scattering() {
        let preset = find("jerlov-1C").unwrap();
        let expected = [0.366 + 0.412, 0.099 + 0.447, 0.159 + 0.435];
        assert_eq!(preset.beam_attenuation, Some(expected));
    }

    #[test]
    fn a_water_without_absorption_in_red_is_listed_but_not_rendered() {
        let preset = find("jerlov-5C/solonenko2015").unwrap();
        assert!(preset.unrenderable().is_some());
        assert_eq!(presets().iter().filter(|p| p.unrenderable().is_some()).count(), 1);
    }

    #[test]
    fn diffuse_attenuation_is_interpolated_at_the_wavelengths_of_the_preset() {
        let preset = find("jerlov-3C/williamson2022").unwrap();
        // 650 is tabulated; 555 lies a tenth of the way from 550 (0.19) to 600 (0.33); 440 between 400 and 450.
        let expected = [0.46, 0.19 + 0.1 * (0.33 - 0.19), 0.78 + 0.8 * (0.39 - 0.78)];
        let known = preset.diffuse_attenuation.unwrap();
        assert!(
            known.iter().zip(expected).all(|(k, e)| (k - e).abs() < 1e-12),
            "{known:?}"
        );
    }
}
