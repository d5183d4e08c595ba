//! Pure sea water: the lower bound of natural attenuation.

use super::table::{Channels, Preset};

/// K_w, the diffuse attenuation of the clearest natural waters, in 1/m at each nm (Smith & Baker 1981, Applied Optics 20, 177,
/// Table 1, from a secondary transcription). K_w = a_w + b_w/2 is below the beam attenuation a_w + b_w of the same water, so it
/// bounds both.
const CLEAREST: [(f64, f64); 22] = [
    (400.0, 0.0209),
    (410.0, 0.0196),
    (420.0, 0.0184),
    (430.0, 0.0172),
    (440.0, 0.0170),
    (450.0, 0.0168),
    (460.0, 0.0176),
    (470.0, 0.0175),
    (480.0, 0.0194),
    (490.0, 0.0212),
    (500.0, 0.0271),
    (510.0, 0.0370),
    (520.0, 0.0489),
    (530.0, 0.0519),
    (540.0, 0.0568),
    (550.0, 0.0648),
    (560.0, 0.0717),
    (570.0, 0.0807),
    (580.0, 0.109),
    (590.0, 0.158),
    (600.0, 0.245),
    (650.0, 0.350),
];
/// Tables are printed with two to four digits.
const PRINT: f64 = 1e-6;
const CHANNELS: [&str; 3] = ["red", "green", "blue"];

/// K_w in 1/m, linear between tabulated wavelengths; `None` outside the table.
fn clearest(nm: f64) -> Option<f64> {
    let above = CLEAREST.iter().position(|(tabulated, _)| *tabulated >= nm)?;
    let (high_nm, high) = CLEAREST[above];
    if high_nm == nm {
        return Some(high);
    }
    let (low_nm, low) = CLEAREST[above.checked_sub(1)?];
    Some(low + (high - low) * (nm - low_nm) / (high_nm - low_nm))
}

/// Warnings for channels whose K_d or c is below that of pure sea water.
pub(crate) fn warnings(preset: &Preset) -> Vec<String> {
    let below = |kind: &'static str, values: Channels| {
        let channels = CHANNELS.into_iter().zip(preset.wavelength_nm).zip(values);
        channels.filter_map(move |((channel, nm), value)| {
            let (nm, value) = (nm?, value?);
            let least = clearest(nm).filter(|least| value < least - PRINT)?;
            Some(format!(
                "{kind} at {nm} nm ({channel}) is {value:.4}/m, below pure sea water, {least:.4}/m"
            ))
        })
    };
    let beam = below("beam attenuation", preset.beam_attenuation);
    beam.chain(below("K_d", preset.diffuse_attenuation)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::presets;
    use super::*;

    /// Exact both ways: (preset, count of its numbers).
    const BELOW: [(&str, usize); 11] = [
        ("jerlov-I/solonenko2015", 3),
        ("jerlov-IA/solonenko2015", 1),
        ("kd-I/jerlov1976", 1),
        ("kd-I/uwcnn-printed", 3),
        ("kd-IA/uwcnn-printed", 2),
        ("kd-IB/uwcnn-printed", 1),
        ("kd-II/uwcnn-printed", 1),
        ("kd-I/jerlov1968-kd", 3),
        ("kd-IA/jerlov1968-kd", 2),
        ("kd-IB/jerlov1968-kd", 1),
        ("kd-II/jerlov1968-kd", 1),
    ];

    #[test]
    fn the_printed_waters_that_lie_below_pure_sea_water_are_these() {
        let found: Vec<_> = presets()
            .iter()
            .filter(|preset| !preset.warnings.is_empty())
            .map(|preset| (preset.name.as_str(), preset.warnings.len()))
            .collect();
        assert_eq!(found, BELOW);
    }

    #[test]
    fn a_water_below_pure_sea_water_is_found_in_every_preset_that_has_wavelengths() {
        for preset in presets()
            .iter()
            .filter(|preset| preset.wavelength_nm.iter().any(Option::is_some))
        {
            let thin = |values: Channels| values.map(|value| value.map(|v| v * 1e-3));
            let faulty = Preset {
                beam_attenuation: thin(preset.beam_attenuation),
                diffuse_attenuation: thin(preset.diffuse_attenuation),
                ..preset.clone()
            };
            assert!(!warnings(&faulty).is_empty(), "{}", preset.name);
        }
    }

    #[test]
    fn between_two_wavelengths_is_between_two_values_and_outside_is_nothing() {
        let middle = clearest(525.0).unwrap();
        assert!((middle - 0.0504).abs() < 1e-12, "{middle}");
        assert_eq!((clearest(399.0), clearest(651.0)), (None, None));
        assert_eq!((clearest(400.0), clearest(650.0)), (Some(0.0209), Some(0.350)));
    }
}
