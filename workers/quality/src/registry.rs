//! The list of all metrics.

use std::fmt;
use std::ops::RangeInclusive;

use crate::profile::Profile;
use crate::work::MetricInput;
use crate::{ciede2000, corners, entropy, light_uniformity, psnr, ssim, uciqe, uicm, uiconm, uiqm, uism};

/// Computation of a metric.
#[derive(Debug, Clone, Copy)]
pub(crate) enum MetricFormula {
    /// From the picture.
    Direct(fn(&MetricInput) -> f64),
    /// As a sum of other metrics of the same profile, by name and weight.
    Sum(&'static [(&'static str, f64)]),
}

/// One row of the registry.
#[derive(Debug)]
pub struct MetricInfo {
    /// Name without profile.
    pub name: &'static str,
    /// Profile, for metrics that have several.
    pub profile: Option<Profile>,
    /// Short description.
    pub about: &'static str,
    /// Bounds over all 8-bit pictures; infinite if unknown.
    pub range: RangeInclusive<f64>,
    /// Whether it needs a clean picture.
    pub needs_reference: bool,
    pub(crate) compute: MetricFormula,
}

/// A metric of the registry, by its row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MetricId(u8);

impl MetricId {
    /// The metric of this name, `name` or `name@profile`; the default profile is `panetta`.
    #[must_use]
    pub fn parse(name: &str) -> Option<Self> {
        let (name, profile) = name
            .split_once('@')
            .map_or((name, None), |(name, profile)| (name, Some(profile)));
        let row = REGISTRY.iter().position(|info| {
            info.name == name
                && match (info.profile, profile) {
                    (None, None) => true,
                    (Some(own), profile) => own.name() == profile.unwrap_or(Profile::Panetta.name()),
                    (None, Some(_)) => false,
                }
        })?;
        Some(Self(row as u8))
    }

    /// Returns every metric, in the order of the registry.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..REGISTRY.len()).map(|row| Self(row as u8))
    }

    /// The metric's row.
    #[must_use]
    pub fn info(self) -> &'static MetricInfo {
        &REGISTRY[usize::from(self.0)]
    }

    /// The metric of another name in the same profile.
    pub(crate) fn sibling(self, name: &str) -> Self {
        let profile = self.info().profile;
        let row = REGISTRY
            .iter()
            .position(|info| info.name == name && info.profile == profile);
        Self(row.expect("the parts of a sum are in the registry") as u8)
    }
}

/// The name for [`MetricId::parse`], without the default profile.
impl fmt::Display for MetricId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let info = self.info();
        f.write_str(info.name)?;
        match info.profile {
            None | Some(Profile::Panetta) => Ok(()),
            Some(profile) => write!(f, "@{}", profile.name()),
        }
    }
}

const fn row(
    name: &'static str,
    about: &'static str,
    range: RangeInclusive<f64>,
    compute: fn(&MetricInput) -> f64,
) -> MetricInfo {
    MetricInfo {
        name,
        profile: None,
        about,
        range,
        needs_reference: false,
        compute: MetricFormula::Direct(compute),
    }
}

impl MetricInfo {
    const fn with_profile(self, profile: Profile) -> Self {
        Self {
            profile: Some(profile),
            ..self
        }
    }

    const fn comparing(self) -> Self {
        Self {
            needs_reference: true,
            ..self
        }
    }
}

const fn sum(
    profile: Profile,
    range: RangeInclusive<f64>,
    terms: &'static [(&'static str, f64)],
) -> MetricInfo {
    MetricInfo {
        name: "uiqm",
        profile: Some(profile),
        about: "weighted sum of uicm, uism and uiconm of the same profile",
        range,
        needs_reference: false,
        compute: MetricFormula::Sum(terms),
    }
}

const INFINITY: f64 = f64::INFINITY;

use Profile::{Funie, Panetta, Table1};

