//! Daylight on surfaces, in f64 and in f32.
//!
//! A surface of the reflectance ρ at X with the normal n, its depth z below the sea's surface, sends back
//!
//! ```text
//! J = ρ e(X) [ σ V C max(n·s, 0)/μ_s + (1 − σ) A D(n·U) ]
//! e(X) = E(z)/N,   σ = clamp(share e^{−c z/μ_s + K z}, 0, 1)
//! ```
//!
//! with s the direction to the sun and μ_s its cosine from the vertical, V the visibility of the sun, C its caustics, A the ambient
//! occlusion, and D the share of the ambient light that reaches a slope ([`super::share_by_slope`]). N is the irradiance of white:
//! J is in units of the radiance of a white horizontal patch.

use imaging::{Plane, Rgb, vectorized};

use super::SunLight;
use super::conditions::Daylight;
use super::field::MOST_GAIN;
use super::rises::{Row, rises_of};
use super::slope::{SLOPES, between};
use crate::attenuation::{exp_negative, masked};
use crate::range::is_hole;

/// Share of daylight that reaches the surface of each pixel; 1 for missing planes.
#[derive(Debug, Clone, Copy, Default)]
pub struct Reaching<'a> {
    /// V C, of the sun.
    pub sunlight: Option<&'a Plane<f32>>,
    /// A, of the light from all around.
    pub access: Option<&'a Rgb<f32>>,
}

impl Daylight {
    /// h − z: height of a point above the camera's depth, at most up to the surface of the sea.
    pub(crate) fn height(&self, rise: f64, range: f64) -> f64 {
        (rise * range).min(self.depth)
    }

    /// e at a height above the camera, in a channel.
    pub(crate) fn irradiance(&self, channel: usize, height: f64) -> f64 {
        self.level[channel] * (self.fields[channel].decay * height).min(MOST_GAIN).exp()
    }
}

/// J of every pixel from ρ, range and unit normals in camera axes; 0 without a range.
#[must_use]
pub fn surfaces_reference(
    reflectance: &Rgb<f64>,
    range: &Plane<f64>,
    normals: &[Plane<f64>; 3],
    daylight: &Daylight,
    reaching: Reaching<'_>,
) -> Rgb<f64> {
    let gaze = &daylight.gaze;
    let toward = daylight.sun.map(|sun| (sun, sun.toward(gaze)));
    let bands = [0, 1, 2].map(|c| {
        let field = &daylight.fields[c];
        let albedo = &reflectance.planes()[c];
        Plane::from_fn(range.width(), range.height(), |x, y| {
            let (rho, z) = (albedo.pixel(x, y), range.pixel(x, y));
            if is_hole(z) {
                return 0.0;
            }
            let height = daylight.height(gaze.rise(x, y), z);
            let arriving = rho * daylight.irradiance(c, height);
            let n = [0, 1, 2].map(|i| normals[i].pixel(x, y));
            let dot = |v: [f64; 3]| n[0] * v[0] + n[1] * v[1] + n[2] * v[2];
            let around = reaching
                .access
                .map_or(1.0, |a| f64::from(a.planes()[c].pixel(x, y)));
            let around = around * between(&field.slopes, dot(gaze.up));
            let Some((sun, toward)) = toward else {
                return arriving * around;
            };
            let share = sun.share_at(field, daylight.depth - height);
            let seen = reaching.sunlight.map_or(1.0, |v| f64::from(v.pixel(x, y)));
            arriving * (share * seen * dot(toward).max(0.0) / sun.rise + (1.0 - share) * around)
        })
    });
    Rgb::new(bands).expect("planes of one frame")
}

