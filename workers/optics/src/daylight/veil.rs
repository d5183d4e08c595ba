//! The veil of one channel by direction, in f64 and in f32.

use imaging::Plane;
use imaging::vectorized;

use super::field::{CRITICAL_COSINE, EDGE_INSIDE, Field, LEAST_COSINE, MOST_GAIN, REFRACTIVE_INDEX};
use super::gaze::Gaze;
use crate::attenuation::{exp_negative, masked, one_minus_exp_negative};
use crate::range::is_hole;

/// Pixels that are looked at together for holes.
const RUN: usize = 64;
/// One rounding of f32.
const STEP: f64 = 6e-8;

/// The veil of one channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VeilOf {
    /// Its radiance field, whose K is at most 0.95 c.
    pub(crate) field: Field,
    /// c of the veil, per unit of range.
    pub(crate) attenuation: f64,
    /// B_h, the veiling light at the horizon.
    pub(crate) light: f64,
    /// h, depth of the camera in lengths of the range.
    pub(crate) depth: f64,
}

impl VeilOf {
    /// B at a cosine from the vertical, before a surface at this range or in open water; 0 where the water attenuates nothing.
    #[must_use]
    pub fn at(&self, rise: f64, range: Option<f64>) -> f64 {
        if self.attenuation <= 0.0 {
            return 0.0;
        }
        let source = self.light * self.field.shape.phi(rise);
        let within = |range: f64| source * -(-(self.attenuation - self.field.decay * rise) * range).exp_m1();
        match range {
            Some(range) => within(range),
            None if rise > 0.0 => within(self.depth / rise).max(self.sky(rise)),
            None => source,
        }
    }

    /// The sky through the window in units of the veil.
    fn sky(&self, rise: f64) -> f64 {
        self.light / self.field.shape.horizon * self.field.sky(rise, self.depth)
    }

    /// The greatest veil between two cosines, with open water in view or without.
    pub(crate) fn brightest(&self, rises: (f64, f64), is_open: bool) -> f64 {
        if self.attenuation <= 0.0 {
            return 0.0;
        }
        let water = self.light * self.field.shape.extremes(rises).1;
        // The sky brightens towards the zenith.
        let sky = if is_open && rises.1 > 0.0 {
            self.sky(rises.1)
        } else {
            0.0
        };
        water.max(sky)
    }

    /// No veil between these cosines and ranges is farther from that of constant water than this; infinite where the window may be
    /// seen.
    ///
    /// With A = 1 − e^{−(c − K μ) Z} and A₀ = 1 − e^{−c Z}: `|Φ A − A₀| ≤ |Φ − 1| A + |A − A₀|`, where the second is greatest at
    /// `Z = ln(c/(c − K μ))/(K μ)` or at an end.
    pub(crate) fn change(&self, rises: (f64, f64), (near, far): (f64, f64), is_open: bool) -> f64 {
        let (least, most) = self.field.shape.extremes(rises);
        let uneven = (most - 1.0).abs().max((least - 1.0).abs());
        let c = self.attenuation;
        if c <= 0.0 {
            return 0.0;
        }
        let shift = |rise: f64| {
            let k = self.field.decay * rise;
            let peak = if k.abs() > 1e-12 * c {
                (c / (c - k)).ln() / k
            } else {
                1.0 / c
            };
            let at = peak.clamp(near, far);
            ((-(c - k) * at).exp() - (-c * at).exp()).abs()
        };
        let moved = shift(rises.0).max(shift(rises.1));
        let surfaces = uneven + moved;
        if !is_open {
            return self.light * surfaces;
        }
        if rises.1 > CRITICAL_COSINE - 0.5 * self.field.edge(self.depth) {
            return f64::INFINITY;
        }
        let above = if rises.1 > 0.0 {
            most * (-(c - self.field.decay * rises.1) * self.depth / rises.1).exp()
        } else {
            0.0
        };
        self.light * (surfaces + above)
    }

    /// What f32 may lose of the veil: roundings of μ and of the exponent of Φ, which may grow by p + 2 |q| times them, and in open
    /// water those of the window's edge, whose profile rises by 1.5 over its width.
    pub(crate) fn rounding(&self, rises: (f64, f64), is_open: bool) -> f64 {
        let slope = self.field.shape.p + 2.0 * self.field.shape.q.abs();
        let water = self.brightest(rises, false) * STEP * (20.0 + 8.0 * slope);
        if !is_open {
            return water;
        }
        let edge = 1.5 / self.field.edge(self.depth);
        let exponent = (self.field.window / CRITICAL_COSINE + self.field.decay) * self.depth;
        let sky = if rises.1 > 0.0 { self.sky(rises.1) } else { 0.0 };
        water + sky * STEP * (20.0 + 4.0 * edge + 4.0 * exponent)
    }
}

/// The veil of a channel in f64, pixel by pixel. Holes show open water.
#[must_use]
pub fn veil_reference(range: &Plane<f64>, of: &VeilOf, gaze: &Gaze) -> Plane<f64> {
    Plane::from_fn(range.width(), range.height(), |x, y| {
        let z = range.pixel(x, y);
        of.at(gaze.rise(x, y), (!is_hole(z)).then_some(z))
    })
}

