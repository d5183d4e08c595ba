//! The light of lamps on surfaces.

use imaging::simd::vectorised;
use imaging::{Plane, Rgb};

use super::{Beam, Lamp, Lighting};
use crate::attenuation::{exp_negative, masked};

/// Rounding of f32 in the light on surfaces, as a share of the frame's peak: a range of 30 m is known to 2 µm, and light falls with
/// its square.
pub const SURFACE_ROUNDING: f64 = 2e-5;
/// A Lambertian surface sends back J/π of what falls on it.
const PER_STERADIAN: f32 = std::f32::consts::FRAC_1_PI;

/// [`irradiance_reference`](super::irradiance_reference) in f32.
#[must_use]
pub fn irradiance(range: &Plane<f32>, normals: &[Plane<f32>; 3], lighting: &Lighting) -> Rgb<f32> {
    let (width, height) = range.size();
    let mut light = Rgb::from_fn(width, height, |_, _| [0.0f32; 3]);
    let camera = &lighting.camera;
    let lens = [1.0 / camera.focal_px, camera.cx, camera.cy].map(|v| v as f32);
    let attenuation = lighting.attenuation.map(|c| c as f32);
    let radius = lighting.radius_m as f32;
    let lamps: Vec<Source> = lighting.lamps.iter().map(Source::new).collect();
    let [red, green, blue] = light.planes_mut();
    for y in 0..height {
        let row = y * width..(y + 1) * width;
        let normal = normals.each_ref().map(|plane| plane.row(y));
        let planes = [
            &mut red[row.clone()],
            &mut green[row.clone()],
            &mut blue[row.clone()],
        ];
        let [red, green, blue] = planes;
        for lamp in &lamps {
            let scene = Row {
                lens,
                y: y as f32,
                attenuation,
                radius,
            };
            vectorised(
                #[inline(always)]
                || shine(scene, *lamp, range.row(y), normal, red, green, blue),
            );
        }
    }
    light
}

/// The scene by the light that it has, `gain` times J for each channel, and by that of the lamps: `J (gain + E/π)`.
#[must_use]
pub fn lit(radiance: &Rgb<f32>, gain: [f64; 3], irradiance: &Rgb<f32>) -> Rgb<f32> {
    let band = |c: usize| {
        let gain = gain[c] as f32;
        let samples = radiance.planes()[c]
            .data()
            .iter()
            .zip(irradiance.planes()[c].data());
        let data = samples.map(|(j, e)| j * (gain + e * PER_STERADIAN)).collect();
        Plane::new(radiance.width(), radiance.height(), data).expect("the size of the frame")
    };
    Rgb::new([band(0), band(1), band(2)]).expect("planes of one frame")
}

/// What the pixels of a row share.
#[derive(Clone, Copy)]
struct Row {
    lens: [f32; 3],
    y: f32,
    attenuation: [f32; 3],
    radius: f32,
}

/// A lamp in f32. A point lamp is a spot without axis whose profile is 1 everywhere.
#[derive(Clone, Copy)]
struct Source {
    place: [f32; 3],
    axis: [f32; 3],
    /// The profile is `offset + slope cos`, clamped to 0..=1.
    offset: f32,
    slope: f32,
    intensity: [f32; 3],
}

impl Source {
    fn new(lamp: &Lamp) -> Self {
        let single = |values: [f64; 3]| values.map(|v| v as f32);
        let (axis, offset, slope) = match lamp.beam {
            Beam::Point => ([0.0; 3], 1.0, 0.0),
            Beam::Spot { axis, cos_cone } => {
                let slope = 1.0 / (1.0 - cos_cone);
                (axis, -cos_cone * slope, slope)
            }
        };
        Self {
            place: single(lamp.position_m),
            axis: single(axis),
            offset: offset as f32,
            slope: slope as f32,
            intensity: single(lamp.intensity),
        }
    }
}

#[inline(always)]
fn shine(
    Row {
        lens: [inverse_focal, cx, cy],
        y,
        attenuation: [cr, cg, cb],
        radius,
    }: Row,
    Source {
        place: [px, py, pz],
        axis: [ax, ay, az],
        offset,
        slope,
        intensity: [ir, ig, ib],
    }: Source,
    range: &[f32],
    [nx, ny, nz]: [&[f32]; 3],
    red: &mut [f32],
    green: &mut [f32],
    blue: &mut [f32],
) {
    let width = range.len();
    let (nx, ny, nz) = (&nx[..width], &ny[..width], &nz[..width]);
    let (red, green, blue) = (&mut red[..width], &mut green[..width], &mut blue[..width]);
    let v = (y - cy) * inverse_focal;
    for i in 0..width {
        let u = (i as f32 - cx) * inverse_focal;
        let (valid, z) = masked(range[i]);
        // So far away that nothing arrives, and its square is still finite.
        let planar = z.min(1e6) / (u * u + v * v + 1.0).sqrt();
        let (lx, ly, lz) = (px - u * planar, py - v * planar, pz - planar);
        let distance = (lx * lx + ly * ly + lz * lz).sqrt().max(radius);
        let inverse = 1.0 / distance;
        let facing = ((nx[i] * lx + ny[i] * ly + nz[i] * lz) * inverse).max(0.0);
        let cos = -(ax * lx + ay * ly + az * lz) * inverse;
        let profile = (offset + slope * cos).max(0.0).min(1.0);
        let fall = facing * profile * inverse * inverse;
        let fall = if valid { fall } else { 0.0 };
        red[i] += ir * fall * exp_negative(cr * distance);
        green[i] += ig * fall * exp_negative(cg * distance);
        blue[i] += ib * fall * exp_negative(cb * distance);
    }
}
