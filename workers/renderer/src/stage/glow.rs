//! The glow of the water before lamps.

use optics::chain::Layers;
use optics::lamp::{self, REFERENCE_NODES};
use optics::plan::Form;
use spec::FrameRecord;

use super::Shot;
use super::light::any_light;

/// Adds the glow to the picture and to its backscatter.
pub(crate) fn run(shot: &Shot<'_>, layers: &mut Layers, record: &mut FrameRecord) {
    let (Some(lighting), Some(range)) = (&shot.setting.lighting, &shot.prepared.scene.range) else {
        return;
    };
    let step = &shot.plan.glow;
    let glow = match step.form {
        Form::Skip => None,
        Form::Fast => Some(lamp::airlight(range, lighting, step.share.unwrap_or_default())),
        Form::Reference => {
            let range = range.map(|&z| f64::from(z));
            Some(lamp::airlight_reference(&range, lighting, REFERENCE_NODES).map(|&v| v as f32))
        }
    };
    if let Some(glow) = &glow {
        for layer in [&mut layers.backscatter, &mut layers.scattered] {
            for (sums, added) in layer.planes_mut().into_iter().zip(glow.planes()) {
                sums.iter_mut()
                    .zip(added.data())
                    .for_each(|(sum, added)| *sum += added);
            }
        }
    }
    if !shot.lit.shines && !glow.as_ref().is_some_and(any_light) {
        record.warnings.push("no lamp lights anything in view".to_owned());
    }
}
