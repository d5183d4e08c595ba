//! Clouds of sediment over the picture after the water.

use imaging::{Plane, Rgb};
use optics::plan::Form;
use optics::sediment::{self, Clouds, Layers, Murk};
use optics::snow::Surround;
use serde_json::json;
use spec::FrameRecord;

use super::Shot;
use super::light::casting_rays;
use super::surroundings::Surroundings;

/// What the clouds of a setting do on some rays; none without clouds.
pub(super) fn layers(surroundings: &Surroundings<'_>) -> Option<Layers> {
    let clouds = surroundings.setting.sediment.as_ref()?;
    let range = surroundings.range;
    Some(surroundings.show(|surround| sediment::layers(range, clouds, &murk(surround))))
}

/// Draws the clouds over the picture and returns their opacity; none without clouds or range, or where the plan
/// skips them.
pub(super) fn run(shot: &Shot<'_>, picture: &mut Rgb<f32>, record: &mut FrameRecord) -> Option<Plane<f32>> {
    let (clouds, range) = (
        shot.setting.sediment.as_ref()?,
        shot.prepared.scene.range.as_ref()?,
    );
    let mask = match shot.plan.sediment.as_ref().map_or(Form::Skip, |stage| stage.form) {
        Form::Skip => None,
        Form::Fast => shot.lit.clouds.as_ref().map(|layers| layers.veil(picture, range)),
        Form::Reference => Some(veil_reference(shot, clouds, range, picture)),
    };
    let cover = mask.as_ref().map_or(0.0, |mask| {
        let sum: f64 = mask.data().iter().map(|&v| f64::from(v)).sum();
        sum / mask.data().len() as f64
    });
    record
        .optics
        .insert("sediment".to_owned(), json!({"cover": cover}));
    mask
}

fn veil_reference(
    shot: &Shot<'_>,
    clouds: &Clouds,
    range: &Plane<f32>,
    picture: &mut Rgb<f32>,
) -> Plane<f32> {
    let wide = picture.map(|&v| f64::from(v));
    let rays = casting_rays(shot.frame, &shot.prepared, &shot.setting);
    let (exact, mask) = Surroundings::reference(&shot.setting, range, rays.as_deref())
        .show(|surround| sediment::veil_reference(&wide, range, clouds, &murk(surround)));
    *picture = exact.map(|&v| v as f32);
    mask.map(|&v| v as f32)
}

fn murk<'a>(surround: &Surround<'a>) -> Murk<'a> {
    Murk {
        attenuation: surround.attenuation,
        path: surround.path,
        light: surround.light,
    }
}
