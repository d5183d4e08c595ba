//! What a frame needs for a tolerance: plain data, chosen before anything is computed.
//!
//! The tolerance is the largest error in linear light. A stage is skipped only where its whole effect stays below it; else
//! the cheapest form that meets it is taken. With the fast forward scatter the number of kernels comes from the closed form
//! of [`closed_form_terms`](crate::forward_scatter::closed_form_terms).

mod stats;

pub use stats::SceneStats;

use crate::forward_scatter::{Nodes, closed_form_terms};
use crate::haze::HazeLight;
use crate::kernel;
use crate::water::{Scatter, ScatterSource, Spread, Water};

/// How exact the water must be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fidelity {
    /// Largest error in linear light.
    Tolerance(f64),
    /// This many kernels, whatever the error.
    Terms(usize),
    /// The slow f64 form.
    Reference,
}

/// Forward scatter of one channel.
#[derive(Debug, Clone, PartialEq)]
pub enum ScatterStep {
    /// Its effect stays below the tolerance.
    Skip,
    /// The kernel is narrower than a pixel: what is scattered arrives where it left.
    Pointwise,
    /// Interpolation between these kernels.
    Interpolated(Nodes),
    /// Every pixel's own kernel, in f64.
    Reference,
}

/// The plan of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Whether attenuation runs in f64.
    pub reference: bool,
    /// Forward scatter, for each channel.
    pub scatter: [ScatterStep; 3],
    /// Whether the style network runs.
    pub style: bool,
    /// Lights that are drawn.
    pub lights: usize,
    /// The error in linear light that the scatter stays within, where it was chosen by tolerance.
    pub bound: Option<f64>,
}

/// One line of a plan for people and records.
#[derive(Debug, Clone, PartialEq)]
pub struct StageNote {
    /// The stage, with the channel where it differs between channels.
    pub stage: &'static str,
    /// What is done.
    pub variant: &'static str,
    /// Kernels, where there are some.
    pub terms: Option<usize>,
    /// Bound of the error in linear light, where one is known.
    pub bound: Option<f64>,
}

impl Plan {
    /// Chooses for a frame with range.
    #[must_use]
    pub fn for_frame(
        stats: &SceneStats,
        water: &Water,
        style_weight: Option<f64>,
        lights: &[HazeLight],
        fidelity: Fidelity,
    ) -> Self {
        let scatter = [0, 1, 2].map(|channel| scatter_step(stats, water, channel, fidelity));
        Self {
            reference: fidelity == Fidelity::Reference,
            scatter,
            bound: if let Fidelity::Tolerance(tolerance) = fidelity {
                Some(tolerance)
            } else {
                None
            },
            ..Self::without_water(style_weight, lights)
        }
    }

    /// The plan of a frame without range or without optics: the water stage is skipped.
    #[must_use]
    pub fn without_water(style_weight: Option<f64>, lights: &[HazeLight]) -> Self {
        Self {
            reference: false,
            scatter: [const { ScatterStep::Skip }; 3],
            style: style_weight.is_some_and(|alpha| alpha > 0.0),
            lights: lights.iter().filter(|light| light.shines()).count(),
            bound: None,
        }
    }

    /// The plan line by line.
    #[must_use]
    pub fn describe(&self) -> Vec<StageNote> {
        const STAGES: [&str; 3] = ["forward_scatter.r", "forward_scatter.g", "forward_scatter.b"];
        let scatter = self.scatter.iter().zip(STAGES).map(|(step, stage)| {
            let (variant, terms) = match step {
                ScatterStep::Skip => ("skip", None),
                ScatterStep::Pointwise => ("pointwise", None),
                ScatterStep::Interpolated(nodes) => ("chebyshev", Some(nodes.gammas().len())),
                ScatterStep::Reference => ("reference", None),
            };
            StageNote {
                stage,
                variant,
                terms,
                bound: self.bound,
            }
        });
        let simple = |stage, variant| StageNote {
            stage,
            variant,
            terms: None,
            bound: None,
        };
        let attenuation = simple("attenuation", if self.reference { "reference" } else { "f32" });
        let style = simple("style", if self.style { "network" } else { "skip" });
        let haze = simple("haze", if self.lights > 0 { "overlay" } else { "skip" });
        std::iter::once(attenuation)
            .chain(scatter)
            .chain([style, haze])
            .collect()
    }
}

