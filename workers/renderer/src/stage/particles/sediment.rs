//! Clouds of sediment, drawn over the picture after the water.

use imaging::{Plane, Rgb};
use optics::lamp;
use optics::plan::{ErrorBound, Stage, StageId, Variant};
use optics::sediment::{self, Clouds, FAR_M, Layers, Murk};
use optics::snow::Surround;
use serde_json::json;
use spec::FrameRecord;

use crate::assessment::Assessment;
use crate::context::FrameContext;
use crate::stage::surroundings::Surroundings;

/// Costs of rays through clouds, ns per pixel: without lamps, assuming that half of the rays meet no cloud, and for each lamp.
const SEDIMENT_NS: f64 = 150.0;
const LIT_SEDIMENT_NS: f64 = 5.0;

/// Plans the clouds; skipped if their change of every pixel is within their share. Drawn clouds have no bound, since an edge may be
/// anywhere between two rays.
pub(crate) fn assess(assessment: &Assessment<'_>) -> Option<Stage> {
    let context = assessment.context;
    let clouds = context.setting.sediment.as_ref()?;
    let share = assessment.budget.sediment();
    let effect = bound_effect(assessment, clouds);
    if !assessment.is_reference() && effect <= share {
        return Some(Stage {
            share: Some(share),
            bound: Some(ErrorBound::absolute(effect)),
            note: Some("no cloud is in view that hides more than its share".to_owned()),
            ..Stage::skipped(StageId::Sediment)
        });
    }
    let lamps = context
        .setting
        .lighting
        .as_ref()
        .map_or(0, |lighting| lighting.lamps.len());
    let stage = Stage {
        share: Some(share),
        bound: None,
        note: (!assessment.is_reference())
            .then(|| "edges between the rays that are followed are not bounded".to_owned()),
        ..Stage::new(StageId::Sediment, assessment.variant("rays"))
    };
    Some(stage.costing(SEDIMENT_NS + LIT_SEDIMENT_NS * lamps as f64, assessment.pixels()))
}

/// Upper bound on the change of a pixel by clouds: its light, or the light of a cloud in the brightest illumination.
fn bound_effect(assessment: &Assessment<'_>, clouds: &Clouds) -> f64 {
    let setting = &assessment.context.setting;
    let opacity = match &assessment.context.prepared.scene.range {
        Some(range) => clouds.most_opacity(range),
        None => 0.0,
    };
    let (gain, above) = (setting.gain(), setting.daylight_at(setting.up.map(|v| FAR_M * v)));
    let lamps = setting.lighting.as_ref().map_or([0.0; 3], lamp::most_white);
    let color = clouds.albedo();
    let colors = [0, 1, 2].map(|i| color[i] * (gain[i] * above[i] + lamps[i]));
    let behind = assessment.brightest_behind(assessment.airlight_peak());
    opacity * colors.into_iter().fold(behind, f64::max)
}

/// Clouds over a picture.
pub(crate) struct Clouded {
    /// Opacity of each pixel.
    pub(crate) mask: Plane<f32>,
    /// The clouds on the traced rays; `None` for the reference.
    pub(crate) layers: Option<Layers>,
}

/// Draws the clouds over the picture; `None` without clouds or range, or if the plan skips them.
pub(crate) fn run(
    context: &FrameContext<'_>,
    picture: &mut Rgb<f32>,
    record: &mut FrameRecord,
) -> Option<Clouded> {
    let clouds = context.setting.sediment.as_ref()?;
    let surroundings = Surroundings::new(context)?;
    let clouded = match context.plan.variant(StageId::Sediment) {
        Variant::Skip => None,
        Variant::Reference => Some(veil_reference(&surroundings, clouds, picture)),
        _ => {
            let range = surroundings.range;
            let layers = surroundings.show(|surround| sediment::layers(range, clouds, &murk(surround)));
            Some(Clouded {
                mask: layers.veil(picture, range),
                layers: Some(layers),
            })
        }
    };
    let cover = clouded.as_ref().map_or(0.0, |clouded| mean(&clouded.mask));
    record
        .optics
        .insert("sediment".to_owned(), json!({"cover": cover}));
    clouded
}

/// The mean of a mask.
pub(crate) fn mean(mask: &Plane<f32>) -> f64 {
    let sum: f64 = mask.data().iter().map(|&v| f64::from(v)).sum();
    sum / mask.data().len() as f64
}

fn veil_reference(surroundings: &Surroundings<'_>, clouds: &Clouds, picture: &mut Rgb<f32>) -> Clouded {
    let wide = picture.map(|&v| f64::from(v));
    let range = surroundings.range;
    let (exact, mask) =
        surroundings.show(|surround| sediment::veil_reference(&wide, range, clouds, &murk(surround)));
    *picture = exact.map(|&v| v as f32);
    Clouded {
        mask: mask.map(|&v| v as f32),
        layers: None,
    }
}

fn murk<'a>(surround: &Surround<'a>) -> Murk<'a> {
    Murk {
        attenuation: surround.attenuation,
        path: surround.path,
        light: surround.light,
    }
}
