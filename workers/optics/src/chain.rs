//! The water stage: `I = D + F + B`, or `F` gathered from `D + B`.
//!
//! Jaffe–McGlamery as meant: light from the scene is split, e^{−cZ} arrives unscattered, e^{−GZ} − e^{−cZ} arrives spread,
//! and the veil of the water lies over both. (The paper's Eq. 3-4 convolve light that is already attenuated with a kernel
//! that attenuates again; `scatter_source: direct` does that to the letter.) The simplified form, Eq. 8-9, collects the
//! attenuated image with each pixel's kernel. What is done is in the plan; here is only how.

mod check;
mod fast;
mod reference;

pub use check::{ChainError, check_radiance};

use imaging::{Plane, Rgb};

use crate::attenuation::exp_negative;
use crate::forward_scatter::{KernelCache, MAX_REFERENCE_PIXELS};
use crate::plan::Plan;
use crate::range::{HoleRule, is_hole};
use crate::water::Water;

/// The parts of an underwater image in linear light, not clamped.
#[derive(Debug, Clone, PartialEq)]
pub struct Layers {
    /// D: light of the scene that arrives on its own ray.
    pub direct: Rgb<f32>,
    /// F: light that arrives scattered forward. In the simplified form: what gathering changed, which may be negative.
    pub forward_scatter: Rgb<f32>,
    /// B: the veil.
    pub backscatter: Rgb<f32>,
    /// The image.
    pub scattered: Rgb<f32>,
    /// Pixels without a valid range.
    pub holes: u64,
}

/// Takes a scene under water as planned. `radiance` is linear, finite and not negative ([`check_radiance`]).
///
/// # Errors
/// [`ChainError`]: sizes differ, the frame is empty, holes under the rule `reject`, a reference frame too large.
pub fn water(
    radiance: &Rgb<f32>,
    range: &Plane<f32>,
    water: &Water,
    plan: &Plan,
    cache: &mut KernelCache,
) -> Result<Layers, ChainError> {
    check::sizes(radiance, range)?;
    let holes = range.data().iter().filter(|&&z| is_hole(z)).count();
    if water.holes == HoleRule::Reject && holes > 0 {
        return Err(ChainError::Holes { holes });
    }
    let range = &filled(range, water.holes);
    let bands = if plan.reference {
        let pixels = range.data().len();
        if pixels > MAX_REFERENCE_PIXELS {
            return Err(ChainError::ReferenceTooLarge { pixels });
        }
        reference::bands(radiance, range, water, plan)
    } else {
        fast::bands(radiance, range, water, plan, cache)
    };
    let [r, g, b] = bands;
    let join = |part: fn(&Band) -> &Plane<f32>| {
        Rgb::new([part(&r).clone(), part(&g).clone(), part(&b).clone()]).expect("bands of one frame")
    };
    Ok(Layers {
        direct: join(|band| &band.direct),
        forward_scatter: join(|band| &band.forward),
        backscatter: join(|band| &band.veil),
        scattered: join(|band| &band.image),
        holes: holes as u64,
    })
}

/// One channel of [`Layers`].
struct Band {
    direct: Plane<f32>,
    forward: Plane<f32>,
    veil: Plane<f32>,
    image: Plane<f32>,
}

/// The range with holes replaced where the rule names a distance.
fn filled(range: &Plane<f32>, holes: HoleRule) -> Plane<f32> {
    match holes {
        HoleRule::Range(metres) => range.map(|&z| if is_hole(z) { metres as f32 } else { z }),
        HoleRule::Background | HoleRule::Reject => range.clone(),
    }
}

/// The largest valid range in metres, where holes take their kernel from; none if there is no valid range.
fn farthest(range: &Plane<f32>) -> Option<f64> {
    range
        .data()
        .iter()
        .copied()
        .filter(|&z| !is_hole(z))
        .reduce(f32::max)
        .map(f64::from)
}

/// Transmittance `exp(−c Z)` of every pixel; at a hole 0 where the water attenuates and 1 where it does not.
#[must_use]
pub fn transmittance(range: &Plane<f32>, water: &Water) -> Rgb<f32> {
    let range = filled(range, water.holes);
    let band = |channel: usize| {
        let c = water.direct_attenuation[channel] as f32;
        range.map(|&z| {
            if is_hole(z) {
                f32::from(u8::from(c == 0.0))
            } else {
                exp_negative(c * z)
            }
        })
    };
    Rgb::new([band(0), band(1), band(2)]).expect("bands of one frame")
}
