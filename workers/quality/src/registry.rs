//! The list of all metrics.

use std::fmt;

use crate::work::Work;
use crate::{ciede2000, corners, entropy, light_uniformity, psnr, ssim, uciqe, uicm, uiconm, uiqm, uism};

/// Which published arithmetic a metric follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Profile {
    /// The formulas of the article (Panetta, Gao and Agaian 2016). The default: its name is not written.
    Panetta,
    /// The program that underwater deep-learning papers share, with its slips.
    Funie,
    /// What agrees with the arithmetic of the published comparison table of enhancement methods.
    Table1,
}

impl Profile {
    /// As written behind the `@`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Panetta => "panetta",
            Self::Funie => "funie",
            Self::Table1 => "table1",
        }
    }
}

/// In which direction a value gets better.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Better {
    /// More is better.
    Higher,
    /// Less is better.
    Lower,
    /// Neither: the value describes, it does not judge.
    None,
}

/// Bounds that no 8-bit picture leaves; `None` where no bound is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Least value.
    pub low: Option<f64>,
    /// Greatest value.
    pub high: Option<f64>,
}

/// One row of the registry.
#[derive(Debug)]
pub struct MetricInfo {
    /// Name without profile.
    pub name: &'static str,
    /// Profile, for metrics that have several.
    pub profile: Option<Profile>,
    /// Counts up when the arithmetic changes: values of different versions are not compared.
    pub version: u32,
    /// Unit; empty where there is none.
    pub unit: &'static str,
    /// Direction.
    pub better: Better,
    /// Bounds.
    pub range: Range,
    /// Whether a clean picture is needed.
    pub needs_reference: bool,
    pub(crate) compute: fn(&Work) -> f64,
}

/// A metric of the registry, by its row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MetricId(u8);

impl MetricId {
    /// The metric of this name, `name` or `name@profile`; a name without profile means `panetta`.
    #[must_use]
    pub fn parse(name: &str) -> Option<Self> {
        let (name, profile) = name
            .split_once('@')
            .map_or((name, None), |(name, profile)| (name, Some(profile)));
        let wanted = |info: &MetricInfo| match (info.profile, profile) {
            (None, None) => true,
            (Some(own), profile) => own.name() == profile.unwrap_or(Profile::Panetta.name()),
            (None, Some(_)) => false,
        };
        let row = REGISTRY
            .iter()
            .position(|info| info.name == name && wanted(info))?;
        Some(Self(row as u8))
    }

    /// Every metric, in the order of the registry.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..REGISTRY.len()).map(|row| Self(row as u8))
    }

    /// The metric's row.
    #[must_use]
    pub fn info(self) -> &'static MetricInfo {
        &REGISTRY[self.row()]
    }

    pub(crate) fn row(self) -> usize {
        usize::from(self.0)
    }
}

/// The name that [`MetricId::parse`] reads; the default profile is left out.
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

/// All metrics.
#[must_use]
pub fn registry() -> &'static [MetricInfo] {
    REGISTRY
}

const fn row(name: &'static str, unit: &'static str, range: Range, compute: fn(&Work) -> f64) -> MetricInfo {
    MetricInfo {
        name,
        profile: None,
        version: 1,
        unit,
        better: Better::Higher,
        range,
        needs_reference: false,
        compute,
    }
}

const fn profiled(
    name: &'static str,
    profile: Profile,
    range: Range,
    compute: fn(&Work) -> f64,
) -> MetricInfo {
    MetricInfo {
        profile: Some(profile),
        ..row(name, "", range, compute)
    }
}

const fn compared(
    name: &'static str,
    unit: &'static str,
    range: Range,
    compute: fn(&Work) -> f64,
) -> MetricInfo {
    MetricInfo {
        needs_reference: true,
        ..row(name, unit, range, compute)
    }
}

const fn within(low: f64, high: f64) -> Range {
    Range {
        low: Some(low),
        high: Some(high),
    }
}

const UNBOUNDED: Range = Range {
    low: None,
    high: None,
};

const FROM_ZERO: Range = Range {
    low: Some(0.0),
    high: None,
};

use Profile::{Funie, Panetta, Table1};

static REGISTRY: &[MetricInfo] = &[
    row("entropy", "bit", within(0.0, 8.0), entropy::gray),
    row("entropy_rgb_r", "bit", within(0.0, 8.0), entropy::red),
    row("entropy_rgb_g", "bit", within(0.0, 8.0), entropy::green),
    row("entropy_rgb_b", "bit", within(0.0, 8.0), entropy::blue),
    row("entropy_joint_rgb", "bit", within(0.0, 24.0), entropy::joint),
    row("entropy_2d", "bit", within(0.0, 16.0), entropy::with_neighborhood),
    profiled("uicm", Panetta, within(-7.7, 58.0), uicm::panetta),
    profiled("uicm", Funie, within(-7.7, 58.0), uicm::funie),
    profiled("uicm", Table1, within(-7.7, 58.0), uicm::table1),
    profiled("uism", Panetta, within(0.0, 26.0), uism::panetta),
    profiled("uism", Funie, within(0.0, 26.8), uism::funie),
    profiled("uism", Table1, within(0.0, 11.1), uism::table1),
    profiled("uiconm", Panetta, within(0.0, 0.368), uiconm::panetta),
    profiled("uiconm", Funie, within(0.0, 0.368), uiconm::funie),
    MetricInfo {
        better: Better::None,
        ..profiled("uiconm", Table1, UNBOUNDED, uiconm::table1)
    },
    profiled("uiqm", Panetta, within(-0.3, 10.7), uiqm::panetta),
    profiled("uiqm", Funie, within(-0.3, 10.9), uiqm::funie),
    profiled("uiqm", Table1, UNBOUNDED, uiqm::table1),
    row("uciqe", "", within(0.0, 1.2), uciqe::uciqe),
    row("uciqe_sigma_c", "", within(0.0, 1.0), uciqe::sigma_c),
    // White comes out at 1 + 4e-8: the rows of the matrix do not add up to the white exactly.
    row("uciqe_con_l", "", within(0.0, 1.000_001), uciqe::con_l),
    row("uciqe_mu_s", "", within(0.0, 1.0), uciqe::mu_s),
    row(
        "light_uniformity",
        "",
        within(0.0, 1.0),
        light_uniformity::light_uniformity,
    ),
    compared("psnr", "dB", within(0.0, psnr::CAP_DB), psnr::psnr),
    compared("ssim", "", within(-1.0, 1.0), ssim::ssim),
    MetricInfo {
        better: Better::Lower,
        ..compared("ciede2000", "ΔE00", FROM_ZERO, ciede2000::ciede2000)
    },
    compared(
        "corner_repeatability",
        "",
        within(0.0, 1.0),
        corners::repeatability,
    ),
];

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn every_metric_has_its_own_name_which_parses_back() {
        let names: HashSet<String> = MetricId::all().map(|id| id.to_string()).collect();
        assert_eq!(names.len(), registry().len());
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
