//! The Jerlov water types, and the baseline of a well-known simulator.

use super::table::Preset;

const WILLIAMSON: Source = Source {
    name: "williamson2022",
    reference: "Williamson & Hollins 2022, Applied Optics 61, 9951: measured campaign means, from a secondary transcription",
    licence: "Open Government Licence v3.0 (data)",
    // Their measured wavelengths.
    wavelength_nm: [650.0, 555.0, 440.0],
};
const SOLONENKO: Source = Source {
    name: "solonenko2015",
    reference: "Solonenko & Mobley 2015, Applied Optics 54, 5392: inverted from Jerlov's K_d, from a secondary transcription",
    licence: "unknown",
    wavelength_nm: NM_TABLE,
};

const NARROW: &str = "three wavelengths stand for three broad camera channels";
const KD: &str = "K_d after Jerlov 1976, interpolated linearly between tabulated wavelengths";
const MEASURED: &[&str] = &[
    NARROW,
    KD,
    "standard deviations of the scattering are typically 20 to 50 %",
];
const FEW: &[&str] = &[NARROW, KD, "fewer than five campaigns in red"];
const NOT_MEASURED: &str = "absorption and scattering are inverted from K_d, not measured; the inversion is printed with a small-particle \
     constant of 1.513 where Haltrin 1999 has 1.151302";
const BELOW_KD: &str = "the scattering is marked suspect in the transcription; beam attenuation in red lies below the tabulated K_d";
const INVERTED: &[&str] = &[NARROW, KD, NOT_MEASURED];
const SUSPECT: &[&str] = &[NARROW, KD, NOT_MEASURED, BELOW_KD];
const SUSPECT_CLEAREST: &[&str] = &[
    NARROW,
    KD,
    NOT_MEASURED,
    BELOW_KD,
    "Jerlov's K_d of type I lies below that of pure sea water at 9 of 15 wavelengths; Austin & Petzold 1986 recommend other values",
];
const INCOMPLETE: &[&str] = &[
    NARROW,
    KD,
    "absorption at 650 nm is a duplicated row in print and therefore unknown",
];

