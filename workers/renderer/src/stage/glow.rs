//! The glow of the water before lamps.

use optics::chain::Layers;
use spec::FrameRecord;

use super::Shot;

/// Adds the glow to the picture and to its backscatter.
pub(crate) fn run(shot: &Shot<'_>, layers: &mut Layers, record: &mut FrameRecord) {
    if let Some(glow) = &shot.lit.glow {
        for layer in [&mut layers.backscatter, &mut layers.scattered] {
            for (sums, added) in layer.planes_mut().into_iter().zip(glow.planes()) {
                sums.iter_mut()
                    .zip(added.data())
                    .for_each(|(sum, added)| *sum += added);
            }
        }
    }
    let is_dark = !shot.lit.shines && shot.lit.lamps.glow_peak == 0.0;
    if shot.setting.lighting.is_some() && is_dark {
        record.warnings.push("no lamp lights anything in view".to_owned());
    }
}
