//! Requirements for every table of waters. Published tables have failed each of these.

use super::table::{Preset, all_known};

/// A water that contradicts itself or its neighbors.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{preset}: {what}")]
pub struct Defect {
    /// The preset's full name.
    pub preset: String,
    /// Description of the defect.
    pub what: String,
}

/// Jerlov's types in order of growing attenuation: open ocean, coast, and coast as it was named before.
const ORDERS: [&[&str]; 3] = [
    &["I", "IA", "IB", "II", "III"],
    &["1C", "3C", "5C", "7C", "9C"],
    &["1", "3", "5", "7", "9"],
];
/// No clear ocean attenuates this much in green or blue: a larger value is a transmission mistaken for a coefficient.
const CLEAR_LIMIT_PER_M: f64 = 0.5;
const CHANNELS: [&str; 3] = ["red", "green", "blue"];

/// Checks a set of presets: within one source attenuation and K_d grow with the type in every channel; clear water is clear; K_d
/// has the color of its type; c = a + b; all numbers are finite and not negative. Returns every defect.
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
    preset.jerlov_type.as_deref().unwrap_or_default()
}

fn alone(preset: &Preset, defects: &mut Vec<Defect>) {
    let mut report = |what: String| {
        defects.push(Defect {
            preset: preset.name.clone(),
            what,
        })
    };
    let triples = [
        preset.absorption,
        preset.scattering,
        preset.beam_attenuation,
        preset.diffuse_attenuation,
    ];
    let veil = preset.veiling_light.unwrap_or_default();
    let more = veil.into_iter().chain(preset.backscatter_fraction);
    if triples
        .into_iter()
        .flatten()
        .flatten()
        .chain(more)
        .any(|v| !v.is_finite() || v < 0.0)
    {
        report("a number is negative or not finite".to_owned());
    }
    let known = preset
        .absorption
        .into_iter()
        .zip(preset.scattering)
        .zip(preset.beam_attenuation);
    let sums = known.filter_map(|((a, b), c)| Some((a? + b?, c?)));
    if sums.into_iter().any(|(sum, c)| (sum - c).abs() > 1e-9) {
        report("beam attenuation is not absorption plus scattering".to_owned());
    }
    let clear = matches!(water(preset), "I" | "IA");
    let kinds = [
        ("attenuates", preset.beam_attenuation),
        ("has a K_d of", preset.diffuse_attenuation),
    ];
    for (kind, values) in kinds.into_iter().filter(|_| clear) {
        let [_, green, blue] = values.map(|value| value.unwrap_or(0.0));
        if green > CLEAR_LIMIT_PER_M || blue > CLEAR_LIMIT_PER_M {
            report(format!(
                "clear water {kind} {green} and {blue} per meter in green and blue"
            ));
        }
    }
    let Some([red, green, blue]) = all_known(preset.diffuse_attenuation) else {
        return;
    };
    match water(preset) {
        "I" | "IA" | "IB" | "II" if !(blue <= green && green < red) => {
            report(format!(
                "K_d of ocean water must grow from blue to red, but is {red}, {green}, {blue}"
            ));
        }
        "7C" | "9C" | "7" | "9" if !(blue > green && blue > red) => {
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
                let falls = |&channel: &usize| c[channel].zip(m[channel]).is_some_and(|(c, m)| m < c);
                for channel in (0..3).filter(falls) {
                    let what = format!("less {kind} than {} in {}", clear.name, CHANNELS[channel]);
                    defects.push(Defect {
                        preset: murky.name.clone(),
                        what,
                    });
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{expected_defects, presets};
    use super::*;
    use crate::preset::table::Channels;

    /// Unexpected defects.
    fn found(presets: &[Preset]) -> Vec<Defect> {
        let expected = |d: &Defect| expected_defects().contains(&(d.preset.as_str(), d.what.as_str()));
        self_test(presets).into_iter().filter(|d| !expected(d)).collect()
    }

    /// All coefficients of every preset, changed.
    fn changed(change: impl Fn(Channels) -> Channels) -> Vec<Preset> {
        let change = |preset: &Preset| Preset {
            absorption: change(preset.absorption),
            scattering: change(preset.scattering),
            beam_attenuation: change(preset.beam_attenuation),
            diffuse_attenuation: change(preset.diffuse_attenuation),
            ..preset.clone()
        };
        presets().iter().map(change).collect()
    }

    #[test]
    fn the_shipped_waters_have_only_the_defects_that_are_printed() {
        let all = self_test(presets());
        let all: Vec<_> = all.iter().map(|d| (d.preset.as_str(), d.what.as_str())).collect();
        assert_eq!(all, expected_defects());
    }

    #[test]
    fn every_k_d_of_an_ocean_or_turbid_water_with_red_and_blue_swapped_is_found() {
        for preset in changed(|[r, g, b]| [b, g, r]) {
            let colored = ["I", "IA", "IB", "II", "7C", "9C", "7", "9"].contains(&water(&preset))
                && all_known(preset.diffuse_attenuation).is_some();
            let seen = found(std::slice::from_ref(&preset))
                .iter()
                .any(|d| d.what.starts_with("K_d"));
            assert_eq!(seen, colored, "{}", preset.name);
        }
    }

    #[test]
    fn transmissions_taken_for_coefficients_are_found_in_every_source() {
        let transmissions = changed(|values| values.map(|v| v.map(|v| (-v).exp())));
        let defects = found(&transmissions);
        for source in [
            "williamson2022",
            "solonenko2015",
            "jerlov1976",
            "uwcnn-printed",
            "jerlov1968-kd",
        ] {
            let seen = defects
                .iter()
                .any(|d| d.preset.ends_with(source) && d.what.starts_with("less"));
            assert!(seen, "{source}");
        }
        for clearest in transmissions.iter().filter(|p| matches!(water(p), "I" | "IA")) {
            let seen = defects
                .iter()
                .any(|d| d.preset == clearest.name && d.what.starts_with("clear water"));
            assert!(seen, "{}", clearest.name);
        }
    }

    #[test]
    fn two_types_in_the_wrong_order_are_found() {
        let mut wrong = presets().to_vec();
        let place = |name: &str| presets().iter().position(|p| p.name == name).unwrap();
        let (low, high) = (
            place("jerlov-1C/williamson2022"),
            place("jerlov-3C/williamson2022"),
        );
        let kind = wrong[low].jerlov_type.clone();
        wrong[low].jerlov_type = wrong[high].jerlov_type.clone();
        wrong[high].jerlov_type = kind;
        let defects = found(&wrong);
        assert!(
            defects.iter().any(|d| d.preset == "jerlov-1C/williamson2022"),
            "{defects:?}"
        );
    }

    #[test]
    fn a_defect_that_is_mended_is_missed() {
        let mut mended = presets().to_vec();
        mended.retain(|preset| preset.name != "kd-IB/uwcnn-printed");
        assert_ne!(self_test(&mended).len(), expected_defects().len());
    }

    #[test]
    fn numbers_that_are_none_and_sums_that_do_not_add_up_are_found() {
        let reasons = |preset: Preset| {
            found(std::slice::from_ref(&preset))
                .into_iter()
                .map(|d| d.what)
                .collect::<Vec<_>>()
        };
        let good = presets()[0].clone();
        assert_eq!(reasons(good.clone()), [""; 0]);
        let negative = Preset {
            absorption: [Some(-0.1), None, Some(f64::NAN)],
            ..good.clone()
        };
        assert!(reasons(negative).contains(&"a number is negative or not finite".to_owned()));
        let sum = Preset {
            beam_attenuation: [Some(9.0); 3],
            ..good
        };
        assert_eq!(
            reasons(sum),
            ["beam attenuation is not absorption plus scattering"]
        );
    }
}
