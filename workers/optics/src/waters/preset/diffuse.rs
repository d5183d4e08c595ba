//! Waters with K_d alone: they are listed, but cannot be rendered.
//!
//! K_d is the decay of daylight with depth. Used as the beam attenuation it makes every water too clear.

use super::jerlov::{NM_TABLE, diffuse_attenuation};
use super::table::Preset;

const JERLOV: &str = "Jerlov 1976, Marine Optics: downwelling K_d, from a secondary transcription";
const PRINTED: &str = "UWCNN (Li, Anwar & Porikli 2020), its table of transmission per meter N as printed: K_d = -ln N, from a \
     secondary transcription";
const CORRECTED: &str = "Jerlov 1968, Optical Oceanography, transmission per meter at 600, 525 and 475 nm: K_d = -ln N, from a \
     secondary transcription";
const UNKNOWN: &str = "unknown";

const NOT_C: &str = "K_d, the decay of daylight with depth: not the beam attenuation, which is larger";
const BROKEN: &str =
    "the printed red of types I and IA lies above that of IB, and disagrees with Jerlov 1968 at 600 nm";
const MENDED: &str =
    "the red of types I and IA is Jerlov's, where a table that is widely copied has 0.805 and 0.804";
const TOO_CLEAR: &str =
    "type I lies below pure sea water at 9 of 15 wavelengths; Austin & Petzold 1986 recommend other values";

const JERLOV_TYPES: [&str; 10] = ["I", "IA", "IB", "II", "III", "1C", "3C", "5C", "7C", "9C"];
/// Wavelengths of the printed transmissions, nm.
const NM_TRANSMISSION: [f64; 3] = [600.0, 525.0, 475.0];

/// (type, N in red, green and blue as printed, Jerlov's N in red), N in 1/m.
const TRANSMISSIONS: [(&str, [f64; 3], f64); 10] = [
    ("I", [0.805, 0.961, 0.982], 0.850),
    ("IA", [0.804, 0.955, 0.975], 0.840),
    ("IB", [0.830, 0.950, 0.968], 0.830),
    ("II", [0.800, 0.925, 0.940], 0.800),
    ("III", [0.750, 0.885, 0.890], 0.750),
    ("1", [0.750, 0.885, 0.875], 0.750),
    ("3", [0.710, 0.820, 0.800], 0.710),
    ("5", [0.670, 0.730, 0.670], 0.670),
    ("7", [0.620, 0.610, 0.500], 0.620),
    ("9", [0.550, 0.460, 0.290], 0.550),
];

pub(super) fn presets() -> impl Iterator<Item = Preset> {
    let jerlov = JERLOV_TYPES.iter().map(|&kind| {
        let kd = NM_TABLE.map(|nm| diffuse_attenuation(kind, nm));
        let clear = (kind == "I").then_some(TOO_CLEAR);
        row(kind, "jerlov1976", JERLOV, clear, NM_TABLE, kd)
    });
    let printed = TRANSMISSIONS.iter().map(|&(kind, n, _)| {
        let broken = matches!(kind, "I" | "IA").then_some(BROKEN);
        let kd = n.map(|n| Some(-f64::ln(n)));
        derived(row(kind, "uwcnn-printed", PRINTED, broken, NM_TRANSMISSION, kd))
    });
    let corrected = TRANSMISSIONS.iter().map(|&(kind, [_, green, blue], red)| {
        let mended = matches!(kind, "I" | "IA").then_some(MENDED);
        let kd = [red, green, blue].map(|n| Some(-f64::ln(n)));
        derived(row(kind, "jerlov1968-kd", CORRECTED, mended, NM_TRANSMISSION, kd))
    });
    jerlov.chain(printed).chain(corrected)
}

/// K_d was computed from a transmission.
fn derived(preset: Preset) -> Preset {
    Preset {
        derived: vec!["diffuse_attenuation_per_m"],
        ..preset
    }
}

fn row(
    kind: &str,
    table: &str,
    source: &str,
    caveat: Option<&str>,
    wavelength_nm: [f64; 3],
    kd: [Option<f64>; 3],
) -> Preset {
    Preset {
        jerlov_type: Some(kind.to_owned()),
        caveats: [NOT_C].into_iter().chain(caveat).map(str::to_owned).collect(),
        wavelength_nm: wavelength_nm.map(Some),
        diffuse_attenuation: kd,
        ..Preset::unknown(&format!("kd-{kind}/{table}"), source, UNKNOWN)
    }
}
