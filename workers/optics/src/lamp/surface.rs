//! The light of lamps on surfaces.

mod discs;
mod joined;
mod precise;
mod row;
mod shade;

use imaging::rays::Rays;
use imaging::vectorized;
use imaging::{Plane, Rgb};

use super::beam::Profile;
use super::{Lamp, Lighting};
use crate::attenuation::masked;
use crate::elementary::{HALVINGS, fade};
use crate::extremes::{brightest, greatest};
use crate::range::{self, SHORTEST_M};
use crate::turbidity::{self, RUN};
use joined::{Blur, Joined};
use row::{Row, places_of};
use shade::Shade;

/// A Lambertian surface reflects J/π of its irradiance.
const PER_STERADIAN: f32 = std::f32::consts::FRAC_1_PI;

/// The light of lamps on surfaces.
#[derive(Debug, Clone, PartialEq)]
pub struct Irradiance {
    /// E.
    pub light: Rgb<f32>,
    /// Upper bound of the difference from [`irradiance_reference`](super::irradiance_reference).
    pub rounding: f64,
}

/// [`irradiance_reference`](super::irradiance_reference) in f32. Shadows are ignored.
#[must_use]
pub fn irradiance(range: &Plane<f32>, normals: &[Plane<f32>; 3], lighting: &Lighting) -> Irradiance {
    shine_on(range, normals, lighting, Options::default())
}

/// [`irradiance`] with some tiles of a [`VisibleBounds`](crate::visible_bounds::VisibleBounds) in f64: those that are true.
#[must_use]
pub fn irradiance_in_tiles(
    precise: &[bool],
    range: &Plane<f32>,
    normals: &[Plane<f32>; 3],
    lighting: &Lighting,
) -> Irradiance {
    let options = Options {
        precise,
        ..Options::default()
    };
    shine_on(range, normals, lighting, options)
}

/// [`shaded_irradiance_reference`](super::shaded_irradiance_reference) in f32. It has four errors that `rounding` does not
/// include. A ray that grazes an edge may pass on its other side. If all or none of the rim samples of a soft lamp are occluded, it
/// counts as fully dark or fully lit. Shadows of a few pixels may be missed in large pictures. The discs of scattered lamp light are
/// sampled at few pixels where they change little. Light up to `unseen` on a surface is never occluded.
#[must_use]
pub fn shaded_irradiance(
    range: &Plane<f32>,
    normals: &[Plane<f32>; 3],
    lighting: &Lighting,
    rays: (&dyn Rays, f64),
) -> Irradiance {
    shaded_irradiance_in_tiles(&[], (range, normals), lighting, rays)
}

/// [`shaded_irradiance`] with some tiles in f64 as in [`irradiance_in_tiles`].
#[must_use]
pub fn shaded_irradiance_in_tiles(
    precise: &[bool],
    (range, normals): (&Plane<f32>, &[Plane<f32>; 3]),
    lighting: &Lighting,
    rays: (&dyn Rays, f64),
) -> Irradiance {
    let options = Options {
        precise,
        rays: Some(rays),
    };
    shine_on(range, normals, lighting, options)
}

/// Tiles in f64, and the shadow rays with their threshold of light.
#[derive(Clone, Copy, Default)]
struct Options<'a> {
    precise: &'a [bool],
    rays: Option<(&'a dyn Rays, f64)>,
}

