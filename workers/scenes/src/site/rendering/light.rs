//! SiteLight: a lamp at the camera with inverse-square falloff, soft light from above, and a background of open water.

use imaging::vector::Vec3;

use crate::site::Site;
use crate::site::camera::ViewCamera;
use crate::site::finish::Surface;
use crate::site::lanes::{LANES, Lane, Lane3, larger, load, mix, ramp, smaller, store};

/// Limits the lamp's light near the camera: a real lamp has a size. Relative to the full-light distance, squared.
const SOFTNESS: f32 = 0.22;
const LAMP: f32 = 0.95;
const SKY: [f32; 3] = [0.86, 0.95, 1.0];
/// Open water at the horizon relative to the light from above.
const WATER: [f32; 3] = [0.075, 0.105, 0.125];
/// Share of that without any light from above.
const DARKNESS: f32 = 0.05;
/// The ground fades into the water between these ranges, m.
const FADE_M: [f32; 2] = [9.0, 48.0];

/// Visible surfaces face the camera, even if relief and rounded edges turn the normal away.
const LEAST_FACING: f32 = 0.08;

/// The light of a site.
#[derive(Clone, Copy)]
pub(crate) struct SiteLight {
    /// The squared full-light distance of the lamp, m².
    full: f32,
    ambient: f32,
}

impl SiteLight {
    pub(crate) fn new(site: &Site) -> Self {
        Self {
            full: site.lamp_m * site.lamp_m,
            ambient: site.ambient,
        }
    }

    /// Open water in a direction of the given rise, -1..1: brighter above.
    #[inline(always)]
    fn water(&self, rise: f32) -> [f32; 3] {
        let bright = (self.ambient + DARKNESS) * (0.35 + 1.9 * ramp(rise, -0.35, 1.0));
        WATER.map(|band| bright * band)
    }
}

/// Geometry of a group of points in the solid's frame.
pub(crate) struct Lit<'a> {
    pub(crate) normal: &'a Lane3,
    pub(crate) view: &'a Lane3,
    pub(crate) range: &'a Lane,
    pub(crate) open: &'a Lane,
    pub(crate) up: Vec3,
    pub(crate) ahead: Vec3,
    pub(crate) ground: bool,
}

/// Shades pixels of open water.
#[inline(always)]
pub(crate) fn background(bands: &mut Lane3, camera: &ViewCamera, light: &SiteLight, x: &Lane, y: &Lane) {
    let (camera, light) = (*camera, *light);
    for i in 0..LANES {
        let ray = camera.ray(x[i], y[i]);
        store(bands, i, light.water(ray.z / ray.length()).into());
    }
}

/// Range of real materials.
const REFLECTANCES: [f32; 2] = [0.02, 0.8];

#[inline(always)]
fn reflectance(albedo: f32) -> f32 {
    smaller(larger(albedo, REFLECTANCES[0]), REFLECTANCES[1])
}

/// Stores the reflectance of a group.
#[inline(always)]
pub(crate) fn reflect(bands: &mut Lane3, surface: &Surface) {
    for (band, albedo) in bands.iter_mut().zip(&surface.albedo) {
        for i in 0..LANES {
            band[i] = reflectance(albedo[i]);
        }
    }
}

/// Shades a group.
#[inline(always)]
pub(crate) fn illuminate(bands: &mut Lane3, light: &SiteLight, surface: &Surface, lit: &Lit<'_>) {
    let light = *light;
    let (up, ahead) = (lit.up, lit.ahead);
    let far = if lit.ground { 1.0 } else { 0.0 };
    for i in 0..LANES {
        let (n, v) = (load(lit.normal, i), load(lit.view, i));
        let slope = load(&surface.slope, i);
        let bumped = n - (slope - n * n.dot(slope));
        let bumped = bumped * (1.0 / larger(bumped.length(), 1e-6));
        let facing = larger(bumped.dot(v), LEAST_FACING);
        // Rough surfaces lit from the viewer's direction darken little towards the limb (Oren and Nayar 1994).
        let spread = facing * (1.5 - 0.5 * facing);
        let range = lit.range[i];
        let open = lit.open[i];
        let spot = 0.25 + 0.75 * ramp(-ahead.dot(v), 0.62, 0.96);
        let near = light.full * (1.0 + SOFTNESS) / (range * range + SOFTNESS * light.full);
        let reach = LAMP * spot * near;
        let lamp = reach * spread * (0.55 + 0.45 * open);
        let squared = facing * facing;
        let sharp = squared * squared * squared * squared;
        let gleam = surface.gloss[i] * reach * sharp * sharp * sharp * 0.5;
        let sky = light.ambient * (0.55 + 0.45 * bumped.dot(up)) * open;
        let water = light.water(-v.dot(up));
        let fade = far * ramp(range, FADE_M[0], FADE_M[1]);
        for c in 0..3 {
            let albedo = reflectance(surface.albedo[c][i]);
            bands[c][i] = mix(albedo * (lamp + sky * SKY[c]) + gleam, water[c], fade);
        }
    }
}
