//! The veil of one channel by direction, in f64 and in f32.

mod bounds;

use imaging::{Plane, vectorized};

use super::aureole::{AUREOLE_TERMS, CORE, MIDDLE, REACH, STRETCH};
use super::field::{
    BLURRED_EDGE, EDGE_INSIDE, Field, LEAST_COSINE, MIRROR_TERMS, MOST_GAIN, RATE_TERMS, SHARP_EDGE,
    SOURCE_TERMS, SunnyRay,
};
use super::gaze::Gaze;
use super::model::{CRITICAL_COSINE, REFRACTIVE_INDEX};
use super::rises::{Row, rises_of, versines_of};
use super::sun::SunLight;
use super::wide::{PEAK_COSINE, TERMS};
use crate::attenuation::{exp_negative, masked};
use crate::polynomial::horner;
use crate::range::is_hole;

/// Pixels that are checked together for holes.
const RUN: usize = 64;
/// Rays that meet no surface are this many attenuation lengths long.
const FARTHEST: f64 = 60.0;
/// No camera counts as shallower than this, in lengths of the range: where a ray ends would hang on the last digit of its direction.
pub(super) const SHALLOWEST: f64 = 0.02;

/// The veil of one channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VeilOf {
    pub(crate) field: Field,
    /// Factor of the field: π times the light of a white horizontal patch at the camera.
    pub(crate) light: f64,
    /// h, depth of the camera in lengths of the range, at least [`SHALLOWEST`].
    pub(crate) depth: f64,
    /// How far the bottom is below the camera, in lengths of the range; infinite without one.
    pub(crate) below: f64,
    pub(crate) sun: Option<SunnyWater>,
}

/// What singly scattered sunlight depends on besides the field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SunnyWater {
    /// Unit vector toward the sun, camera axes.
    pub(crate) toward: [f64; 3],
    /// Its cosine from the vertical.
    pub(crate) rise: f64,
    /// Least 1 − cos of the angle from a ray of the picture to it.
    pub(crate) nearest: f64,
}

impl SunnyWater {
    pub(crate) fn seen_by(gaze: &Gaze, sun: &SunLight) -> Self {
        let toward = sun.toward(gaze);
        Self {
            toward,
            rise: sun.rise,
            nearest: gaze.least_versine(toward),
        }
    }
}

impl VeilOf {
    /// B along a unit vector in camera axes, with its cosine from the vertical, before a surface at this range or in open water; 0 where
    /// the water attenuates nothing.
    #[must_use]
    pub fn at(&self, ray: [f64; 3], rise: f64, range: Option<f64>) -> f64 {
        if self.field.attenuation <= 0.0 {
            return 0.0;
        }
        let length = range.unwrap_or(f64::INFINITY).min(self.end(rise));
        let sunlit = self.sun.map_or(0.0, |sun| {
            let apart: f64 = (0..3).map(|axis| (ray[axis] - sun.toward[axis]).powi(2)).sum();
            let ray = SunnyRay {
                rise,
                length,
                versine: 0.5 * apart,
                sun_rise: sun.rise,
            };
            self.field.sunlit(ray) + self.field.aureole(ray)
        });
        let surface = if range.is_none() {
            self.field.surface(rise, self.depth)
        } else {
            0.0
        };
        self.light * (self.field.scattered(rise, length) + sunlit + surface)
    }

    /// Length of a ray that meets nothing but the surface or the bottom of the sea.
    fn end(&self, rise: f64) -> f64 {
        let farthest = FARTHEST / self.field.attenuation;
        if rise > 0.0 {
            farthest.min(self.depth / rise)
        } else {
            farthest.min(self.below / rise.abs().max(1e-6))
        }
    }
}

/// The veil of a channel in f64, pixel by pixel. Holes show open water.
#[must_use]
pub fn veil_reference(range: &Plane<f64>, of: &VeilOf, gaze: &Gaze) -> Plane<f64> {
    Plane::from_fn(range.width(), range.height(), |x, y| {
        let z = range.pixel(x, y);
        let ray = gaze.camera.ray(x as f64, y as f64).normalized();
        of.at(ray.into(), gaze.rise(x, y), (!is_hole(z)).then_some(z))
    })
}