fn shine_on(
    range: &Plane<f32>,
    normals: &[Plane<f32>; 3],
    lighting: &Lighting,
    options: Options<'_>,
) -> Irradiance {
    let (width, height) = range.size();
    let [mut red, mut green, mut blue] = [(); 3].map(|()| Plane::filled(width, height, 0.0f32));
    let camera = &lighting.camera;
    let lens = row::lens(camera);
    let attenuation = lighting.attenuation.map(|c| c as f32 * HALVINGS);
    let radius = lighting.radius_m as f32;
    let joined = Joined::new(lighting);
    let sources: Vec<Source> = lighting.lamps.iter().map(Source::new).collect();
    let limits: Vec<Rounding> = lighting
        .lamps
        .iter()
        .map(|lamp| Rounding::new(lamp, lighting, range))
        .collect();
    let patches = (lighting.patches.as_ref()).map(|field| turbidity::Rays::new(field, camera));
    let mut murk = vec![1.0f32; width];
    let shades: Vec<Option<Shade>> = (lighting.lamps.iter())
        .map(|lamp| Shade::new(lamp, lighting, (range, normals), options.rays?))
        .collect();
    let mut blurs: Vec<Option<Blur>> = (lighting.lamps.iter())
        .map(|lamp| Blur::new(lamp, lighting, width))
        .collect();
    let mut places = [(); 5].map(|()| vec![0.0f32; width]);
    let [mut near, mut seen] = [(); 2].map(|()| vec![0.0f32; width]);
    let mut rounding = 0.0f64;
    for y in 0..height {
        let mut to = places.each_mut().map(Vec::as_mut_slice);
        vectorized!(places_of(lens, y as f32, range.row(y), &mut to));
        let own = Row::new((&places, 0..width), (normals, y * width), (attenuation, radius));
        let mut lost = 0.0;
        for (((lamp, limit), shade), blur) in sources.iter().zip(&limits).zip(&shades).zip(&mut blurs) {
            let shade = shade.as_ref().map(|shade| shade.of_row(y));
            if let Some(patches) = &patches {
                vectorized!(murk_of(patches, y, range.row(y), (own, lamp.place), &mut murk));
            }
            if let (Some(blur), Some(water)) = (&mut *blur, joined) {
                blur.look(own, *lamp, water, &murk);
            }
            let blur = blur.as_ref().map(Blur::lanes);
            let [red, green, blue] = [&mut red, &mut green, &mut blue].map(|plane| plane.row_mut(y));
            let mut to: [&mut [f32]; 5] = [red, green, blue, &mut near, &mut seen];
            match (joined, shade) {
                (None, None) => vectorized!(shine::<false>(own, *lamp, &murk, &[], reborrow(&mut to))),
                (None, Some(shade)) => {
                    vectorized!(shine::<true>(own, *lamp, &murk, shade.direct, reborrow(&mut to)));
                }
                (Some(water), None) => {
                    joined::shine_unshaded(own, *lamp, water, (&murk, blur), reborrow(&mut to));
                }
                (Some(water), Some(shade)) => {
                    joined::shine_shaded(own, *lamp, water, (&murk, shade, blur), reborrow(&mut to));
                }
            }
            lost += limit.within(greatest(&near), greatest(&seen));
        }
        rounding = rounding.max(lost);
    }
    let mut light = Rgb::new([red, green, blue]).expect("planes of one frame");
    precise::replace(options.precise, (range, normals), (lighting, &shades), &mut light);
    Irradiance { light, rounding }
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

/// Irradiance that brightens surfaces of at most this radiance in air by at most `light`.
#[must_use]
pub fn irradiance_of(brightest: [f32; 3], light: f64) -> f64 {
    let most = f64::from(brightest.into_iter().fold(0.0, f32::max));
    light * std::f64::consts::PI / most.max(1e-30)
}

/// Rounding of [`lit`], and of irradiance computed in f64, as a share of the light.
pub const LIT_ROUNDING: f64 = 5.0 * STEP;

/// Upper bound of the error of [`lit`], for lamp light with an error of at most `rounding`.
#[must_use]
pub fn lit_rounding(radiance: &Rgb<f32>, lit: &Rgb<f32>, rounding: f64) -> f64 {
    let most = |light: &Rgb<f32>| f64::from(brightest(light).into_iter().fold(0.0, f32::max));
    most(radiance) * rounding / std::f64::consts::PI + LIT_ROUNDING * most(lit)
}

/// One rounding of f32.
const STEP: f64 = 6e-8;

/// Rounding of f32 in the light of one lamp.
///
/// With q = 1/r and s = Z/r of a pixel, E = I₀ S e^{−c m r} (n·l) q³ loses at most
///
/// ```text
/// I₀ q² [ e^{−c m r} ( (4 + 2σ) δ + (12 + 6σ) ε + 3e-7 ) + (δ + 3 ε + μ s)/e ]
/// δ = ε ( (8 + ℓ) s + |P| q + 1 )
/// ```
///
/// ε is one rounding. δ is the error of the vector to the lamp as a share of r. A surface point has 8 roundings of its range Z, and
/// those of the principal point, ℓ = (|cx| + |cy|)/f of them; the lamp's position has one of |P|. δ enters once by n·l, which may
/// be 0 while its error is not, three times by q³, and by the cosine of a spot, whose profile rises by σ = 1/(1 − cos cone) times
/// the change of its cosine. 3e-7 is the error of the exponential. The error of its exponent x = c m r counts x e^{−x} ≤ 1/e times;
/// in patches the factor m errs by μ s more. Both brackets grow with q and s, so that their greatest values of a row bound all of
/// its pixels. With scattered lamp light, a replaces c, the blurred profile errs by 10 σ δ more, and two more exponentials do, one
/// of them with r^1.7 in its exponent.
struct Rounding {
    is_joined: bool,
    intensity: f64,
    attenuation: f64,
    slope: f64,
    lens: f64,
    distance_m: f64,
    murk: f64,
}

impl Rounding {
    fn new(lamp: &Lamp, lighting: &Lighting, range: &Plane<f32>) -> Self {
        let camera = &lighting.camera;
        let (mut clearest, mut murk) = (1.0, 0.0);
        if let Some(field) = &lighting.patches {
            clearest = field.extremes().0;
            let farthest =
                range::bounds(range.data(), range.data(), f32::MAX).map_or(0.0, |(_, far)| f64::from(far));
            // Of two means of the field, as a share of the least that there may be.
            murk = 2.0 * turbidity::path_rounding(farthest, field.scale_m()) / clearest;
        }
        let least = lighting.absorption.unwrap_or(lighting.attenuation);
        Self {
            is_joined: lighting.absorption.is_some(),
            intensity: lamp.intensity.into_iter().fold(0.0, f64::max),
            attenuation: least.into_iter().fold(f64::INFINITY, f64::min) * clearest,
            slope: lamp.beam.slope(),
            lens: (camera.cx.abs() + camera.cy.abs()) / camera.focal_px,
            distance_m: lamp.distance_m(),
            murk,
        }
    }

    /// The bound for the pixels whose q and s are at most these.
    fn within(&self, near: f32, seen: f32) -> f64 {
        let (q, s) = (f64::from(near), f64::from(seen));
        if q == 0.0 {
            return 0.0;
        }
        let way = STEP * ((8.0 + self.lens) * s + self.distance_m * q + 1.0);
        let fade = (-self.attenuation / q).exp();
        let mut profile = (4.0 + 2.0 * self.slope) * way + (12.0 + 6.0 * self.slope) * STEP + 3e-7;
        let mut exponent = (way + 3.0 * STEP + self.murk * s.max(1.0)) / std::f64::consts::E;
        if self.is_joined {
            profile += 10.0 * self.slope * way + 8.0 * self.slope * STEP + 1.2e-6;
            exponent *= 3.7;
        }
        // The fast form clamps distances to a thousand kilometers.
        self.intensity * (q * q * (fade * profile + exponent) + 1e-12)
    }
}

/// Error of a cosine to the axis of a spot, for a surface as far from the lamp as from the camera.
const EDGE: f32 = 2e-6;

/// A lamp in f32.
#[derive(Clone, Copy)]
struct Source {
    place: [f32; 3],
    profile: Profile,
    intensity: [f32; 3],
}

impl Source {
    fn new(lamp: &Lamp) -> Self {
        let single = |values: [f64; 3]| values.map(|v| v as f32);
        Self {
            place: single(lamp.position_m),
            profile: lamp.beam.single(),
            intensity: single(lamp.intensity),
        }
    }
}

/// The factor of c on the path from a lamp: the mean of the field over the same length of the ray before the surface.
#[inline(always)]
fn murk_of(
    patches: &turbidity::Rays,
    y: usize,
    range: &[f32],
    (row, [px, py, pz]): (Row<'_>, [f32; 3]),
    murk: &mut [f32],
) {
    let [places_x, places_y, places_z, _, _] = row.places;
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

fn reborrow<'a>(lanes: &'a mut [&mut [f32]; 5]) -> [&'a mut [f32]; 5] {
    lanes.each_mut().map(|lane| &mut **lane)
}

/// Adds the light of a lamp to a row, if `SHADED` times its visible share.
#[inline(always)]
fn shine<const SHADED: bool>(
    Row {
        places: [x, y, z, range, shown],
        normals: [nx, ny, nz],
        attenuation: [cr, cg, cb],
        radius,
    }: Row<'_>,
    Source {
        place: [px, py, pz],
        profile,
        intensity: [ir, ig, ib],
        ..
    }: Source,
    murk: &[f32],
    lit: &[f32],
    [red, green, blue, near, seen]: [&mut [f32]; 5],
) {
    let ([ax, ay, az], slope, offset) = (profile.axis, profile.slope, profile.offset);
    let width = red.len();
    let lit = if SHADED { &lit[..width] } else { lit };
    let (x, y, z, shown, range) = (
        &x[..width],
        &y[..width],
        &z[..width],
        &shown[..width],
        &range[..width],
    );
    let (near, seen) = (&mut near[..width], &mut seen[..width]);
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
        let rise = slope.mul_add(cos, offset);
        let profile = rise.max(0.0).min(1.0);
        let mut fall = facing * shown[i] * profile * (inverse * inverse * inverse);
        if SHADED {
            fall *= lit[i];
        }
        let meters = murk[i] * distance;
        // As far beyond the cone as rounding may carry the light.
        let share = range[i] * inverse;
        let reached = if rise > -slope * EDGE * (1.0 + share) {
            shown[i]
        } else {
            0.0
        };
        (near[i], seen[i]) = (reached * inverse, reached * share);
        red[i] = (ir * fall).mul_add(fade(cr, meters), red[i]);
        green[i] = (ig * fall).mul_add(fade(cg, meters), green[i]);
        blue[i] = (ib * fall).mul_add(fade(cb, meters), blue[i]);
    }
}