/// [`veil_reference`] in f32 into `to`, which has a sample for each pixel.
///
/// # Panics
/// If it has not.
pub fn veil(range: &Plane<f32>, of: &VeilOf, gaze: &Gaze, to: &mut [f32]) {
    assert_eq!(range.data().len(), to.len(), "a sample for each pixel");
    if of.attenuation <= 0.0 {
        to.fill(0.0);
        return;
    }
    let width = range.width();
    if width == 0 {
        return;
    }
    let single = Single::new(of);
    let mut rises = vec![0.0f32; width];
    for (y, to) in to.chunks_exact_mut(width).enumerate() {
        let row = Row::new(gaze, y);
        vectorized!(rises_of(row, &mut rises));
        let range = range.row(y);
        vectorized!(surfaces(single, range, &rises, to));
        for start in (0..width).step_by(RUN) {
            let run = start..(start + RUN).min(width);
            let is_open = range[run.clone()].iter().any(|&z| !masked(z).0);
            if is_open {
                vectorized!(open_water(
                    single,
                    &range[run.clone()],
                    &rises[run.clone()],
                    &mut to[run.clone()]
                ));
            }
        }
    }
}

/// The rays of a row against the vertical: `(up_x u + level)/sqrt(u² + square)`.
#[derive(Clone, Copy)]
pub(super) struct Row {
    inverse_focal: f32,
    cx: f32,
    across: f32,
    level: f32,
    square: f32,
}

impl Row {
    pub(super) fn new(gaze: &Gaze, y: usize) -> Self {
        let v = (y as f64 - gaze.camera.cy) / gaze.camera.focal_px;
        let [x, down, ahead] = gaze.up;
        Self {
            inverse_focal: (1.0 / gaze.camera.focal_px) as f32,
            cx: gaze.camera.cx as f32,
            across: x as f32,
            level: (down * v + ahead) as f32,
            square: (v * v + 1.0) as f32,
        }
    }
}

#[inline(always)]
pub(super) fn rises_of(row: Row, rises: &mut [f32]) {
    let Row {
        inverse_focal,
        cx,
        across,
        level,
        square,
    } = row;
    for (x, rise) in rises.iter_mut().enumerate() {
        let u = (x as i32 as f32 - cx) * inverse_focal;
        *rise = (across * u + level) / (u * u + square).sqrt();
    }
}

/// [`VeilOf`] in f32.
#[derive(Clone, Copy)]
struct Single {
    p: f32,
    q: f32,
    attenuation: f32,
    decay: f32,
    light: f32,
    depth: f32,
    edge: f32,
    /// `(a + 0.1 b) h` and `K h`.
    lost: [f32; 2],
    sky: f32,
}

impl Single {
    fn new(of: &VeilOf) -> Self {
        let VeilOf { field, depth, .. } = of;
        let n = REFRACTIVE_INDEX;
        Self {
            p: field.shape.p as f32,
            q: field.shape.q as f32,
            attenuation: of.attenuation as f32,
            decay: field.decay as f32,
            light: of.light as f32,
            depth: *depth as f32,
            edge: (1.0 / field.edge(*depth)) as f32,
            lost: [(field.window * depth) as f32, (field.decay * depth) as f32],
            sky: (of.light / field.shape.horizon * n * n / std::f64::consts::PI) as f32,
        }
    }
}

/// `Φ(μ)`: the exponential holds for both signs.
#[inline(always)]
fn phi(p: f32, q: f32, rise: f32) -> f32 {
    exp_negative(-(rise * (p + q * rise)))
}

#[inline(always)]
fn surfaces(of: Single, range: &[f32], rises: &[f32], to: &mut [f32]) {
    let Single {
        p,
        q,
        attenuation,
        decay,
        light,
        ..
    } = of;
    for (to, (&z, &rise)) in to.iter_mut().zip(range.iter().zip(rises)) {
        let (_, z) = masked(z);
        *to = light * phi(p, q, rise) * one_minus_exp_negative((attenuation - decay * rise) * z);
    }
}

#[inline(always)]
fn open_water(of: Single, range: &[f32], rises: &[f32], to: &mut [f32]) {
    const INDEX: f32 = REFRACTIVE_INDEX as f32;
    const CRITICAL: f32 = CRITICAL_COSINE as f32;
    const INSIDE: f32 = (CRITICAL_COSINE + EDGE_INSIDE) as f32;
    let Single {
        p,
        q,
        attenuation,
        decay,
        light,
        depth,
        edge,
        lost: [window, decayed],
        sky,
    } = of;
    for (to, (&z, &rise)) in to.iter_mut().zip(range.iter().zip(rises)) {
        let source = light * phi(p, q, rise);
        let steep = if rise > 1e-6 { rise } else { 1e-6 };
        let water = source * one_minus_exp_negative((attenuation - decay * rise) * (depth / steep));
        let s = (rise - CRITICAL) * edge + 0.5;
        let s = if s > 0.0 { s } else { 0.0 };
        let s = if s < 1.0 { s } else { 1.0 };
        let cosine = if rise > INSIDE { rise } else { INSIDE };
        let k = 1.0 - INDEX * INDEX * (1.0 - cosine * cosine);
        let k = (if k > 0.0 { k } else { 0.0 }).sqrt();
        let across = (INDEX * cosine - k) / (INDEX * cosine + k);
        let along = (cosine - INDEX * k) / (cosine + INDEX * k);
        let through = 1.0 - 0.5 * (across * across + along * along);
        let cosine = if rise > LEAST_COSINE as f32 {
            rise
        } else {
            LEAST_COSINE as f32
        };
        let faded = window / cosine - decayed;
        let faded = if faded > -MOST_GAIN as f32 {
            faded
        } else {
            -MOST_GAIN as f32
        };
        let through = sky * through * exp_negative(faded) * (s * s * (3.0 - 2.0 * s));
        let above = if water > through { water } else { through };
        let shown = if rise > 0.0 { above } else { source };
        *to = if masked(z).0 { *to } else { shown };
    }
}

#[cfg(test)]
mod tests;
