//! Clouds of sediment over the picture after the water.

use imaging::{Plane, Rgb};
use optics::plan::Form;
use optics::sediment::{self, Layers, Murk};
use optics::setting::Setting;
use serde_json::json;
use spec::FrameRecord;

use super::Shot;
use super::snow::surrounded;

/// What the clouds of a setting do on some rays; none without clouds.
pub(crate) fn layers(setting: &Setting, range: &Plane<f32>) -> Option<Layers> {
    let clouds = setting.sediment.as_ref()?;
    Some(surrounded(setting, range, |surround| {
        let murk = Murk {
            attenuation: surround.attenuation,
            path: surround.path,
            light: surround.light,
        };
        sediment::layers(range, clouds, &murk)
    }))
}

/// Draws the clouds over the picture and returns their opacity; none without clouds or range.
pub(super) fn run(shot: &Shot<'_>, picture: &mut Rgb<f32>, record: &mut FrameRecord) -> Option<Plane<f32>> {
    let (clouds, range) = (
        shot.setting.sediment.as_ref()?,
        shot.prepared.scene.range.as_ref()?,
    );
    let mask = if Form::asked_by(shot.frame.fidelity) == Form::Reference {
        let wide = picture.map(|&v| f64::from(v));
        let (exact, mask) = surrounded(&shot.setting, range, |surround| {
            let murk = Murk {
                attenuation: surround.attenuation,
                path: surround.path,
                light: surround.light,
            };
            sediment::veil_reference(&wide, range, clouds, &murk)
        });
        *picture = exact.map(|&v| v as f32);
        mask.map(|&v| v as f32)
    } else {
        layers(&shot.setting, range)?.veil(picture, range)
    };
    let sum: f64 = mask.data().iter().map(|&v| f64::from(v)).sum();
    let cover = sum / mask.data().len() as f64;
    record
        .optics
        .insert("sediment".to_owned(), json!({"cover": cover}));
    Some(mask)
}
