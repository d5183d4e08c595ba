//! Clouds of sediment and marine snow over the picture after the water.

use ::camera::Parts;
use ::camera::defocus::Focus;
use imaging::{Plane, Rgb};
use optics::chain::Layers;
use optics::plan::Form;
use optics::sediment::Layers as Clouds;
use optics::setting::Setting;
use optics::snow::{self, Flake, LitFlake, Seeing};
use serde_json::json;
use spec::{Frame, FrameRecord, Snow};

use super::camera::FRAMES_PER_S;
use super::light::casting_rays;
use super::surroundings::Surroundings;
use super::{Shot, sediment};

/// How long the shutter is open where the description does not say, s.
const EXPOSURE_S: f64 = 0.01;

/// The drawn snow.
struct Fallen {
    /// Particles whose discs reach into the frame.
    particles: usize,
    /// Opacity of each pixel.
    mask: Plane<f32>,
}

/// Draws clouds and snow over the picture and returns their opacity; none where nothing was drawn.
pub(crate) fn run(shot: &Shot<'_>, layers: &mut Layers, record: &mut FrameRecord) -> Option<Plane<f32>> {
    let clouds = sediment::run(shot, &mut layers.scattered, record);
    let snow = fall(shot, layers, record);
    let joined = |clouds: Plane<f32>, snow: Plane<f32>| {
        let pairs = clouds.data().iter().zip(snow.data());
        let both = pairs
            .map(|(cloud, flake)| cloud + flake - cloud * flake)
            .collect();
        Plane::new(clouds.width(), clouds.height(), both).expect("two masks of one picture")
    };
    match (clouds, snow) {
        (Some(clouds), Some(snow)) => Some(joined(clouds, snow)),
        (clouds, snow) => clouds.or(snow),
    }
}

/// Draws the snow over the picture and returns its opacity; none without snow or range, or where the plan skips it.
fn fall(shot: &Shot<'_>, layers: &mut Layers, record: &mut FrameRecord) -> Option<Plane<f32>> {
    let (law, range) = (shot.setting.snow.as_ref()?, shot.prepared.scene.range.as_ref()?);
    let picture = &mut layers.scattered;
    let fallen = match shot.plan.snow.form {
        Form::Skip => None,
        Form::Fast => Some(Fallen {
            particles: shot.lit.flakes.len(),
            mask: snow::snow(
                picture,
                &shot.lit.flakes,
                range,
                shot.plan.snow.share.unwrap_or_default(),
            ),
        }),
        Form::Reference => Some(fall_reference(shot, law, range, picture)),
    };
    let particles = fallen.as_ref().map_or(0, |fallen| fallen.particles);
    let cover = fallen.as_ref().map_or(0.0, |fallen| {
        let sum: f64 = fallen.mask.data().iter().map(|&v| f64::from(v)).sum();
        sum / fallen.mask.data().len() as f64
    });
    let numbers = json!({"particles": particles, "cover": cover});
    record.optics.insert("snow".to_owned(), numbers);
    fallen.map(|fallen| fallen.mask)
}

/// The particles in view as they are lit, the farthest first.
pub(super) fn lit(
    surroundings: &Surroundings<'_>,
    law: &Snow,
    shutter: &Shutter,
    clouds: Option<&Clouds>,
) -> Vec<LitFlake> {
    let range = surroundings.range;
    let flakes = shutter.flakes(surroundings.setting, law, range.size());
    let mut lit = surroundings.show(|surround| snow::lit(&flakes, law.albedo, surround));
    // What is behind a cloud is as faint as the cloud is thick.
    if let Some(layers) = clouds {
        for LitFlake { flake, opacity, .. } in &mut lit {
            let clear = layers.clear_to(flake.center, flake.range_m, range.size());
            *opacity = opacity.map(|v| v * clear);
        }
    }
    lit
}

/// Through what, when and for how long particles are seen.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Shutter {
    /// The focus of the lens, and how many pixels of the picture that is drawn are one of the camera's.
    focus: Option<(Focus, f64)>,
    exposure_s: f64,
    time_s: f64,
}

impl Shutter {
    /// That of a frame's camera, so many frames after the frame's own time.
    pub(crate) fn new(frame: &Frame, parts: Option<&Parts>, later: f64) -> Self {
        let camera = ::camera::preset::complete(&frame.camera);
        let rate = camera.frames_per_s.unwrap_or(FRAMES_PER_S);
        let sensor = camera.sensor.as_ref().and_then(::camera::preset::sensor);
        // Each picture of a movement is open for its part of the time.
        let exposure_s = match (camera.motion, camera.path) {
            (Some(motion), Some(_)) => motion.exposure_s / motion.samples as f64,
            (Some(motion), None) => motion.exposure_s,
            (None, _) => sensor.map_or(EXPOSURE_S, |sensor| sensor.exposure_s),
        };
        let scale = |parts: &Parts| {
            let shown = parts.lens.camera.focal_px * parts.lens.magnification();
            parts.source.map_or(1.0, |source| source.camera.focal_px / shown)
        };
        Self {
            focus: parts.and_then(|parts| Some((parts.focus?, scale(parts)))),
            exposure_s,
            time_s: camera.path.map_or(0.0, |path| (path.frame as f64 + later) / rate),
        }
    }

    fn flakes(&self, setting: &Setting, law: &Snow, size: (usize, usize)) -> Vec<Flake> {
        let blur_px = |range_m: f64| {
            self.focus
                .map_or(0.0, |(focus, scale)| scale * focus.radius_px(range_m))
        };
        let seeing = Seeing {
            blur_px: &blur_px,
            exposure_s: self.exposure_s,
            time_s: self.time_s,
        };
        snow::flakes(&setting.eye, law, setting.world, size, &seeing)
    }
}

fn fall_reference(shot: &Shot<'_>, law: &Snow, range: &Plane<f32>, picture: &mut Rgb<f32>) -> Fallen {
    let setting = &shot.setting;
    let flakes = shot.lit.shutter.flakes(setting, law, range.size());
    let wide = picture.map(|&v| f64::from(v));
    let rays = casting_rays(shot.frame, &shot.prepared, setting);
    let (exact, mask) = Surroundings::reference(setting, range, rays.as_deref())
        .show(|surround| snow::snow_reference(&wide, &flakes, law.albedo, surround));
    *picture = exact.map(|&v| v as f32);
    Fallen {
        particles: flakes.len(),
        mask: mask.map(|&v| v as f32),
    }
}

/// The mask as 8-bit codes, 255 = opaque; all 0 where nothing was drawn.
pub(crate) fn codes(mask: Option<&Plane<f32>>, (width, height): (usize, usize)) -> Plane<u8> {
    match mask {
        Some(mask) => mask.map(|&v| (255.0 * v.clamp(0.0, 1.0)).round() as u8),
        None => Plane::filled(width, height, 0),
    }
}
