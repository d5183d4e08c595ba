//! The shipped waters, built and tested on first use.

use std::sync::LazyLock;

use super::table::{Channels, Preset, all_known};
use super::{diffuse, jerlov, pure_water, self_test, single};

static PRESETS: LazyLock<Vec<Preset>> = LazyLock::new(|| {
    let mut presets: Vec<Preset> = jerlov::presets()
        .chain(diffuse::presets())
        .chain(single::presets())
        .collect();
    let found = self_test(&presets);
    for preset in &mut presets {
        preset.defects = found
            .iter()
            .filter(|d| d.preset == preset.name)
            .map(|d| d.what.clone())
            .collect();
        preset.warnings = pure_water::warnings(preset);
    }
    presets
});

/// Exact list of defects of the shipped presets: (preset, defect).
const EXPECTED_DEFECTS: [(&str, &str); 2] = [
    ("kd-IB/uwcnn-printed", "less K_d than kd-I/uwcnn-printed in red"),
    ("kd-IB/uwcnn-printed", "less K_d than kd-IA/uwcnn-printed in red"),
];

/// Every preset; of several sources for one water the default comes first.
#[must_use]
pub fn presets() -> &'static [Preset] {
    &PRESETS
}

/// The preset of a full name, or the default source of a bare one (`jerlov-3C`).
#[must_use]
pub fn find(name: &str) -> Option<&'static Preset> {
    let bare = |preset: &Preset| preset.name.split('/').next() == Some(name);
    presets()
        .iter()
        .find(|preset| preset.name == name || bare(preset))
}

/// Defects that [`self_test`] finds in the presets as printed: (preset, defect).
#[must_use]
pub fn expected_defects() -> &'static [(&'static str, &'static str)] {
    &EXPECTED_DEFECTS
}

pub(super) fn is_expected(name: &str, what: &str) -> bool {
    EXPECTED_DEFECTS.contains(&(name, what))
}

/// The preset whose K_d these numbers are, to the digits of print: a beam attenuation like this is most likely a K_d.
#[must_use]
pub fn diffuse_in_disguise(beam_attenuation: [f64; 3]) -> Option<&'static str> {
    let alike = |kd: Channels| {
        all_known(kd).is_some_and(|kd| {
            let mut pairs = kd.into_iter().zip(beam_attenuation);
            pairs.all(|(kd, c)| (kd - c).abs() <= 0.0006 + 0.01 * kd)
        })
    };
    let found = presets().iter().find(|preset| alike(preset.diffuse_attenuation));
    found.map(|preset| preset.name.as_str())
}
