//! Marine snow, drawn over the picture after the water and its clouds.

use imaging::{Plane, Rgb};
use optics::lamp;
use optics::plan::{ErrorBound, Stage, StageId, Variant};
use optics::snow::{self, Flake, LitFlake};
use serde_json::json;
use spec::{FrameRecord, Snow};

use crate::assessment::Assessment;
use crate::context::FrameContext;
use crate::stage::sediment::{Clouded, mean};
use crate::stage::surroundings::Surroundings;

/// Costs in ns: per pixel, and per visible particle.
const SNOW_NS: f64 = 19.6;
const PARTICLE_NS: f64 = 700.0;
/// How far beyond the picture the middle of a visible disc may be, in sides.
const BEYOND: f64 = 0.5;
/// Rounding error of f32 for a pixel with overlapping particles; twice the largest error seen with thousands in one pixel.
const ROUNDING: f64 = 4e-6;
/// The same for light behind an opaque particle: a few roundings.
const BEHIND: f64 = 3e-7;

/// Plans the snow; skipped if its expected change is within its share.
pub(crate) fn assess(assessment: &Assessment<'_>) -> Stage {
    let context = assessment.context;
    let Some(law) = &context.setting.snow else {
        return Stage::skipped(StageId::Snow);
    };
    let share = assessment.budget.snow();
    let behind = assessment.brightest_behind(assessment.airlight_peak());
    if !assessment.is_reference() && is_needless(context, law, behind, share) {
        return Stage {
            share: Some(share),
            bound: Some(ErrorBound::absolute(share)),
            note: Some("expected pixels times contrast are within its share".to_owned()),
            ..Stage::skipped(StageId::Snow)
        };
    }
    let solid = snow::solid(&context.setting.eye.camera, context.setting.size);
    let particles = snow::expected(law, solid);
    let pixels = assessment.pixels();
    let stage = Stage {
        share: Some(share),
        bound: Some(ErrorBound {
            absolute: share + BEHIND * behind,
            relative: ROUNDING,
        }),
        ..Stage::new(StageId::Snow, assessment.variant("discs"))
    };
    stage.costing(SNOW_NS + PARTICLE_NS * particles / pixels as f64, pixels)
}

fn is_needless(context: &FrameContext<'_>, law: &Snow, behind: f64, share: f64) -> bool {
    let FrameContext { frame, setting, .. } = context;
    // The clearest patch has the highest transmittance.
    let clearest = 1.0 - frame.water.turbidity.map_or(0.0, |patches| patches.contrast);
    let least = setting.attenuation().into_iter().fold(f64::INFINITY, f64::min) * clearest;
    let lamps = setting.lighting.as_ref().map_or([0.0; 3], lamp::most_white);
    let gain = setting.gain();
    let colors = [0, 1, 2].map(|i| law.albedo[i] * (gain[i] + lamps[i]));
    let contrast = colors.into_iter().fold(behind, f64::max);
    snow::is_needless(law, setting.size.0 * setting.size.1, least, contrast, share)
}

/// Upper bound on the light of a visible particle; 0 without snow.
pub(crate) fn bound_flakes(context: &FrameContext<'_>) -> f64 {
    let (Some(law), Some(view)) = (&context.setting.snow, &context.view) else {
        return 0.0;
    };
    let lamps = (context.setting.lighting.as_ref()).map_or([0.0; 3], |lighting| {
        lamp::most_white_beyond(lighting, view, law.near_m)
    });
    let around = most_around(context, law);
    let colors = [0, 1, 2].map(|i| law.albedo[i] * (around[i] + lamps[i]));
    colors.into_iter().fold(0.0, f64::max)
}

/// The drawn snow.
struct Fallen {
    /// Particles whose discs reach into the frame.
    particles: usize,
    /// Opacity of each pixel.
    mask: Plane<f32>,
}

/// Draws the snow over the picture and returns its opacity combined with that of clouds; `None` if neither was drawn.
pub(crate) fn run(
    context: &FrameContext<'_>,
    clouded: Option<Clouded>,
    picture: &mut Rgb<f32>,
    record: &mut FrameRecord,
) -> Option<Plane<f32>> {
    let snow = fall(context, clouded.as_ref(), picture, record);
    match (clouded, snow) {
        (Some(clouded), Some(snow)) => Some(join(&clouded.mask, &snow)),
        (clouded, snow) => clouded.map(|clouded| clouded.mask).or(snow),
    }
}

