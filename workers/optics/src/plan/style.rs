//! What of a style model runs.

use spec::{Fidelity, StyleTier};

use super::{Given, Stage, StyleStep};

/// Slope of the decoding of sRGB at white, where it is steepest: what a difference of encoded values becomes in linear
/// light at most.
const STEEPEST: f64 = 2.4 / 1.055;

/// What a plan has to know of a style model. The default is that of a frame without one.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StyleTraits {
    /// Largest distance of its color table from its network, 8-bit codes; none without a table.
    pub table_max_255: Option<f64>,
    /// Whether it looks at the range of each pixel.
    pub takes_range: bool,
}

/// The network of a style, or its color table where it is asked for, or within the tolerance of the network.
pub(super) fn choose(given: &Given<'_>) -> Stage<StyleStep> {
    let Given { frame, style, .. } = *given;
    if frame.water.style.is_none() || frame.alpha <= 0.0 {
        return Stage::exact(StyleStep::Skip);
    }
    let distance = style
        .table_max_255
        .map(|max| frame.alpha * (STEEPEST * max / 255.0));
    let share = match frame.fidelity {
        Fidelity::Tolerance(tolerance) => Some(tolerance),
        _ => None,
    };
    let is_near = distance
        .zip(share)
        .is_some_and(|(distance, share)| distance <= share);
    let takes_table = match frame.water.style_tier {
        Some(StyleTier::Lut) => true,
        Some(StyleTier::Auto) => is_near,
        Some(StyleTier::Net) | None => false,
    };
    Stage {
        form: if takes_table {
            StyleStep::Table
        } else if style.takes_range {
            StyleStep::RangeNetwork
        } else {
            StyleStep::Network
        },
        share: share.filter(|_| takes_table),
        bound: distance.filter(|_| takes_table),
    }
}
