//! Airlight of lamps in f32, with node counts chosen by the tolerance.
//!
//! With β = θ/2 + π/4 and u = tan β the integral of the reference needs no angle but β: the path to the lamp and back is t₀ + D u,
//! sin θ is sin² β − cos² β, and the denominator of the phase function is (1 + g)² sin² β + (1 − g)² cos² β, without cancellation.
//! Rows are cut into runs of pixels; each run and lamp has a separate number of nodes.

mod composite;
mod integrand;
mod intervals;
mod precise;
mod rounding;
mod shadowed;
mod spread;

pub use shadowed::shaded_airlight;

use std::sync::LazyLock;

use imaging::vectorized;
use imaging::{Plane, Rgb};

use super::beam::Beam;
use super::beam::Profile;
use super::multiple::{SATURATION, SWELL};
use super::nodes::{self, MOST_NODES, Source};
use super::patches;
use super::{GlowPhase, Lamp, Lighting};
use crate::elementary::{HALVINGS, small_sin_cos};
use crate::error_bound::ErrorBound;
use crate::extremes::brightest;
use crate::legendre::gauss_legendre;
use crate::turbidity;
use integrand::scattered;
use intervals::{Intervals, Murk, Rays, extreme, intervals, murk_of, rays_of};
use rounding::Rounding;

/// Pixels of a run: short enough that they need about the same number of nodes.
const RUN: usize = turbidity::RUN;
/// Larger ranges count as this, m.
const FARTHEST_M: f32 = 1e6;

type Lanes = [f32; RUN];

/// The rules of 0, 2, 4, … nodes.
static RULES: LazyLock<Vec<Vec<[f32; 2]>>> = LazyLock::new(|| (0..=MOST_NODES / 2).map(half_rule).collect());

/// Airlight of lamps. All samples are within `left + rounding` and the tolerated share of themselves of
/// [`airlight_reference`](super::airlight_reference).
#[derive(Debug, Clone, PartialEq)]
pub struct Airlight {
    /// Radiance in linear light.
    pub light: Rgb<f32>,
    /// Error bound of the quadrature, beyond the tolerated share of the light.
    pub left: f64,
    /// Error bound of f32 rounding.
    pub rounding: f64,
}

impl Airlight {
    /// The largest light of a pixel in any channel.
    #[must_use]
    pub fn peak(&self) -> f64 {
        f64::from(brightest(&self.light).into_iter().fold(0.0, f32::max))
    }
}

/// [`airlight_reference`](super::airlight_reference) in f32. The quadrature error is below `tolerance` in linear light if
/// [`MOST_NODES`] suffice for it. `range` in meters along the ray; a hole is infinite.
#[must_use]
pub fn airlight(range: &Plane<f32>, lighting: &Lighting, tolerance: f64) -> Airlight {
    airlight_within(f64::INFINITY, range, lighting, ErrorBound::absolute(tolerance))
}

/// [`airlight`] with a rounding error of at most `rounding` and one more rounding of the light, for single scattering. Runs of
/// pixels with a larger bound in f32 are computed in f64. Multiple scattering has no such limit; only its quadrature uses the
/// relative part of the tolerance.
#[must_use]
pub fn airlight_within(
    rounding: f64,
    range: &Plane<f32>,
    lighting: &Lighting,
    tolerance: ErrorBound,
) -> Airlight {
    // Shares of the light of each lamp add up to the same share of their sum.
    let share = ErrorBound {
        absolute: tolerance.absolute / lighting.lamps.len().max(1) as f64,
        ..tolerance
    };
    glow(range, lighting, (Order::Within(share), rounding))
}

/// [`airlight`] with the same number of nodes on every ray: an even one from 2 to [`MOST_NODES`], any other is brought to the next
/// below or to these ends.
#[must_use]
pub fn airlight_with_nodes(range: &Plane<f32>, lighting: &Lighting, nodes: usize) -> Rgb<f32> {
    let nodes = nodes.clamp(2, MOST_NODES);
    glow(range, lighting, (Order::Fixed(nodes), f64::INFINITY)).light
}

/// Node count of a run of pixels.
#[derive(Clone, Copy)]
enum Order {
    /// The least count that keeps the error of one lamp within this tolerance.
    Within(ErrorBound),
    /// A fixed count.
    Fixed(usize),
}