static REGISTRY: &[MetricInfo] = &[
    row(
        "entropy",
        "entropy of the gray codes, bits",
        0.0..=8.0,
        entropy::gray,
    ),
    row(
        "entropy_rgb_r",
        "entropy of the red codes, bits",
        0.0..=8.0,
        entropy::red,
    ),
    row(
        "entropy_rgb_g",
        "entropy of the green codes, bits",
        0.0..=8.0,
        entropy::green,
    ),
    row(
        "entropy_rgb_b",
        "entropy of the blue codes, bits",
        0.0..=8.0,
        entropy::blue,
    ),
    row(
        "entropy_joint_rgb",
        "joint entropy of the three channels, bits",
        0.0..=24.0,
        entropy::joint,
    ),
    row(
        "entropy_2d",
        "joint entropy of a gray code and the mean of its neighborhood, bits",
        0.0..=16.0,
        entropy::with_neighborhood,
    ),
    row(
        "uicm",
        "colorfulness: spread of the opponent colors, less their shift from gray",
        -7.7..=58.0,
        uicm::panetta,
    )
    .with_profile(Panetta),
    row(
        "uicm",
        "colorfulness: spread of the opponent colors, less their shift from gray",
        -7.7..=58.0,
        uicm::funie,
    )
    .with_profile(Funie),
    row(
        "uicm",
        "colorfulness: spread of the opponent colors, less their shift from gray",
        -7.7..=58.0,
        uicm::table1,
    )
    .with_profile(Table1),
    row(
        "uism",
        "sharpness: contrast of edges, channel by channel",
        0.0..=26.0,
        uism::panetta,
    )
    .with_profile(Panetta),
    row(
        "uism",
        "sharpness: contrast of edges, channel by channel",
        0.0..=26.8,
        uism::funie,
    )
    .with_profile(Funie),
    row(
        "uism",
        "sharpness: contrast of edges, channel by channel",
        0.0..=11.1,
        uism::table1,
    )
    .with_profile(Table1),
    row(
        "uiconm",
        "contrast of blocks as an entropy-like mean",
        0.0..=0.368,
        uiconm::panetta,
    )
    .with_profile(Panetta),
    row(
        "uiconm",
        "contrast of blocks as an entropy-like mean",
        0.0..=0.368,
        uiconm::funie,
    )
    .with_profile(Funie),
    row(
        "uiconm",
        "contrast of blocks as an entropy-like mean",
        -INFINITY..=INFINITY,
        uiconm::table1,
    )
    .with_profile(Table1),
    sum(Panetta, -0.3..=10.7, &uiqm::PANETTA),
    sum(Funie, -0.3..=10.9, &uiqm::PANETTA),
    sum(Table1, -INFINITY..=INFINITY, &uiqm::TABLE1),
    row(
        "uciqe",
        "spread of chroma, contrast of lightness and mean saturation in CIE Lab",
        0.0..=1.2,
        uciqe::uciqe,
    ),
    row(
        "uciqe_sigma_c",
        "part of uciqe: spread of chroma",
        0.0..=1.0,
        uciqe::sigma_c,
    ),
    // White yields 1 + 4e-8: the rows of the matrix do not add up to the white exactly.
    row(
        "uciqe_con_l",
        "part of uciqe: contrast of lightness",
        0.0..=1.000_001,
        uciqe::con_l,
    ),
    row(
        "uciqe_mu_s",
        "part of uciqe: mean saturation",
        0.0..=1.0,
        uciqe::mu_s,
    ),
    row(
        "light_uniformity",
        "how evenly the picture is lit",
        0.0..=1.0,
        light_uniformity::light_uniformity,
    ),
    row(
        "psnr",
        "ratio of peak signal to error against the clean picture, dB",
        0.0..=psnr::CAP_DB,
        psnr::psnr,
    )
    .comparing(),
    row(
        "ssim",
        "structural similarity to the clean picture",
        -1.0..=1.0,
        ssim::ssim,
    )
    .comparing(),
    row(
        "ciede2000",
        "mean color difference from the clean picture",
        0.0..=INFINITY,
        ciede2000::ciede2000,
    )
    .comparing(),
    row(
        "corner_repeatability",
        "share of the clean picture's corners that are found again",
        0.0..=1.0,
        corners::repeatability,
    )
    .comparing(),
];

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn every_metric_has_its_own_name_which_parses_back() {
        let names: HashSet<String> = MetricId::all().map(|id| id.to_string()).collect();
        assert_eq!(names.len(), REGISTRY.len());
        for id in MetricId::all() {
            assert_eq!(MetricId::parse(&id.to_string()), Some(id));
        }
    }

    #[test]
    fn a_name_without_profile_means_panetta() {
        assert_eq!(MetricId::parse("uiqm"), MetricId::parse("uiqm@panetta"));
        assert_eq!(
            MetricId::parse("uiqm@table1").map(|id| id.info().profile),
            Some(Some(Profile::Table1))
        );
        assert_eq!(
            MetricId::parse("uiqm@panetta").map(|id| id.to_string()),
            Some("uiqm".to_owned())
        );
    }

    #[test]
    fn unknown_names_and_profiles_that_a_metric_does_not_have_are_no_metric() {
        for name in [
            "",
            "uiqm@",
            "uiqm@TABLE1",
            "entropy@panetta",
            "entropy@table1",
            "sharpness",
            "uiqm@table1@x",
        ] {
            assert_eq!(MetricId::parse(name), None, "{name}");
        }
    }
}