/// [`surfaces_reference`] in f32.
///
/// # Panics
/// When the planes are of different sizes.
#[must_use]
pub fn surfaces(
    reflectance: &Rgb<f32>,
    range: &Plane<f32>,
    normals: &[Plane<f32>; 3],
    daylight: &Daylight,
    reaching: Reaching<'_>,
) -> Rgb<f32> {
    let (width, height) = range.size();
    assert_eq!(reflectance.size(), (width, height), "one range for each pixel");
    let channels = [0, 1, 2].map(|c| Channel::new(daylight, c));
    let sight = Sight::new(daylight);
    let mut bands = [(); 3].map(|()| Plane::filled(width, height, 0.0f32));
    let mut rises = vec![0.0f32; width];
    let mut places = Places::new(width);
    for y in 0..height {
        let row = Row::new(&daylight.gaze, y);
        vectorized!(rises_of(row, &mut rises));
        let range = range.row(y);
        let normals = normals.each_ref().map(|plane| plane.row(y));
        vectorized!(place_row(sight, range, &rises, normals, &mut places));
        if let Some(lit) = reaching.sunlight {
            vectorized!(dim(lit.row(y), &mut places.direct));
        }
        for (c, band) in bands.iter_mut().enumerate() {
            let (channel, band) = (&channels[c], band.row_mut(y));
            let albedo = reflectance.planes()[c].row(y);
            look_up(&channel.table, &places, band);
            if let Some(access) = reaching.access {
                vectorized!(dim(access.planes()[c].row(y), band));
            }
            if daylight.sun.is_some() {
                vectorized!(sunny(channel, &places, albedo, band));
            } else {
                vectorized!(overcast(channel, &places, albedo, band));
            }
        }
    }
    Rgb::new(bands).expect("planes of one frame")
}

/// Adds the light of lamps: `J + ρ E/π`.
///
/// # Panics
/// When the planes are of different sizes.
#[must_use]
pub fn with_lamps(mut lit: Rgb<f32>, reflectance: &Rgb<f32>, irradiance: &Rgb<f32>) -> Rgb<f32> {
    assert_eq!(lit.size(), reflectance.size(), "one reflectance for each pixel");
    let others = reflectance.planes().iter().zip(irradiance.planes());
    for (lit, (rho, e)) in lit.planes_mut().into_iter().zip(others) {
        let (rho, e) = (rho.data(), e.data());
        vectorized!(add_reflected(lit, rho, e));
    }
    lit
}

#[inline(always)]
fn add_reflected(lit: &mut [f32], rho: &[f32], e: &[f32]) {
    for ((lit, rho), e) in lit.iter_mut().zip(rho).zip(e) {
        *lit += rho * e * std::f32::consts::FRAC_1_PI;
    }
}

/// One channel in f32.
struct Channel {
    level: f32,
    decay: f32,
    depth: f32,
    share: f32,
    fading: f32,
    /// Where each piece of the table by slope begins, and how it rises in 1/16 of the cosine.
    table: [[f32; 2]; PIECES],
}

const PIECES: usize = SLOPES - 1;

impl Channel {
    fn new(daylight: &Daylight, c: usize) -> Self {
        let field = &daylight.fields[c];
        let table = &field.slopes;
        let sun = daylight.sun.as_ref();
        Self {
            level: daylight.level[c] as f32,
            decay: field.decay as f32,
            depth: daylight.depth as f32,
            share: sun.map_or(0.0, |sun| sun.share) as f32,
            fading: sun.map_or(0.0, |sun: &SunLight| sun.fading(field)) as f32,
            table: std::array::from_fn(|k| [table[k] as f32, (table[k + 1] - table[k]) as f32]),
        }
    }
}

/// The vertical and the direction to the sun in f32.
#[derive(Clone, Copy)]
struct Sight {
    up: [f32; 3],
    /// Over its cosine from the vertical; zero without a sun.
    toward: [f32; 3],
    depth: f32,
}

impl Sight {
    fn new(daylight: &Daylight) -> Self {
        let toward = daylight.sun.map_or([0.0; 3], |sun| {
            sun.toward(&daylight.gaze).map(|v| (v / sun.rise) as f32)
        });
        Self {
            up: daylight.gaze.up.map(|v| v as f32),
            toward,
            depth: daylight.depth as f32,
        }
    }
}

/// Data shared by all channels of a row.
struct Places {
    /// How far above the camera.
    above: Vec<f32>,
    /// The piece of the table by slope, and the share of it.
    piece: Vec<u32>,
    part: Vec<f32>,
    /// max(n·s, 0)/μ of the sun, and its visible share.
    direct: Vec<f32>,
    /// 1, or 0 at holes.
    counts: Vec<f32>,
}

