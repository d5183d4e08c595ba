//! Two kernels instead of one, for a tail that one Cauchy kernel lacks.
//!
//! Fits to the light of beams in Monte Carlo runs up to b Z of about 8: angles of both kernels and the share of the wide one are
//! linear in the optical path b Z.

use spec::{PhaseFunction, ScatterModel, ScatterSource};

use super::WaterError;
use super::model::{Spread, Tail};
use crate::medium::{Kernels, Medium};

/// A number that grows with the optical path: `at_zero + slope b Z`.
#[derive(Clone, Copy)]
struct Line {
    at_zero: f64,
    slope: f64,
}

/// Angles of the two kernels in radians, and the share of the wide one.
struct Fit {
    narrow: Line,
    wide: Line,
    share: Line,
}

const fn line(at_zero: f64, slope: f64) -> Line {
    Line { at_zero, slope }
}

fn fit(law: PhaseFunction) -> Fit {
    let wide = |at_zero| line(at_zero, 0.010);
    match law {
        PhaseFunction::Ff => Fit {
            narrow: line(0.0015, 0.0007),
            wide: wide(0.035),
            share: line(0.63, 0.065),
        },
        PhaseFunction::Hg => Fit {
            narrow: line(0.0045, 0.0),
            wide: wide(0.040),
            share: line(0.84, 0.02),
        },
    }
}

/// The narrow kernel and the wide one, in water of this scattering (1/m) before a lens of this focal length.
pub(super) fn kernels(law: PhaseFunction, scattering: [f64; 3], focal_px: f64) -> (Spread, Tail) {
    let Fit { narrow, wide, share } = fit(law);
    let spread = |angle: Line| Spread {
        offset_px: [angle.at_zero * focal_px; 3],
        per_m: scattering.map(|b| angle.slope * b * focal_px),
    };
    let tail = Tail {
        spread: spread(wide),
        share: share.at_zero,
        share_per_m: scattering.map(|b| share.slope * b),
    };
    (spread(narrow), tail)
}

/// Gates and two kernels belong to the light that `jaffe` spreads from the scene itself.
pub(super) fn contradictions(medium: &Medium) -> Vec<WaterError> {
    let Some(described) = &medium.optics.forward_scatter else {
        return Vec::new();
    };
    let gathers = described.model == ScatterModel::Simplified;
    let is_direct = described.model == ScatterModel::Jaffe && described.source == ScatterSource::Direct;
    let is_gated = medium.layers.is_some();
    let is_two = medium.kernels == Kernels::Two;
    let reason = if (is_gated || is_two) && gathers {
        "is `simplified`, which has neither two kernels nor layers"
    } else if is_gated && is_direct {
        "is `jaffe` with the source `direct`, which has no layers"
    } else {
        return Vec::new();
    };
    vec![WaterError::Contradiction {
        field: "model",
        reason,
    }]
}
