//! A water: its scattering and its kernels.

use spec::{HoleRule, PhaseFunction, ScatterSource};

use crate::daylight::Daylight;

/// Width of the forward-scatter kernel: `γ(Z) = offset + per_meter · Z` in pixels, for each channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// γ₀ in pixels, at least 0.
    pub offset_px: [f64; 3],
    /// k in pixels per meter, at least 0.
    pub per_m: [f64; 3],
}

impl Spread {
    /// `min(γ₀ + k Z, widest)` in pixels, in one channel at a range in meters. Planner and executor share this function: they must
    /// agree to the last bit on the scales of a frame.
    #[must_use]
    pub fn gamma(&self, channel: usize, range_m: f64, widest_px: f64) -> f64 {
        (self.offset_px[channel] + self.per_m[channel] * range_m).min(widest_px)
    }

    /// The same in f32, for interpolated kernels at any range.
    #[inline(always)]
    pub(crate) fn scales(&self, channel: usize, widest_px: f64, range: &[f32], gammas: &mut [f32]) {
        let (offset, per_m) = (self.offset_px[channel] as f32, self.per_m[channel] as f32);
        let widest = widest_px as f32;
        for (gamma, &z) in gammas.iter_mut().zip(range) {
            let scale = offset + per_m * z;
            *gamma = if scale < widest { scale } else { widest };
        }
    }
}

/// The wider of two kernels, and its share of the spread light, `m(Z) = min(1, m₀ + m₁ Z)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tail {
    /// How far it spreads.
    pub spread: Spread,
    /// m₀.
    pub share: f64,
    /// m₁ of each channel, 1/m.
    pub share_per_m: [f64; 3],
}

impl Tail {
    /// m of one channel at a range in meters.
    #[must_use]
    pub fn share_at(&self, channel: usize, range_m: f64) -> f64 {
        (self.share + self.share_per_m[channel] * range_m).min(1.0)
    }

    /// Divides light between the two kernels.
    #[inline(always)]
    pub(crate) fn split(&self, channel: usize, range: &[f32], narrow: &mut [f32], wide: &mut [f32]) {
        let (at_zero, per_m) = (self.share as f32, self.share_per_m[channel] as f32);
        for ((narrow, wide), &z) in narrow.iter_mut().zip(wide).zip(range) {
            let share = at_zero + per_m * z;
            let share = if share < 1.0 { share } else { 1.0 };
            *wide = *narrow * share;
            *narrow *= 1.0 - share;
        }
    }
}

/// Forward scatter of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scatter {
    /// No forward scatter.
    None,
    /// The Jaffe–McGlamery form: each point of the scene spreads with the kernel of its range.
    Jaffe {
        /// G in 1/m, 0 ≤ G ≤ c.
        g: [f64; 3],
        /// The spread light.
        source: ScatterSource,
        /// How far, of two kernels the narrow one.
        spread: Spread,
        /// The wide kernel, if there are two.
        tail: Option<Tail>,
        /// Most layers of a frame whose near objects occlude spread light from behind; `None` disables occlusion.
        layers: Option<usize>,
    },
    /// The simplified form: each pixel of the attenuated image gathers with the kernel of its range.
    Simplified {
        /// How far.
        spread: Spread,
    },
}

/// A water that is complete and consistent. Coefficients in 1/m along the ray, already multiplied by the range scale.
#[derive(Debug, Clone, PartialEq)]
pub struct Water {
    pub(crate) preset: Option<&'static str>,
    pub(crate) absorption: Option<[f64; 3]>,
    pub(crate) scattering: Option<[f64; 3]>,
    pub(crate) direct_attenuation: [f64; 3],
    pub(crate) backscatter_attenuation: [f64; 3],
    pub(crate) diffuse_attenuation: Option<[f64; 3]>,
    pub(crate) veiling_light: [f64; 3],
    pub(crate) radiance_gain: [f64; 3],
    pub(crate) scatter: Scatter,
    pub(crate) backscatter_fraction: f64,
    pub(crate) glow_phase: PhaseFunction,
    pub(crate) daylight: Option<Daylight>,
    pub(crate) holes: HoleRule,
    pub(crate) derived: Vec<&'static str>,
}
