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