impl Places {
    fn new(width: usize) -> Self {
        let blank = || vec![0.0f32; width];
        Self {
            above: blank(),
            piece: vec![0; width],
            part: blank(),
            direct: blank(),
            counts: blank(),
        }
    }
}

#[inline(always)]
fn place_row(sight: Sight, range: &[f32], rises: &[f32], n: [&[f32]; 3], to: &mut Places) {
    /// Adding it rounds a float of this size to an integer, which ends up in its low bits.
    const ROUND: f32 = 12_582_912.0;
    let Sight { up, toward, depth } = sight;
    let len = range.len();
    let [nx, ny, nz] = n.map(|axis| &axis[..len]);
    let rises = &rises[..len];
    let (above, piece, part) = (&mut to.above[..len], &mut to.piece[..len], &mut to.part[..len]);
    let (direct, counts) = (&mut to.direct[..len], &mut to.counts[..len]);
    for i in 0..len {
        let (valid, z) = masked(range[i]);
        above[i] = height(z, rises[i], depth);
        counts[i] = if valid { 1.0 } else { 0.0 };
        let facing = nx[i] * up[0] + ny[i] * up[1] + nz[i] * up[2];
        let sun = nx[i] * toward[0] + ny[i] * toward[1] + nz[i] * toward[2];
        direct[i] = if sun > 0.0 { sun } else { 0.0 };
        let place = (facing + 1.0) * 16.0;
        let place = if place > 0.0 { place } else { 0.0 };
        let place = if place < 32.0 { place } else { 32.0 };
        // Both pieces agree at their common slope.
        let middle = place - 0.5;
        let middle = if middle > 0.0 { middle } else { 0.0 };
        let middle = if middle < 31.0 { middle } else { 31.0 };
        let rounded = middle + ROUND;
        piece[i] = rounded.to_bits();
        part[i] = place - (rounded - ROUND);
    }
}

/// D of a row. In a separate loop, since the table is read pixel by pixel.
fn look_up(table: &[[f32; 2]; PIECES], places: &Places, to: &mut [f32]) {
    for ((to, &piece), &part) in to.iter_mut().zip(&places.piece).zip(&places.part) {
        let [begin, rise] = table[piece as usize % PIECES];
        *to = begin + rise * part;
    }
}

#[inline(always)]
fn dim(share: &[f32], to: &mut [f32]) {
    for (to, share) in to.iter_mut().zip(share) {
        *to *= share;
    }
}

/// How far above the camera.
#[inline(always)]
fn height(z: f32, rise: f32, depth: f32) -> f32 {
    let height = z * rise;
    if height < depth { height } else { depth }
}

/// `e^x` for x up to [`MOST_GAIN`].
#[inline(always)]
fn grown(x: f32) -> f32 {
    const MOST: f32 = MOST_GAIN as f32;
    exp_negative(-(if x < MOST { x } else { MOST }))
}

/// Expects A D in `to`.
#[inline(always)]
fn overcast(channel: &Channel, places: &Places, albedo: &[f32], to: &mut [f32]) {
    let Channel { level, decay, .. } = *channel;
    let len = to.len();
    let (above, counts, albedo) = (&places.above[..len], &places.counts[..len], &albedo[..len]);
    for i in 0..len {
        to[i] *= counts[i] * albedo[i] * level * grown(decay * above[i]);
    }
}

/// Expects A D in `to`.
#[inline(always)]
fn sunny(channel: &Channel, places: &Places, albedo: &[f32], to: &mut [f32]) {
    let Channel {
        level,
        decay,
        depth,
        share,
        fading,
        ..
    } = *channel;
    let len = to.len();
    let (above, counts, albedo) = (&places.above[..len], &places.counts[..len], &albedo[..len]);
    let direct = &places.direct[..len];
    for i in 0..len {
        let arriving = counts[i] * albedo[i] * level * grown(decay * above[i]);
        let part = share * grown(-fading * (depth - above[i]));
        let part = if part < 1.0 { part } else { 1.0 };
        to[i] = arriving * (part * direct[i] + (1.0 - part) * to[i]);
    }
}

#[cfg(test)]
pub(super) mod tests;