/// (type, absorption, scattering, caveats), both R, G, B.
type Row = (&'static str, [f64; 3], [f64; 3], &'static [&'static str]);

/// A coefficient that the source does not give.
const UNPRINTED: f64 = f64::NAN;

const WILLIAMSON_ROWS: [Row; 6] = [
    ("IB", [0.346, 0.071, 0.042], [0.118, 0.120, 0.135], FEW),
    ("II", [0.353, 0.077, 0.066], [0.164, 0.184, 0.195], MEASURED),
    ("III", [0.364, 0.091, 0.114], [0.271, 0.306, 0.309], MEASURED),
    ("1C", [0.366, 0.099, 0.159], [0.412, 0.447, 0.435], MEASURED),
    ("3C", [0.375, 0.118, 0.231], [0.652, 0.675, 0.636], MEASURED),
    ("5C", [0.395, 0.157, 0.327], [1.237, 1.267, 1.072], MEASURED),
];

const SOLONENKO_ROWS: [Row; 10] = [
    (
        "I",
        [0.334, 0.062, 0.018],
        [0.0009, 0.0017, 0.0038],
        SUSPECT_CLEAREST,
    ),
    ("IA", [0.334, 0.0622, 0.0221], [0.0023, 0.0035, 0.0063], SUSPECT),
    ("IB", [0.334, 0.0623, 0.0235], [0.045, 0.0536, 0.068], INVERTED),
    ("II", [0.334, 0.0622, 0.0241], [0.270, 0.358, 0.504], INVERTED),
    ("III", [0.336, 0.0646, 0.0388], [0.737, 0.980, 1.38], INVERTED),
    ("1C", [0.344, 0.076, 0.105], [0.274, 0.365, 0.514], INVERTED),
    ("3C", [0.346, 0.082, 0.154], [0.800, 1.06, 1.50], INVERTED),
    ("5C", [UNPRINTED, 0.117, 0.297], [1.001, 1.33, 1.87], INCOMPLETE),
    ("7C", [0.403, 0.195, 0.542], [1.77, 2.35, 3.30], INVERTED),
    ("9C", [0.456, 0.348, 0.943], [2.35, 3.12, 4.39], INVERTED),
];

/// K_d of Jerlov 1976 at 400, 450, 500, 550, 600, 650, 700 nm, 1/m.
const JERLOV_KD: [(&str, [f64; 7]); 10] = [
    ("I", [0.028, 0.019, 0.027, 0.063, 0.235, 0.36, 0.56]),
    ("IA", [0.038, 0.026, 0.032, 0.067, 0.24, 0.37, 0.57]),
    ("IB", [0.051, 0.036, 0.042, 0.072, 0.245, 0.376, 0.58]),
    ("II", [0.096, 0.068, 0.070, 0.089, 0.26, 0.40, 0.61]),
    ("III", [0.185, 0.136, 0.115, 0.12, 0.295, 0.445, 0.66]),
    ("1C", [0.51, 0.25, 0.14, 0.12, 0.30, 0.45, 0.65]),
    ("3C", [0.78, 0.39, 0.22, 0.19, 0.33, 0.46, 0.71]),
    ("5C", [1.1, 0.56, 0.36, 0.30, 0.40, 0.54, 0.80]),
    ("7C", [1.6, 0.89, 0.58, 0.46, 0.48, 0.63, 0.92]),
    ("9C", [2.4, 1.6, 0.99, 0.63, 0.60, 0.76, 1.1]),
];
const KD_FIRST_NM: f64 = 400.0;
const KD_STEP_NM: f64 = 50.0;
/// Tabulated wavelengths used for red, green and blue.
pub(super) const NM_TABLE: [f64; 3] = [650.0, 550.0, 450.0];

/// K_d between two tabulated wavelengths; `None` outside the table.
pub(super) fn diffuse_attenuation(water: &str, wavelength_nm: f64) -> Option<f64> {
    let (_, table) = JERLOV_KD.iter().find(|(name, _)| *name == water)?;
    let place = (wavelength_nm - KD_FIRST_NM) / KD_STEP_NM;
    let below = place.floor() as usize;
    let share = place - place.floor();
    let left = *table.get(below)?;
    if share == 0.0 {
        Some(left)
    } else {
        Some(left + share * (table.get(below + 1)? - left))
    }
}

/// Common data of one source.
struct Source {
    /// The second half of its presets' names.
    name: &'static str,
    reference: &'static str,
    licence: &'static str,
    wavelength_nm: [f64; 3],
}

fn preset(&(kind, absorption, scattering, caveats): &Row, source: &Source) -> Preset {
    let tabulated = source.wavelength_nm.iter().all(|nm| nm % KD_STEP_NM == 0.0);
    let interpolated = (!tabulated).then_some("diffuse_attenuation_per_m");
    let absorption = absorption.map(|a| (!a.is_nan()).then_some(a));
    let name = format!("jerlov-{kind}/{}", source.name);
    Preset {
        jerlov_type: Some(kind.to_owned()),
        caveats: caveats.iter().map(ToString::to_string).collect(),
        wavelength_nm: source.wavelength_nm.map(Some),
        absorption,
        scattering: scattering.map(Some),
        beam_attenuation: [0, 1, 2].map(|i| absorption[i].map(|a| a + scattering[i])),
        diffuse_attenuation: source.wavelength_nm.map(|nm| diffuse_attenuation(kind, nm)),
        derived: ["beam_attenuation_per_m"]
            .into_iter()
            .chain(interpolated)
            .collect(),
        ..Preset::unknown(&name, source.reference, source.licence)
    }
}

/// Attenuation only, the default of the underwater camera plugin of UUV Simulator: `attenuationR`, `G` and `B` 1/30 per meter,
/// `backgroundR`, `G` and `B` 0.
fn uuv_simulator() -> Preset {
    let caveats = [
        "a baseline to compare with, not a measured water: grey attenuation and a black background",
        "the simulator attenuates display codes; here the same numbers act on linear light",
    ];
    Preset {
        caveats: caveats.map(str::to_owned).to_vec(),
        beam_attenuation: [Some(1.0 / 30.0); 3],
        veiling_light: Some([0.0; 3]),
        ..Preset::unknown(
            "uuv-simulator",
            "UUV Simulator (uuvsimulator/uuv_simulator), defaults of UnderwaterCameraROSPlugin.cc",
            "Apache-2.0 (the simulator)",
        )
    }
}

pub(super) fn presets() -> impl Iterator<Item = Preset> {
    let measured = WILLIAMSON_ROWS.iter().map(|row| preset(row, &WILLIAMSON));
    let inverted = SOLONENKO_ROWS.iter().map(|row| preset(row, &SOLONENKO));
    measured.chain(inverted).chain([uuv_simulator()])
}
