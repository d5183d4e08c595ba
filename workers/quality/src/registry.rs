//! The list of all metrics.

use std::fmt;
use std::ops::RangeInclusive;

use crate::matching::features::FEATURE_BUDGET;
use crate::matching::track::TRACK_FRAMES;
use crate::needs::Needs;
use crate::profile::Profile;
use crate::work::MetricInput;
use crate::{
    ciede2000, entropy, features, illumination_residual, light_uniformity, psnr, sequence, ssim, uciqe, uicm,
    uiconm, uiqm, uism,
};

/// Computation of a metric.
#[derive(Debug, Clone, Copy)]
pub(crate) enum MetricFormula {
    /// From the codes of the counted pixels, independent of their positions.
    Pixels(fn(&MetricInput) -> f64),
    /// From the whole picture and its mask.
    Direct(fn(&MetricInput) -> f64),
    /// The same, if the metric is defined for the picture.
    Defined(fn(&MetricInput) -> Option<f64>),
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
    /// Its input besides the picture.
    pub needs: Needs,
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

const INFINITY: f64 = f64::INFINITY;

use MetricFormula::{Defined, Direct, Pixels, Sum};

/// Declares metrics: name, profile, needs, description, range and computation.
macro_rules! metrics {
    (@profile) => { None };
    (@profile $profile:ident) => { Some(Profile::$profile) };
    (@needs) => { Needs::Nothing };
    (@needs against_clean) => { Needs::PictureInAir };
    (@needs after_previous) => { Needs::PreviousFrames(1) };
    (@needs along_track) => { Needs::PreviousFrames(TRACK_FRAMES) };
    (@needs under_light) => { Needs::Illumination };
    ($($name:literal $(@$profile:ident)? $($needs:ident)?: $about:expr, $range:expr, $compute:expr;)*) => {
        &[$(MetricInfo {
            name: $name,
            profile: metrics!(@profile $($profile)?),
            about: $about,
            range: $range,
            needs: metrics!(@needs $($needs)?),
            compute: $compute,
        }),*]
    };
}

const COUNT: RangeInclusive<f64> = 0.0..=FEATURE_BUDGET as f64;
const UICM: &str = "colorfulness: spread of the opponent colors, less their shift from gray";
const UISM: &str = "sharpness: contrast of edges, channel by channel";
const UICONM: &str = "contrast of blocks as an entropy-like mean";
const UIQM: &str = "weighted sum of uicm, uism and uiconm of the same profile";

static REGISTRY: &[MetricInfo] = metrics! {
    "entropy": "entropy of the gray codes, bits", 0.0..=8.0, Pixels(entropy::gray);
    "entropy_rgb_r": "entropy of the red codes, bits", 0.0..=8.0, Pixels(entropy::red);
    "entropy_rgb_g": "entropy of the green codes, bits", 0.0..=8.0, Pixels(entropy::green);
    "entropy_rgb_b": "entropy of the blue codes, bits", 0.0..=8.0, Pixels(entropy::blue);
    "entropy_joint_rgb": "joint entropy of the three channels, bits", 0.0..=24.0, Pixels(entropy::joint);
    "entropy_2d": "joint entropy of a gray code and the mean of its neighborhood, bits", 0.0..=16.0, Direct(entropy::with_neighborhood);
    "uicm" @Panetta: UICM, -7.7..=58.0, Pixels(uicm::panetta);
    "uicm" @Funie: UICM, -7.7..=58.0, Pixels(uicm::funie);
    "uicm" @Table1: UICM, -7.7..=58.0, Pixels(uicm::table1);
    "uism" @Panetta: UISM, 0.0..=26.0, Direct(uism::panetta);
    "uism" @Funie: UISM, 0.0..=26.8, Direct(uism::funie);
    "uism" @Table1: UISM, 0.0..=11.1, Direct(uism::table1);
    "uiconm" @Panetta: UICONM, 0.0..=0.368, Direct(uiconm::panetta);
    "uiconm" @Funie: UICONM, 0.0..=0.368, Direct(uiconm::funie);
    "uiconm" @Table1: UICONM, -INFINITY..=INFINITY, Direct(uiconm::table1);
    "uiqm" @Panetta: UIQM, -0.3..=10.7, Sum(&uiqm::PANETTA);
    "uiqm" @Funie: UIQM, -0.3..=10.9, Sum(&uiqm::PANETTA);
    "uiqm" @Table1: UIQM, -INFINITY..=INFINITY, Sum(&uiqm::TABLE1);
    "uciqe": "spread of chroma, contrast of lightness and mean saturation in CIE Lab", 0.0..=1.2, Pixels(uciqe::uciqe);
    "uciqe_sigma_c": "part of uciqe: spread of chroma", 0.0..=1.0, Pixels(uciqe::sigma_c);
    // White yields 1 + 4e-8: the rows of the matrix do not add up to the white exactly.
    "uciqe_con_l": "part of uciqe: contrast of lightness", 0.0..=1.000_001, Pixels(uciqe::con_l);
    "uciqe_mu_s": "part of uciqe: mean saturation", 0.0..=1.0, Pixels(uciqe::mu_s);
    "light_uniformity": "how evenly the picture is lit", 0.0..=1.0, Direct(light_uniformity::light_uniformity);
    "psnr" against_clean: "ratio of peak signal to error against the clean picture, dB", 0.0..=psnr::CAP_DB, Pixels(psnr::psnr);
    "ssim" against_clean: "structural similarity to the clean picture", -1.0..=1.0, Direct(ssim::ssim);
    "ciede2000" against_clean: "mean color difference from the clean picture", 0.0..=INFINITY, Pixels(ciede2000::ciede2000);
    "features": "features at the adaptive threshold", COUNT, Direct(features::adaptive);
    "features_default": "features of a contrast above 20 codes", COUNT, Direct(features::default);
    "matches" after_previous: "matches of features with the previous frame", COUNT, Defined(sequence::matches);
    "matches_default" after_previous: "the same for features_default", COUNT, Defined(sequence::matches_default);
    "matches_correct" after_previous: "matches within 3 px of the true position", COUNT, Defined(sequence::matches_correct);
    "matches_correct_default" after_previous: "the same for features_default", COUNT, Defined(sequence::matches_correct_default);
    "matches_precision" after_previous: "share of correct matches", 0.0..=1.0, Defined(sequence::matches_precision);
    "track_length" along_track: "mean number of frames back to which a feature is matched correctly", 0.0..=TRACK_FRAMES as f64, Defined(sequence::mean_track_length);
    "pose_error_deg" after_previous: "angle of the error of the relative pose from the matches, degrees", 0.0..=180.0, Defined(sequence::pose_error_deg);
    "pose_error_m" after_previous: "error of the camera's translation at its true length, m", 0.0..=INFINITY, Defined(sequence::pose_error_m);
    "illumination_residual" under_light: "share of the true illumination left in the picture; 1 as in the input, 0 removed", -INFINITY..=INFINITY, Defined(illumination_residual::residual);
};

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
