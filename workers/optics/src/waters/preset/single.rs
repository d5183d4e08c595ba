//! Waters measured or used at one wavelength, in green: for phase functions and Monte Carlo, not for pictures.

use super::table::Preset;

const PETZOLD: &str = "Petzold 1972, SIO Ref. 72-78, from a secondary transcription";
const SIMULATION: &str =
    "the four waters of optical-communication Monte Carlo codes, from a secondary transcription";
const UNKNOWN: &str = "unknown";
const ONE: &str = "one wavelength: for phase functions and Monte Carlo, not for pictures";
const WHICH: &str = "sources name 514 or 530 nm, so the wavelength is left open";
const ABOUT: &str = "the wavelength is about 530 nm";

/// (name, a, b, b_b/b).
const MEASURED: [(&str, f64, f64, f64); 8] = [
    ("autec-7/petzold1972", 0.082, 0.117, 0.025),
    ("autec-8/petzold1972", 0.114, 0.037, 0.044),
    ("autec-9/petzold1972", 0.122, 0.043, 0.038),
    ("haoce-5/petzold1972", 0.195, 0.275, 0.014),
    ("haoce-11/petzold1972", 0.179, 0.219, 0.013),
    ("nuc-2040/petzold1972", 0.366, 1.824, 0.020),
    ("nuc-2200/petzold1972", 0.337, 1.583, 0.019),
    ("nuc-2240/petzold1972", 0.125, 1.205, 0.018),
];

/// (name, a, b).
const SIMULATED: [(&str, f64, f64); 4] = [
    ("pure-sea/uwoc", 0.053, 0.003),
    ("clear-ocean/uwoc", 0.069, 0.08),
    ("coastal/uwoc", 0.088, 0.216),
    ("harbour/uwoc", 0.295, 1.875),
];
const NM_SIMULATED: f64 = 530.0;

pub(super) fn presets() -> impl Iterator<Item = Preset> {
    let measured = MEASURED.iter().map(|&(name, a, b, backscatter_fraction)| Preset {
        backscatter_fraction: Some(backscatter_fraction),
        ..green(name, PETZOLD, [ONE, WHICH], None, a, b)
    });
    let simulated = SIMULATED
        .iter()
        .map(|&(name, a, b)| green(name, SIMULATION, [ONE, ABOUT], Some(NM_SIMULATED), a, b));
    measured.chain(simulated)
}

fn green(name: &str, source: &str, caveats: [&str; 2], nm: Option<f64>, a: f64, b: f64) -> Preset {
    let alone = |value| [None, Some(value), None];
    Preset {
        caveats: caveats.map(str::to_owned).to_vec(),
        wavelength_nm: [None, nm, None],
        absorption: alone(a),
        scattering: alone(b),
        beam_attenuation: alone(a + b),
        derived: vec!["beam_attenuation_per_m"],
        ..Preset::unknown(name, source, UNKNOWN)
    }
}
