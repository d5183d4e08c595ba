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

/// Attenuation of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AttenuationStep {
    /// There is no water.
    Skip,
    /// f32.
    Fast,
    /// f64.
    Reference,
}

/// The plan of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Attenuation; in f64 all of the water stage is.
    pub attenuation: AttenuationStep,
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
            attenuation: if fidelity == Fidelity::Reference {
                AttenuationStep::Reference
            } else {
                AttenuationStep::Fast
            },
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
            attenuation: AttenuationStep::Skip,
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
                ScatterStep::Interpolated(nodes) => ("chebyshev", Some(nodes.terms())),
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
        let attenuation = match self.attenuation {
            AttenuationStep::Skip => "skip",
            AttenuationStep::Fast => "f32",
            AttenuationStep::Reference => "reference",
        };
        let style = simple("style", if self.style { "network" } else { "skip" });
        let haze = simple("haze", if self.lights > 0 { "overlay" } else { "skip" });
        std::iter::once(simple("attenuation", attenuation))
            .chain(scatter)
            .chain([style, haze])
            .collect()
    }
}

fn scatter_step(stats: &SceneStats, water: &Water, channel: usize, fidelity: Fidelity) -> ScatterStep {
    if fidelity == Fidelity::Reference && water.scatter != Scatter::None {
        return ScatterStep::Reference;
    }
    let Some(light) = SpreadLight::of(stats, water, channel) else {
        return ScatterStep::Skip;
    };
    let gathers = matches!(water.scatter, Scatter::Simplified { .. });
    let gamma = |metres: f64| light.spread.gamma(channel, metres, stats.widest_px);
    let (least, most) = (gamma(light.nearest_m), gamma(light.farthest_m));
    if most == 0.0 {
        // The kernel is a delta.
        return if gathers {
            ScatterStep::Skip
        } else {
            ScatterStep::Pointwise
        };
    }
    let terms = match fidelity {
        Fidelity::Terms(terms) => terms,
        Fidelity::Tolerance(tolerance) => {
            if let Some(step) = cheap_step(&light, gathers, (least, most), tolerance) {
                return step;
            }
            closed_form_terms(least, most, light.brightest, tolerance)
        }
        Fidelity::Reference => return ScatterStep::Reference,
    };
    let few = stats
        .distinct_m
        .as_ref()
        .filter(|distinct| distinct.len() <= terms);
    ScatterStep::Interpolated(match few {
        Some(distinct) => Nodes::exact(distinct.iter().map(|&metres| gamma(f64::from(metres)))),
        None => Nodes::chebyshev(least, most, terms),
    })
}

/// What stays within the tolerance without any transform, if something does.
fn cheap_step(
    light: &SpreadLight,
    gathers: bool,
    (least, most): (f64, f64),
    tolerance: f64,
) -> Option<ScatterStep> {
    // Light that leaves its own pixel.
    let moved = (1.0 - kernel::centre(most)) * light.brightest;
    if gathers {
        return (moved <= tolerance).then_some(ScatterStep::Skip);
    }
    // A cone-shaped range can focus scattered light to this multiple, at most.
    let focus = 1.0 + FOCUS_PER_E_FOLD * (most / least).ln();
    if focus.is_finite() && focus * light.brightest <= tolerance {
        return Some(ScatterStep::Skip);
    }
    (most < 0.5 && moved <= tolerance).then_some(ScatterStep::Pointwise)
}

/// Growth of the focused light for each factor e between the widest and the narrowest kernel.
const FOCUS_PER_E_FOLD: f64 = 0.385;

/// The light of one channel that is spread, and from which ranges.
struct SpreadLight {
    /// Bound of its largest value.
    brightest: f64,
    spread: Spread,
    nearest_m: f64,
    farthest_m: f64,
}

impl SpreadLight {
    /// None where there is nothing to spread.
    fn of(stats: &SceneStats, water: &Water, channel: usize) -> Option<Self> {
        let radiance = f64::from(stats.brightest[channel]) * water.radiance_gain[channel];
        match water.scatter {
            Scatter::None => None,
            Scatter::Simplified { spread } => {
                let (nearest_m, farthest_m) = stats.range_m?;
                let brightest = radiance.max(water.veiling_light[channel]);
                Some(Self {
                    brightest,
                    spread,
                    nearest_m,
                    farthest_m,
                })
            }
            Scatter::Jaffe { g, source, spread } => {
                let (nearest_m, farthest_m) = stats.lit_m[channel]?;
                let c = water.direct_attenuation[channel];
                let share = largest_share(g[channel].min(c), c, nearest_m, farthest_m);
                let arriving = if source == ScatterSource::Direct {
                    (-c * nearest_m).exp()
                } else {
                    1.0
                };
                let brightest = radiance * share * arriving;
                (brightest > 0.0).then_some(Self {
                    brightest,
                    spread,
                    nearest_m,
                    farthest_m,
                })
            }
        }
    }
}

/// The largest `e^{−GZ} − e^{−cZ}` between two ranges: it rises to its peak at `ln(c/G)/(c − G)` and then falls.
fn largest_share(g: f64, c: f64, nearest_m: f64, farthest_m: f64) -> f64 {
    let peak = if g > 0.0 && c > g {
        (c / g).ln() / (c - g)
    } else {
        f64::INFINITY
    };
    let at = peak.clamp(nearest_m, farthest_m);
    (-g * at).exp() * -(-(c - g) * at).exp_m1()
}

#[cfg(test)]
mod tests;