/// [`veil_reference`] in f32 into `to`, which has a sample for each pixel.
///
/// # Panics
/// If it has not.
pub fn veil(range: &Plane<f32>, of: &VeilOf, gaze: &Gaze, to: &mut [f32]) {
    assert_eq!(range.data().len(), to.len(), "a sample for each pixel");
    if of.field.attenuation <= 0.0 {
        to.fill(0.0);
        return;
    }
    let width = range.width();
    if width == 0 {
        return;
    }
    let single = Single::new(of);
    let [mut rises, mut versines] = [(); 2].map(|()| vec![0.0f32; width]);
    for (y, to) in to.chunks_exact_mut(width).enumerate() {
        vectorized!(rises_of(Row::new(gaze, y), &mut rises));
        let range = range.row(y);
        vectorized!(scattered(&single, range, &rises, to));
        if let Some(sun) = &of.sun {
            vectorized!(versines_of(Row::toward(gaze, y, sun.toward), &mut versines));
            let sunny = SunnySingle::new(of, sun);
            let rays = Rays {
                rises: &rises,
                versines: &versines,
            };
            vectorized!(sunlit(&single, &sunny, range, rays, to));
            for start in (0..width).step_by(RUN) {
                let run = start..(start + RUN).min(width);
                let rays = Rays {
                    rises: &rises[run.clone()],
                    versines: &versines[run.clone()],
                };
                if rays.versines.iter().any(|&versine| versine <= REACH as f32) {
                    vectorized!(aureole(
                        &single,
                        &sunny,
                        &range[run.clone()],
                        rays,
                        &mut to[run.clone()]
                    ));
                }
            }
        }
        for start in (0..width).step_by(RUN) {
            let run = start..(start + RUN).min(width);
            let is_open = range[run.clone()].iter().any(|&z| !masked(z).0);
            if is_open {
                vectorized!(surface(
                    &single,
                    &range[run.clone()],
                    &rises[run.clone()],
                    &mut to[run.clone()]
                ));
            }
        }
        vectorized!(scale(single.light, to));
    }
}

/// [`VeilOf`] in f32.
#[derive(Clone, Copy)]
struct Single {
    source: [f32; SOURCE_TERMS],
    rate: [f32; RATE_TERMS],
    mirrored: [f32; MIRROR_TERMS],
    attenuation: f32,
    farthest: f32,
    below: f32,
    light: f32,
    depth: f32,
    peak: f32,
    sky: f32,
}

impl Single {
    fn new(of: &VeilOf) -> Self {
        let VeilOf { field, depth, .. } = of;
        Self {
            source: field.source.single(),
            rate: field.rate.single(),
            mirrored: field.mirrored.single(),
            attenuation: field.attenuation as f32,
            farthest: (FARTHEST / field.attenuation) as f32,
            below: of.below as f32,
            light: of.light as f32,
            depth: *depth as f32,
            peak: field.peak as f32,
            sky: field.sky as f32,
        }
    }

    /// Length of a ray that meets nothing but the surface or the bottom of the sea.
    #[inline(always)]
    fn end(&self, rise: f32) -> f32 {
        let steep = rise.abs();
        let steep = if steep > 1e-6 { steep } else { 1e-6 };
        let height = if rise > 0.0 { self.depth } else { self.below };
        let end = height / steep;
        if end < self.farthest { end } else { self.farthest }
    }

    /// Length of the ray of a pixel.
    #[inline(always)]
    fn length(&self, z: f32, rise: f32) -> f32 {
        let (valid, z) = masked(z);
        let end = self.end(rise);
        if valid && z < end { z } else { end }
    }
}

/// Singly scattered sunlight in f32.
#[derive(Clone, Copy)]
struct SunnySingle {
    light: f32,
    phase: [f32; TERMS],
    /// c and c/μ_s.
    attenuation: f32,
    growth: f32,
    /// ln(p_a + p(25°)), and p(25°).
    aureole: [f32; AUREOLE_TERMS],
    edge: f32,
    /// c + (1 − w) b.
    all_scattering: f32,
}

impl SunnySingle {
    fn new(of: &VeilOf, sun: &SunnyWater) -> Self {
        Self {
            light: of.field.sunlight as f32,
            phase: of.field.sunny.single(),
            attenuation: of.field.attenuation as f32,
            growth: (of.field.attenuation / sun.rise) as f32,
            aureole: of.field.aureole.logarithm.single(),
            edge: of.field.aureole.edge as f32,
            all_scattering: (of.field.attenuation + of.field.peak) as f32,
        }
    }
}

/// Rays of a row: their cosines from the vertical, and 1 − cos of their angles to the sun.
#[derive(Clone, Copy)]
struct Rays<'a> {
    rises: &'a [f32],
    versines: &'a [f32],
}

