//! Marine snow over the picture after the water.

use imaging::{Plane, Rgb};
use optics::chain::Layers;
use optics::lamp;
use optics::plan::Form;
use optics::setting::Setting;
use optics::snow::{self, LitFlake, Surround};
use serde_json::json;
use spec::{FrameRecord, Snow};

use super::Shot;

/// The drawn snow.
struct Fallen {
    /// Particles whose discs reach into the frame.
    particles: usize,
    /// Opacity of each pixel.
    mask: Plane<f32>,
}

/// Draws the snow over the picture and returns its opacity; none without snow or range, or where the plan skips it.
pub(crate) fn run(shot: &Shot<'_>, layers: &mut Layers, record: &mut FrameRecord) -> Option<Plane<f32>> {
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
        Form::Reference => Some(fall_reference(&shot.setting, law, range, picture)),
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
pub(crate) fn lit(setting: &Setting, law: &Snow, range: &Plane<f32>) -> Vec<LitFlake> {
    let flakes = snow::flakes(&setting.eye, law, setting.world, range.size());
    surrounded(setting, range, |surround| {
        snow::lit(&flakes, law.albedo, surround)
    })
}

fn fall_reference(setting: &Setting, law: &Snow, range: &Plane<f32>, picture: &mut Rgb<f32>) -> Fallen {
    let flakes = snow::flakes(&setting.eye, law, setting.world, range.size());
    let wide = picture.map(|&v| f64::from(v));
    let (exact, mask) = surrounded(setting, range, |surround| {
        snow::snow_reference(&wide, &flakes, law.albedo, surround)
    });
    *picture = exact.map(|&v| v as f32);
    Fallen {
        particles: flakes.len(),
        mask: mask.map(|&v| v as f32),
    }
}

/// Hands out what the particles of a setting hang in.
fn surrounded<T>(setting: &Setting, range: &Plane<f32>, see: impl FnOnce(&Surround<'_>) -> T) -> T {
    let (eye, gain) = (&setting.eye, setting.gain());
    let patches = setting.patches.map(|field| field.seen_from(eye));
    let path = |place: [f64; 3], meters: f64| match &patches {
        Some(field) => field.path_m(place.map(|v| v / meters), meters),
        None => meters,
    };
    let light = |place: [f64; 3]| match &setting.lighting {
        Some(lighting) => {
            let lamps = lamp::white_at(place, lighting);
            [0, 1, 2].map(|i| gain[i] + lamps[i])
        }
        None => gain,
    };
    see(&Surround {
        range,
        eye,
        attenuation: setting.attenuation(),
        path: &path,
        light: &light,
    })
}

/// The mask as 8-bit codes, 255 = opaque; all 0 where nothing was drawn.
pub(crate) fn codes(mask: Option<&Plane<f32>>, (width, height): (usize, usize)) -> Plane<u8> {
    match mask {
        Some(mask) => mask.map(|&v| (255.0 * v.clamp(0.0, 1.0)).round() as u8),
        None => Plane::filled(width, height, 0),
    }
}
