//! Marine snow over the picture after the water.

use imaging::{Plane, Rgb};
use optics::chain::Layers;
use optics::lamp;
use optics::plan::Form;
use optics::snow::{self, Surround};
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
    let drawn = shot.plan.snow.form != Form::Skip;
    let fallen = drawn.then(|| fall(shot, law, range, &mut layers.scattered));
    let particles = fallen.as_ref().map_or(0, |fallen| fallen.particles);
    let cover = fallen.as_ref().map_or(0.0, |fallen| {
        let sum: f64 = fallen.mask.data().iter().map(|&v| f64::from(v)).sum();
        sum / fallen.mask.data().len() as f64
    });
    let numbers = json!({"particles": particles, "cover": cover});
    record.optics.insert("snow".to_owned(), numbers);
    fallen.map(|fallen| fallen.mask)
}

fn fall(shot: &Shot<'_>, law: &Snow, range: &Plane<f32>, picture: &mut Rgb<f32>) -> Fallen {
    let (setting, step) = (&shot.setting, &shot.plan.snow);
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
    let surround = Surround {
        range,
        eye,
        attenuation: setting.attenuation(),
        path: &path,
        light: &light,
    };
    let flakes = snow::flakes(eye, law, setting.world, range.size());
    let mask = if step.form == Form::Reference {
        let wide = picture.map(|&v| f64::from(v));
        let (exact, mask) = snow::snow_reference(&wide, &flakes, law.albedo, &surround);
        *picture = exact.map(|&v| v as f32);
        mask.map(|&v| v as f32)
    } else {
        let share = step.share.unwrap_or_default();
        snow::snow(picture, &flakes, law.albedo, &surround, share)
    };
    Fallen {
        particles: flakes.len(),
        mask,
    }
}

/// The mask as 8-bit codes, 255 = opaque; all 0 where nothing was drawn.
pub(crate) fn codes(mask: Option<&Plane<f32>>, (width, height): (usize, usize)) -> Plane<u8> {
    match mask {
        Some(mask) => mask.map(|&v| (255.0 * v.clamp(0.0, 1.0)).round() as u8),
        None => Plane::filled(width, height, 0),
    }
}
