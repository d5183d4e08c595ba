//! Derivation of forward scatter.

use spec::{ForwardScatter, PhaseFunction, ScatterModel};

use super::super::two_kernels;
use super::checks::{Checks, Coefficients, G_SHARE_OF_SCATTERING};
use crate::medium::{Kernels, Medium};
use crate::water::model::{Scatter, Spread, Tail};

const SPREAD_OFFSET_RAD: f64 = 0.009;
const SPREAD_PER_SCATTERING_RAD: f64 = 0.009;

/// The scatter of true meters in lengths of the range.
pub(super) fn scaled_scatter(scatter: Scatter, scale: f64) -> Scatter {
    let wider = |spread: Spread| Spread {
        per_m: spread.per_m.map(|k| k * scale),
        ..spread
    };
    match scatter {
        Scatter::None => Scatter::None,
        Scatter::Jaffe {
            g,
            source,
            spread,
            tail,
            layers,
        } => Scatter::Jaffe {
            g: g.map(|g| g * scale),
            source,
            spread: wider(spread),
            tail: tail.map(|tail| Tail {
                spread: wider(tail.spread),
                share_per_m: tail.share_per_m.map(|m| m * scale),
                ..tail
            }),
            layers,
        },
        Scatter::Simplified { spread } => Scatter::Simplified {
            spread: wider(spread),
        },
    }
}

impl Checks {
    /// The described model, or the usual one of a water with or without known parts.
    pub(super) fn scatter(&mut self, medium: &Medium, known: &Coefficients) -> Scatter {
        let has_parts = known.absorption.is_some() && known.scattering.is_some();
        let usual = ForwardScatter::from(if has_parts {
            ScatterModel::Jaffe
        } else {
            ScatterModel::None
        });
        let described = medium.optics.forward_scatter.as_ref().unwrap_or(&usual);
        self.errors.extend(two_kernels::contradictions(medium));
        match described.model {
            ScatterModel::None => Scatter::None,
            ScatterModel::Simplified => self
                .spread(described, known)
                .map_or(Scatter::None, |spread| Scatter::Simplified { spread }),
            ScatterModel::Jaffe => {
                let g = self.g(described, known);
                let kernels = match medium.kernels {
                    Kernels::Two => self.two_kernels(medium.optics.phase, known),
                    Kernels::One => self.spread(described, known).map(|spread| (spread, None)),
                };
                g.zip(kernels)
                    .map_or(Scatter::None, |(g, (spread, tail))| Scatter::Jaffe {
                        g,
                        source: described.source,
                        spread,
                        tail,
                        layers: medium.layers,
                    })
            }
        }
    }

    fn two_kernels(&mut self, phase: PhaseFunction, known: &Coefficients) -> Option<(Spread, Option<Tail>)> {
        let Some(b) = known.scattering else {
            self.missing(
                "scattering_per_m",
                "the two kernels of forward scatter follow from it",
            );
            return None;
        };
        self.derived.extend(["spread_px_per_m", "spread_offset_px"]);
        let (narrow, tail) = two_kernels::kernels(phase, b, known.focal_px);
        Some((narrow, Some(tail)))
    }

    fn g(&mut self, request: &ForwardScatter, known: &Coefficients) -> Option<[f64; 3]> {
        if request.g_per_m.is_none() {
            let Some((a, b)) = known.absorption.zip(known.scattering) else {
                let reason = "give it, or both absorption_per_m and scattering_per_m";
                self.missing("g_per_m", reason);
                return None;
            };
            self.derived.push("g_per_m");
            // The sum of rounded a and b may fall short of a given c by rounding; G may not exceed it.
            let limit = known.attenuation.unwrap_or([f64::INFINITY; 3]);
            return Some([0, 1, 2].map(|i| (a[i] + G_SHARE_OF_SCATTERING * b[i]).min(limit[i])));
        }
        self.within_attenuation("g_per_m", request.g_per_m, known.attenuation);
        request.g_per_m
    }

    fn spread(&mut self, request: &ForwardScatter, known: &Coefficients) -> Option<Spread> {
        if let Some(per_m) = request.spread_px_per_m {
            return Some(Spread {
                offset_px: request.spread_offset_px.unwrap_or([0.0; 3]),
                per_m,
            });
        }
        let Some(b) = known.scattering else {
            let reason = "give it, or scattering_per_m to derive it from";
            self.missing("spread_px_per_m", reason);
            return None;
        };
        self.derived.push("spread_px_per_m");
        let offset_px = request.spread_offset_px.unwrap_or_else(|| {
            self.derived.push("spread_offset_px");
            [SPREAD_OFFSET_RAD * known.focal_px; 3]
        });
        Some(Spread {
            offset_px,
            per_m: b.map(|b| SPREAD_PER_SCATTERING_RAD * b * known.focal_px),
        })
    }
}