impl Order {
    /// The tolerated error of one lamp; 0 with a fixed count.
    fn tolerance(self) -> ErrorBound {
        match self {
            Self::Within(tolerance) => tolerance,
            Self::Fixed(_) => ErrorBound::EXACT,
        }
    }
}

fn glow(range: &Plane<f32>, lighting: &Lighting, (order, limit): (Order, f64)) -> Airlight {
    let (width, height) = range.size();
    let mut glow = [const { Vec::new() }; 3].map(|_: Vec<f32>| vec![0.0f32; width * height]);
    let rules = &*RULES;
    let mut errors = Errors::default();
    if lighting.absorption.is_some() {
        let mut room = Vec::new();
        for lamp in &lighting.lamps {
            let own = spread::add(range, (lamp, lighting), (rules, order), (&mut glow, &mut room));
            errors.left += own.left;
            errors.rounding += own.rounding;
        }
    } else {
        errors = once(range, lighting, (rules, order, limit), &mut glow);
    }
    let plane = |data| Plane::new(width, height, data).expect("one sample for each pixel");
    Airlight {
        light: Rgb::new(glow.map(plane)).expect("planes of one frame"),
        left: errors.left,
        rounding: errors.rounding,
    }
}

/// Sets the single scattering, in f64 if its rounding in f32 is above a limit.
fn once(
    range: &Plane<f32>,
    lighting: &Lighting,
    (rules, order, limit): (&[Vec<[f32; 2]>], Order, f64),
    glow: &mut [Vec<f32>; 3],
) -> Errors {
    let (width, height) = range.size();
    let lamps = shining(lighting, |lamp| Some(Glow::new(lamp, lighting, order)));
    let camera = &lighting.camera;
    let lens = [1.0 / camera.focal_px, camera.cx, camera.cy].map(|v| v as f32);
    let patches = (lighting.patches.as_ref()).map(|field| turbidity::Rays::new(field, camera));
    let mut worst = Errors::default();
    for start in (0..height).flat_map(|y| (0..width).step_by(RUN).map(move |x| (x, y))) {
        let (x, y) = start;
        let run = RUN.min(width - x);
        let at = y * width + x;
        let mut range_m = [f32::INFINITY; RUN];
        range_m[..run].copy_from_slice(&range.data()[at..at + run]);
        let mut rays = Rays::default();
        vectorized!(rays_of(lens, start, &range_m, &mut rays));
        let mut sum = [[0.0f32; RUN]; 3];
        let mut errors = Errors::default();
        for lamp in &lamps {
            let mut murk = Murk::default();
            if let Some(patches) = &patches {
                vectorized!(murk_of(lamp, &rays, patches, start, &mut murk));
            }
            add_once(lamp, &rays, &murk, (rules, &mut sum, &mut errors));
        }
        if errors.rounding > limit {
            errors.rounding = precise::sum_up(range, lighting, (x..x + run, y), &mut sum);
        }
        worst.include(errors);
        for (plane, sum) in glow.iter_mut().zip(&sum) {
            plane[at..at + run].copy_from_slice(&sum[..run]);
        }
    }
    worst
}

/// Error bounds of all lamps together on a run of pixels.
#[derive(Default)]
struct Errors {
    left: f64,
    rounding: f64,
}

impl Errors {
    /// Each the greater of both.
    fn include(&mut self, other: Self) {
        self.left = self.left.max(other.left);
        self.rounding = self.rounding.max(other.rounding);
    }
}

/// The lamps of nonzero strength in f32.
fn shining(lighting: &Lighting, single: impl Fn(&Lamp) -> Option<Glow>) -> Vec<Glow> {
    let glows = lighting.lamps.iter().filter_map(single);
    glows.filter(|glow| glow.source.strength > 0.0).collect()
}

/// The positive nodes of the rule of 2 · `half` nodes; the others mirror them.
fn half_rule(half: usize) -> Vec<[f32; 2]> {
    let rule = gauss_legendre(2 * half);
    rule[..half].iter().map(|&(x, w)| [x as f32, w as f32]).collect()
}

