//! What every table of waters must satisfy. Published tables have failed each of these.

use super::Preset;

/// A water that contradicts itself or its neighbours.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{preset}: {what}")]
pub struct Defect {
    /// The preset's full name.
    pub preset: String,
    /// What is wrong with it.
    pub what: String,
}

/// Jerlov's types in order of growing attenuation, open ocean and coast.
const ORDERS: [&[&str]; 2] = [&["I", "IA", "IB", "II", "III"], &["1C", "3C", "5C", "7C", "9C"]];
/// No clear ocean attenuates this much in green or blue: a larger value is a transmission taken for a coefficient.
const CLEAR_LIMIT_PER_M: f64 = 0.5;
const CHANNELS: [&str; 3] = ["red", "green", "blue"];

/// Checks a set of presets: within one source attenuation and K_d grow with the type in every channel; clear water is clear;
/// K_d has the colour of its type; c = a + b; nothing is negative or not finite. Answers every defect.
#[must_use]
pub fn self_test(presets: &[Preset]) -> Vec<Defect> {
    let mut defects = Vec::new();
    for preset in presets {
        alone(preset, &mut defects);
    }
    for order in ORDERS {
        for (index, &lower) in order.iter().enumerate() {
            for &higher in &order[index + 1..] {
                pairs(presets, lower, higher, &mut defects);
            }
        }
    }
    defects
}

fn water(preset: &Preset) -> &str {
    preset
        .name
        .trim_start_matches("jerlov-")
        .split('/')
        .next()
        .unwrap_or_default()
}

fn alone(preset: &Preset, defects: &mut Vec<Defect>) {
    let mut report = |what: String| {
        defects.push(Defect {
            preset: preset.name.to_owned(),
            what,
        })
    };
    let triples = [
        preset.absorption,
        preset.scattering,
        preset.beam_attenuation,
        preset.diffuse_attenuation,
    ];
    if triples
        .iter()
        .flatten()
        .flatten()
        .any(|v| !v.is_finite() || *v < 0.0)
    {
        report("a coefficient is negative or not finite".to_owned());
    }
    if let (Some(a), Some(b), Some(c)) = (preset.absorption, preset.scattering, preset.beam_attenuation)
        && (0..3).any(|i| (a[i] + b[i] - c[i]).abs() > 1e-9)
    {
        report("beam attenuation is not absorption plus scattering".to_owned());
    }
    let clear = matches!(water(preset), "I" | "IA");
    if let Some(c) = preset
        .beam_attenuation
        .filter(|c| clear && (c[1] > CLEAR_LIMIT_PER_M || c[2] > CLEAR_LIMIT_PER_M))
    {
        report(format!(
            "clear water attenuates {} and {} per metre in green and blue",
            c[1], c[2]
        ));
    }
    let Some([red, green, blue]) = preset.diffuse_attenuation else {
        return;
    };
    match water(preset) {
        "I" | "IA" | "IB" | "II" if !(blue <= green && green < red) => {
            report(format!(
                "K_d of ocean water must grow from blue to red, but is {red}, {green}, {blue}"
            ));
        }
        "7C" | "9C" if !(blue > green && blue > red) => {
            report(format!(
                "K_d of turbid coastal water must be largest in blue, but is {red}, {green}, {blue}"
            ));
        }
        _ => {}
    }
}

fn pairs(presets: &[Preset], lower: &str, higher: &str, defects: &mut Vec<Defect>) {
    for clear in presets.iter().filter(|preset| water(preset) == lower) {
        for murky in presets
            .iter()
            .filter(|preset| water(preset) == higher && preset.source == clear.source)
        {
            let kinds = [
                ("beam attenuation", clear.beam_attenuation, murky.beam_attenuation),
                ("K_d", clear.diffuse_attenuation, murky.diffuse_attenuation),
            ];
            for (kind, c, m) in kinds {
                let Some((c, m)) = c.zip(m) else { continue };
                for channel in (0..3).filter(|&channel| m[channel] < c[channel]) {
                    let what = format!("less {kind} than {} in {}", clear.name, CHANNELS[channel]);
                    defects.push(Defect {
                        preset: murky.name.to_owned(),
                        what,
                    });
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::presets;
    use super::*;

    #[test]
    fn the_shipped_waters_have_no_defect() {
        assert_eq!(self_test(presets()), []);
    }

    #[test]
    fn red_and_blue_in_the_wrong_order_are_found() {
        let mut swapped = presets().to_vec();
        for preset in &mut swapped {
            for triple in [
                &mut preset.absorption,
                &mut preset.scattering,
                &mut preset.diffuse_attenuation,
            ] {
                triple.as_mut().into_iter().for_each(|values| values.swap(0, 2));
            }
        }
        assert!(
            self_test(&swapped)
                .iter()
                .any(|defect| defect.what.starts_with("K_d"))
        );
    }

    #[test]
    fn transmissions_taken_for_coefficients_are_found() {
        let mut wrong = presets().to_vec();
        for preset in &mut wrong {
            preset.beam_attenuation = preset.beam_attenuation.map(|c| c.map(|v| (-v).exp()));
        }
        let defects = self_test(&wrong);
        assert!(
            defects
                .iter()
                .any(|defect| defect.what.starts_with("clear water"))
        );
        assert!(
            defects
                .iter()
                .any(|defect| defect.what.starts_with("less beam attenuation"))
        );
    }
}