fn scatter_step(stats: &SceneStats, water: &Water, channel: usize, fidelity: Fidelity) -> ScatterStep {
    let Some((nearest, farthest)) = stats.range_m else {
        return ScatterStep::Skip;
    };
    let Some((brightest, spread)) = spread_light(stats, water, channel, nearest, farthest) else {
        return ScatterStep::Skip;
    };
    let most_px = crate::forward_scatter::MAX_GAMMA_IN_SIDES * stats.longer_side as f64;
    let gamma = |metres: f64| (spread.offset_px[channel] + spread.per_m[channel] * metres).min(most_px);
    let (least, most) = (gamma(nearest), gamma(farthest));
    if fidelity == Fidelity::Reference {
        return ScatterStep::Reference;
    }
    let gathers = matches!(water.scatter, Scatter::Simplified { .. });
    if let Fidelity::Tolerance(tolerance) = fidelity {
        let moved = (1.0 - kernel::centre(most)) * brightest;
        if gathers && moved <= tolerance {
            return ScatterStep::Skip;
        }
        // A cone-shaped range can focus scattered light to this multiple, at most.
        let focus = 1.0 + FOCUS_PER_E_FOLD * (most / least).ln();
        if !gathers && focus.is_finite() && focus * brightest <= tolerance {
            return ScatterStep::Skip;
        }
        if !gathers && most < 0.5 && moved <= tolerance {
            return ScatterStep::Pointwise;
        }
    }
    let terms = match fidelity {
        Fidelity::Terms(terms) => terms,
        Fidelity::Tolerance(tolerance) => closed_form_terms(least, most, brightest, tolerance),
        Fidelity::Reference => unreachable!("answered above"),
    };
    let few = stats
        .distinct_m
        .as_ref()
        .filter(|distinct| distinct.len() <= terms);
    ScatterStep::Interpolated(match few {
        Some(distinct) => Nodes::exact(distinct.iter().map(|&metres| gamma(f64::from(metres))).collect()),
        None => Nodes::chebyshev(least, most, terms),
    })
}

/// Growth of the focused light for each factor e between the widest and the narrowest kernel.
const FOCUS_PER_E_FOLD: f64 = 0.385;

/// The brightest light that is spread, and how far; none where there is nothing to spread.
fn spread_light(
    stats: &SceneStats,
    water: &Water,
    channel: usize,
    nearest: f64,
    farthest: f64,
) -> Option<(f64, Spread)> {
    let radiance = f64::from(stats.brightest[channel]) * water.radiance_gain[channel];
    match water.scatter {
        Scatter::None => None,
        Scatter::Simplified { spread } => Some((radiance.max(water.veiling_light[channel]), spread)),
        Scatter::Jaffe { g, source, spread } => {
            let (g, c) = (
                g[channel].min(water.direct_attenuation[channel]),
                water.direct_attenuation[channel],
            );
            // e^{−GZ} − e^{−cZ} rises to its peak and then falls.
            let peak = if g > 0.0 && c > g {
                (c / g).ln() / (c - g)
            } else {
                f64::INFINITY
            };
            let at = peak.clamp(nearest, farthest);
            let share = (-g * at).exp() * -(-(c - g) * at).exp_m1();
            let arriving = if source == ScatterSource::Direct {
                (-c * nearest).exp()
            } else {
                1.0
            };
            let light = radiance * share * arriving;
            (light > 0.0).then_some((light, spread))
        }
    }
}
