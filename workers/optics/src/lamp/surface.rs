//! The light of lamps on surfaces.

use imaging::simd::vectorised;
use imaging::{Plane, Rgb};

use super::elementary::{HALVINGS, fade};
use super::{Beam, Lamp, Lighting};
use crate::attenuation::masked;
use crate::range::SHORTEST_M;
use crate::turbidity::{self, RUN};

/// Rounding of f32 in the light on surfaces, as a share of the frame's peak: a range of 30 m is known to 2 µm, and light falls with
/// its square.
pub const SURFACE_ROUNDING: f64 = 2e-5;
/// A Lambertian surface sends back J/π of what falls on it.
const PER_STERADIAN: f32 = std::f32::consts::FRAC_1_PI;

/// [`irradiance_reference`](super::irradiance_reference) in f32.
#[must_use]
pub fn irradiance(range: &Plane<f32>, normals: &[Plane<f32>; 3], lighting: &Lighting) -> Rgb<f32> {
    let (width, height) = range.size();
    let [mut red, mut green, mut blue] = [(); 3].map(|()| Plane::filled(width, height, 0.0f32));
    let camera = &lighting.camera;
    let lens = [1.0 / camera.focal_px, camera.cx, camera.cy].map(|v| v as f32);
    let attenuation = lighting.attenuation.map(|c| c as f32 * HALVINGS);
    let radius = lighting.radius_m as f32;
    let lamps: Vec<Source> = lighting.lamps.iter().map(Source::new).collect();
    let patches = (lighting.patches.as_ref()).map(|field| turbidity::Rays::new(field, camera));
    let mut places = [(); 4].map(|()| vec![0.0f32; width]);
    let mut murk = vec![1.0f32; width];
    for y in 0..height {
        vectorised(
            #[inline(always)]
            || places_of(lens, y as f32, range.row(y), &mut places),
        );
        let row = Row {
            places: places.each_ref().map(Vec::as_slice),
            normals: normals.each_ref().map(|plane| plane.row(y)),
            attenuation,
            radius,
        };
        for lamp in &lamps {
            if let Some(patches) = &patches {
                vectorised(
                    #[inline(always)]
                    || murk_of(patches, y, range.row(y), (row, lamp.place), &mut murk),
                );
            }
            let (red, green, blue) = (red.row_mut(y), green.row_mut(y), blue.row_mut(y));
            vectorised(
                #[inline(always)]
                || shine(row, *lamp, &murk, red, green, blue),
            );
        }
    }
    Rgb::new([red, green, blue]).expect("planes of one frame")
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

/// What the lamps meet in a row.
#[derive(Clone, Copy)]
struct Row<'a> {
    /// Where the surfaces are in camera axes, and 1, or 0 at a hole.
    places: [&'a [f32]; 4],
    normals: [&'a [f32]; 3],
    /// Halvings per metre.
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
fn places_of([inverse_focal, cx, cy]: [f32; 3], y: f32, range: &[f32], to: &mut [Vec<f32>; 4]) {
    let width = range.len();
    let [px, py, pz, shown] = to.each_mut().map(|lane| &mut lane[..width]);
    let v = (y - cy) * inverse_focal;
    for i in 0..width {
        let u = (i as f32 - cx) * inverse_focal;
        let (valid, z) = masked(range[i]);
        // So far away that nothing arrives, and its square is still finite.
        let planar = z.min(1e6) / u.mul_add(u, v.mul_add(v, 1.0)).sqrt();
        (px[i], py[i], pz[i]) = (u * planar, v * planar, planar);
        shown[i] = if valid { 1.0 } else { 0.0 };
    }
}

/// The factor of c on the way from a lamp: the mean of the field over as much of the ray before the surface.
#[inline(always)]
fn murk_of(
    patches: &turbidity::Rays,
    y: usize,
    range: &[f32],
    (row, [px, py, pz]): (Row<'_>, [f32; 3]),
    murk: &mut [f32],
) {
    let [places_x, places_y, places_z, _] = row.places;
    for start in (0..range.len()).step_by(RUN) {
        let run = RUN.min(range.len() - start);
        let at = start..start + run;
        let [mut x, mut y_m, mut z_m, mut end] = [[0.0f32; RUN]; 4];
        x[..run].copy_from_slice(&places_x[at.clone()]);
        y_m[..run].copy_from_slice(&places_y[at.clone()]);
        z_m[..run].copy_from_slice(&places_z[at.clone()]);
        end[..run].copy_from_slice(&range[at.clone()]);
        let mut begin = [0.0f32; RUN];
        for i in 0..RUN {
            let (lx, ly, lz) = (px - x[i], py - y_m[i], pz - z_m[i]);
            let leg = (lx * lx + ly * ly + lz * lz).sqrt().max(row.radius);
            end[i] = masked(end[i]).1.max(SHORTEST_M as f32);
            begin[i] = (end[i] - leg).max(0.0);
        }
        let (all, before) = (
            patches.excess((start, y), &end),
            patches.excess((start, y), &begin),
        );
        let mut factor = [0.0f32; RUN];
        for i in 0..RUN {
            let excess = (end[i] * all[i] - begin[i] * before[i]) / (end[i] - begin[i]);
            factor[i] = (1.0 + excess).max(0.0);
        }
        murk[at].copy_from_slice(&factor[..run]);
    }
}

#[inline(always)]
fn shine(
    Row {
        places: [x, y, z, shown],
        normals: [nx, ny, nz],
        attenuation: [cr, cg, cb],
        radius,
    }: Row<'_>,
    Source {
        place: [px, py, pz],
        axis: [ax, ay, az],
        offset,
        slope,
        intensity: [ir, ig, ib],
    }: Source,
    murk: &[f32],
    red: &mut [f32],
    green: &mut [f32],
    blue: &mut [f32],
) {
    let width = red.len();
    let (x, y, z, shown) = (&x[..width], &y[..width], &z[..width], &shown[..width]);
    let (nx, ny, nz) = (&nx[..width], &ny[..width], &nz[..width]);
    let murk = &murk[..width];
    let (green, blue) = (&mut green[..width], &mut blue[..width]);
    for i in 0..width {
        let (lx, ly, lz) = (px - x[i], py - y[i], pz - z[i]);
        let square = lx.mul_add(lx, ly.mul_add(ly, lz * lz));
        let distance = square.sqrt().max(radius);
        let inverse = 1.0 / distance;
        let facing = nx[i].mul_add(lx, ny[i].mul_add(ly, nz[i] * lz)).max(0.0);
        let cos = -ax.mul_add(lx, ay.mul_add(ly, az * lz)) * inverse;
        let profile = slope.mul_add(cos, offset).max(0.0).min(1.0);
        let fall = facing * shown[i] * profile * (inverse * inverse * inverse);
        let metres = murk[i] * distance;
        red[i] = (ir * fall).mul_add(fade(cr, metres), red[i]);
        green[i] = (ig * fall).mul_add(fade(cg, metres), green[i]);
        blue[i] = (ib * fall).mul_add(fade(cb, metres), blue[i]);
    }
}