/// `(1 − e^{−k z})/k` for exponents from [`MOST_GAIN`] on.
#[inline(always)]
fn effective_length(rate: f32, z: f32) -> f32 {
    const LEAST: f32 = -MOST_GAIN as f32;
    let x = rate * z;
    let x = if x > LEAST { x } else { LEAST };
    let small = z
        * (1.0
            - x * (0.5
                - x * (1.666_666_7e-1 - x * (4.166_666_8e-2 - x * (8.333_334e-3 - x * 1.388_889e-3)))));
    let large = z * (1.0 - exp_negative(x)) / x;
    if x < 0.25 && x > -0.25 { small } else { large }
}

#[inline(always)]
fn scattered(of: &Single, range: &[f32], rises: &[f32], to: &mut [f32]) {
    for (to, (&z, &rise)) in to.iter_mut().zip(range.iter().zip(rises)) {
        let rate = horner(of.rate, rise);
        *to = exp_negative(-horner(of.source, rise)) * effective_length(rate, of.length(z, rise));
    }
}

#[inline(always)]
fn sunlit(of: &Single, sunny: &SunnySingle, range: &[f32], rays: Rays<'_>, to: &mut [f32]) {
    const PEAK: f32 = PEAK_COSINE as f32;
    let rays = rays.rises.iter().zip(rays.versines);
    for (to, (&z, (&rise, &versine))) in to.iter_mut().zip(range.iter().zip(rays)) {
        let cosine = 1.0 - versine;
        let cosine = if cosine < PEAK { cosine } else { PEAK };
        let density = exp_negative(-horner(sunny.phase, cosine));
        let rate = sunny.attenuation - sunny.growth * rise;
        *to += sunny.light * density * effective_length(rate, of.length(z, rise));
    }
}

/// Adds the aureole of the sun.
#[inline(always)]
fn aureole(of: &Single, sunny: &SunnySingle, range: &[f32], rays: Rays<'_>, to: &mut [f32]) {
    let rays = rays.rises.iter().zip(rays.versines);
    for (to, (&z, (&rise, &versine))) in to.iter_mut().zip(range.iter().zip(rays)) {
        let is_near = versine <= REACH as f32;
        let versine = if is_near { versine } else { REACH as f32 };
        let place = ((versine + CORE as f32).sqrt().sqrt() - MIDDLE as f32) * STRETCH as f32;
        let density = exp_negative(-horner(sunny.aureole, place)) - sunny.edge;
        let density = if is_near && density > 0.0 { density } else { 0.0 };
        let rate = sunny.all_scattering - sunny.growth * rise;
        *to += sunny.light * density * effective_length(rate, of.length(z, rise));
    }
}

#[inline(always)]
fn scale(light: f32, to: &mut [f32]) {
    for to in to {
        *to *= light;
    }
}

#[inline(always)]
fn ramp(rise: f32, inverse_width: f32) -> f32 {
    let s = (rise - CRITICAL_COSINE as f32) * inverse_width + 0.5;
    let s = if s > 0.0 { s } else { 0.0 };
    let s = if s < 1.0 { s } else { 1.0 };
    s * s * (3.0 - 2.0 * s)
}

/// Adds the light of the sea's surface to rays that reach it.
#[inline(always)]
fn surface(of: &Single, range: &[f32], rises: &[f32], to: &mut [f32]) {
    const INDEX: f32 = REFRACTIVE_INDEX as f32;
    const INSIDE: f32 = (CRITICAL_COSINE + EDGE_INSIDE) as f32;
    const LEAST: f32 = LEAST_COSINE as f32;
    for (to, (&z, &rise)) in to.iter_mut().zip(range.iter().zip(rises)) {
        let steep = if rise > LEAST { rise } else { LEAST };
        let sharp = exp_negative(of.peak * of.depth / steep);
        let inside = sharp * ramp(rise, 1.0 / SHARP_EDGE as f32)
            + (1.0 - sharp) * ramp(rise, 1.0 / BLURRED_EDGE as f32);
        let cosine = if rise > INSIDE { rise } else { INSIDE };
        let k = 1.0 - INDEX * INDEX * (1.0 - cosine * cosine);
        let k = (if k > 0.0 { k } else { 0.0 }).sqrt();
        let across = (INDEX * cosine - k) / (INDEX * cosine + k);
        let along = (cosine - INDEX * k) / (cosine + INDEX * k);
        let through = (1.0 - 0.5 * (across * across + along * along)) * inside;
        let arrives = exp_negative(of.attenuation * of.depth / steep);
        let mirrored = exp_negative(-horner(of.mirrored, rise));
        let light = (through * of.sky + (1.0 - through) * mirrored) * arrives;
        *to += if rise > 0.0 && !masked(z).0 { light } else { 0.0 };
    }
}

#[cfg(test)]
mod tests;