fn join(clouds: &Plane<f32>, snow: &Plane<f32>) -> Plane<f32> {
    let pairs = clouds.data().iter().zip(snow.data());
    let both = pairs
        .map(|(cloud, flake)| cloud + flake - cloud * flake)
        .collect();
    Plane::new(clouds.width(), clouds.height(), both).expect("two masks of one picture")
}

/// Draws the snow over the picture and returns its opacity; `None` without snow or range, or if the plan skips it.
fn fall(
    context: &FrameContext<'_>,
    clouded: Option<&Clouded>,
    picture: &mut Rgb<f32>,
    record: &mut FrameRecord,
) -> Option<Plane<f32>> {
    let law = context.setting.snow.as_ref()?;
    let surroundings = Surroundings::new(context)?;
    let stage = context.plan.stage(StageId::Snow)?;
    let fallen = match stage.variant {
        Variant::Skip => None,
        Variant::Reference => Some(fall_reference(context, law, &surroundings, picture)),
        _ => {
            let range = surroundings.range;
            let mut flakes = context.shutter.flakes(&context.setting, law, range.size());
            let particles = flakes.len();
            flakes.retain(|flake| snow::is_in_front(flake, range));
            let flakes = light_flakes(&surroundings, law, &flakes, clouded);
            let share = stage.share.unwrap_or_default();
            Some(Fallen {
                particles,
                mask: snow::snow(picture, &flakes, range, share),
            })
        }
    };
    let particles = fallen.as_ref().map_or(0, |fallen| fallen.particles);
    let cover = fallen.as_ref().map_or(0.0, |fallen| mean(&fallen.mask));
    let numbers = json!({"particles": particles, "cover": cover});
    record.optics.insert("snow".to_owned(), numbers);
    fallen.map(|fallen| fallen.mask)
}

/// Upper bound of the light around white particles: of those farthest up, in a corner of the view. Discs reach into the picture from
/// beyond its sides.
fn most_around(context: &FrameContext<'_>, law: &Snow) -> [f64; 3] {
    let setting = &context.setting;
    let (width, height) = setting.size;
    let [columns, rows] = [width, height].map(|side| [-BEYOND, 1.0 + BEYOND].map(|at| at * side as f64));
    let corners = columns.into_iter().flat_map(|x| rows.map(|y| (x, y)));
    let lengths = corners.map(|(x, y)| setting.eye.camera.ray(x, y).length());
    let farthest_m = law.far_m * lengths.fold(1.0, f64::max);
    let above = setting.daylight_at(setting.up.map(|v| farthest_m * v));
    let gain = setting.gain();
    [0, 1, 2].map(|i| gain[i] * above[i])
}

/// Particles with their light, in their order.
fn light_flakes(
    surroundings: &Surroundings<'_>,
    law: &Snow,
    flakes: &[Flake],
    clouded: Option<&Clouded>,
) -> Vec<LitFlake> {
    let range = surroundings.range;
    let mut lit = surroundings.show(|surround| snow::lit(flakes, law.albedo, surround));
    // Clouds in front of a particle attenuate it.
    if let Some(layers) = clouded.and_then(|clouded| clouded.layers.as_ref()) {
        for LitFlake { flake, opacity, .. } in &mut lit {
            let clear = layers.clear_to(flake.center, flake.range_m, range.size());
            *opacity = opacity.map(|v| v * clear);
        }
    }
    lit
}

fn fall_reference(
    context: &FrameContext<'_>,
    law: &Snow,
    surroundings: &Surroundings<'_>,
    picture: &mut Rgb<f32>,
) -> Fallen {
    let flakes = context
        .shutter
        .flakes(&context.setting, law, surroundings.range.size());
    let wide = picture.map(|&v| f64::from(v));
    let (exact, mask) =
        surroundings.show(|surround| snow::snow_reference(&wide, &flakes, law.albedo, surround));
    *picture = exact.map(|&v| v as f32);
    Fallen {
        particles: flakes.len(),
        mask: mask.map(|&v| v as f32),
    }
}

/// The mask as 8-bit codes, 255 = opaque; all 0 without drawn particles.
pub(crate) fn codes(mask: Option<&Plane<f32>>, (width, height): (usize, usize)) -> Plane<u8> {
    match mask {
        Some(mask) => mask.map(|&v| (255.0 * v.clamp(0.0, 1.0)).round() as u8),
        None => Plane::filled(width, height, 0),
    }
}