/// One lamp in f32.
struct Glow {
    place: [f32; 3],
    radius: f32,
    /// Start of the airlight before the nearest point, in distances of the lamp from the ray.
    before: f32,
    profile: Profile,
    /// (1 − g)² and 4 g, its increase with sin² β.
    denominator: [f32; 2],
    /// 4π K/(1 − g²).
    rise: f32,
    /// c in halvings per meter; a with multiple scattering.
    attenuation: [f32; 3],
    /// For multiple scattering: b, and a in halvings per meter.
    scattering: [f32; 3],
    absorption: [f32; 3],
    /// 4 b I₀ (1 − g²)/(4π) of each channel: both steps from θ to β and from the interval to −1..=1.
    gain: [f32; 3],
    source: Source,
    /// Share of its light that the quadrature may err by besides the tolerance of the source.
    tolerated_share: f64,
    rounding: Rounding,
    /// Nodes of every run; `None`: chosen by the source's tolerance.
    fixed: Option<usize>,
}

/// Upper bound of the ratio of spread light to light that only absorption attenuates: e to the power of 0.06 · 8.
const MOST_SWELL: f64 = SWELL * SATURATION;

impl Glow {
    /// Unscattered lamp light; of a point lamp, together with multiple scattering.
    fn new(lamp: &Lamp, lighting: &Lighting, order: Order) -> Self {
        match lighting.absorption {
            Some(a) if lamp.beam == Beam::Point => Self::made(lamp, lighting, (order, a, MOST_SWELL)),
            _ => Self::made(lamp, lighting, (order, lighting.attenuation, 0.0)),
        }
    }

    /// The scattered lamp light of a spot, if multiple scattering is modeled.
    fn spread(lamp: &Lamp, lighting: &Lighting, order: Order) -> Option<Self> {
        let absorption = lighting.absorption.filter(|_| lamp.beam != Beam::Point)?;
        let mut glow = Self::made(lamp, lighting, (order, absorption, MOST_SWELL));
        glow.attenuation = lighting.attenuation.map(|c| c as f32 * HALVINGS);
        glow.source.edge = greatest(lighting.attenuation);
        Some(glow)
    }

    /// Addition of the phase function to Henyey and Greenstein for sin² β = `ss`: 4π K/(1 − g²) (3 cos² 2β − 1).
    #[inline(always)]
    fn rise_at(&self, ss: f32) -> f32 {
        ss.mul_add(ss, -ss).mul_add(12.0 * self.rise, 2.0 * self.rise)
    }

    /// A lamp whose light fades by `least` per meter after it has swollen by the exponential of `swell` at most.
    fn made(lamp: &Lamp, lighting: &Lighting, (order, least, swell): (Order, [f64; 3], f64)) -> Self {
        let single = |values: [f64; 3]| values.map(|v| v as f32);
        let GlowPhase { asymmetry: g, rise } = lighting.phase;
        let strength = [0, 1, 2].map(|i| lighting.scattering[i] * lamp.intensity[i] * swell.exp());
        let constant = 2.0 * (1.0 - g * g) / (4.0 * std::f64::consts::PI);
        let halvings = single(least.map(|c| c * f64::from(HALVINGS)));
        let fading = least.into_iter().fold(f64::INFINITY, f64::min);
        Self {
            place: single(lamp.position_m),
            radius: lighting.radius_m as f32,
            before: patches::before(g) as f32,
            profile: lamp.beam.single(),
            denominator: [((1.0 - g) * (1.0 - g)) as f32, (4.0 * g) as f32],
            rise: (rise / (constant / 2.0)) as f32,
            attenuation: halvings,
            scattering: single(lighting.scattering),
            absorption: halvings,
            gain: single(strength.map(|s| s * constant)),
            source: Source {
                strength: greatest(strength),
                attenuation: fading,
                edge: if swell > 0.0 { greatest(least) } else { fading },
                swelling: if swell > 0.0 {
                    greatest(lighting.scattering) / SATURATION
                } else {
                    0.0
                },
                phase: lighting.phase,
                tolerance: order.tolerance().absolute,
            },
            tolerated_share: order.tolerance().relative,
            rounding: Rounding::new(lamp, lighting, (least, strength)),
            fixed: match order {
                Order::Within(_) => None,
                Order::Fixed(nodes) => Some(nodes),
            },
        }
    }
}

fn greatest(values: [f64; 3]) -> f64 {
    values.into_iter().fold(0.0, f64::max)
}

/// Rules of the quadrature, and the light and the errors of a run of pixels to add to.
type Light<'a> = (&'a [Vec<[f32; 2]>], &'a mut [Lanes; 3], &'a mut Errors);

/// [`add`] for single scattering.
fn add_once(lamp: &Glow, rays: &Rays, murk: &Murk, (rules, sum, errors): Light<'_>) {
    match (lamp.profile.slope > 0.0, lamp.rise > 0.0) {
        (true, true) => vectorized!(add::<true, false, true>(lamp, rays, murk, (rules, sum, errors))),
        (true, false) => vectorized!(add::<true, false, false>(lamp, rays, murk, (rules, sum, errors))),
        (false, true) => vectorized!(add::<false, false, true>(lamp, rays, murk, (rules, sum, errors))),
        (false, false) => vectorized!(add::<false, false, false>(lamp, rays, murk, (rules, sum, errors))),
    }
}

#[inline(always)]
fn add<const SPOT: bool, const SPREAD: bool, const RISES: bool>(
    lamp: &Glow,
    rays: &Rays,
    murk: &Murk,
    (rules, sum, errors): Light<'_>,
) {
    let (intervals, span) = intervals::<SPOT, false>(lamp, rays, murk);
    if span.to <= span.from {
        return;
    }
    let (count, left) = match lamp.fixed {
        Some(count) => (count, 0.0),
        None => nodes::count(span, lamp.source),
    };
    if SPREAD && left > lamp.source.tolerance && lamp.fixed.is_none() {
        // The bound of the rule is far above its error if light swells late.
        let own =
            composite::sum_up::<false>(lamp, &intervals, composite::spacing(lamp.source.phase.asymmetry));
        let mut most = [0.0f32; RUN];
        for (sum, light) in sum.iter_mut().zip(&own.light) {
            for i in 0..RUN {
                sum[i] += light[i];
                most[i] = most[i].max(light[i]);
            }
        }
        errors.left += own.left;
        errors.rounding += lamp.rounding.within(span, extreme(&most, f32::max));
        return;
    }
    let rule = &rules[count / 2];
    let mut light = [[0.0f32; RUN]; 3];
    for &node in rule {
        quadrature::<SPOT, SPREAD, RISES>(lamp, &intervals, node, &mut light);
    }
    let mut most = [0.0f32; RUN];
    for ((sum, light), gain) in sum.iter_mut().zip(&light).zip(lamp.gain) {
        for i in 0..RUN {
            let glow = gain * intervals.scale[i] * light[i];
            sum[i] += glow;
            most[i] = most[i].max(glow);
        }
    }
    errors.left += left;
    errors.rounding += lamp.rounding.within(span, extreme(&most, f32::max));
}

/// Adds the two nodes `±node` of every pixel.
#[inline(always)]
fn quadrature<const SPOT: bool, const SPREAD: bool, const RISES: bool>(
    lamp: &Glow,
    to: &Intervals,
    [node, weight]: [f32; 2],
    light: &mut [Lanes; 3],
) {
    let [red, green, blue] = light;
    for i in 0..RUN {
        let (sin, cos) = (to.sin[i], to.cos[i]);
        let (sin_step, cos_step) = small_sin_cos(to.half[i] * node);
        let (ss, cc) = (sin * cos_step, cos * cos_step);
        let at = [to.nearest[i], to.distance[i], to.across[i], to.along[i]];
        let above = (cos.mul_add(sin_step, ss), (-sin).mul_add(sin_step, cc));
        let below = ((-cos).mul_add(sin_step, ss), sin.mul_add(sin_step, cc));
        let [r1, g1, b1] = scattered::<SPOT, SPREAD, RISES>(lamp, at, above);
        let [r2, g2, b2] = scattered::<SPOT, SPREAD, RISES>(lamp, at, below);
        red[i] = weight.mul_add(r1 + r2, red[i]);
        green[i] = weight.mul_add(g1 + g2, green[i]);
        blue[i] = weight.mul_add(b1 + b2, blue[i]);
    }
}
