//! The whole frame as it is planned, tolerance by tolerance: statistics, plan, water, 8-bit codes.

use imaging::{Rgb, transfer};
use optics::chain;
use optics::forward_scatter::{KernelCache, MAX_REFERENCE_PIXELS};
use optics::plan::{Plan, SceneBounds};
use optics::water::Water;
use spec::{Fidelity, ScatterModel};

use super::bench::{Bench, DEFAULT_TOLERANCE, TOLERANCES, coastal};
use super::scenes::ChartScene;
use crate::measurement::{Measurement, time};

/// Enough kernels to leave only the rounding of f32.
const PLENTY: usize = 24;

/// Measures everything but scene, style and files for one scene, with both scatter models: `jaffe` and `simplified`. A frame too
/// large for the reference is compared with the same chain of 24 kernels, which is as exact as f32.
pub(super) fn measure(scene: &ChartScene, runs: usize) -> Vec<Measurement> {
    let mut bench = Bench::new("frame", scene, runs);
    for (model, name) in [
        (ScatterModel::Jaffe, "jaffe"),
        (ScatterModel::Simplified, "simplified"),
    ] {
        let water = coastal(scene.range.width(), model);
        let exact = water.as_ref().and_then(|water| render_exact(scene, water));
        let Some((water, exact)) = water.zip(exact) else {
            continue;
        };
        let mut cache = KernelCache::new();
        let planned = TOLERANCES.map(Fidelity::Tolerance).into_iter();
        for fidelity in planned.chain([Fidelity::Terms(16)]) {
            let variant = match fidelity {
                Fidelity::Tolerance(tolerance) => format!("{name} ({tolerance:.0e})"),
                _ => format!("{name} (16 kernels)"),
            };
            let (times, (plan, image)) = time(runs, || {
                let plan = plan(scene, &water, fidelity);
                let layers = chain::water(&scene.radiance, &scene.range, &water, &plan, &mut cache);
                let image = layers.map(|layers| {
                    let light = layers.scattered.clone();
                    cache.recycle(layers);
                    (transfer::encode_rgb8(&light), light).1
                });
                (plan, image.ok())
            });
            let terms = plan.stages.iter().filter_map(|stage| stage.terms).max();
            if let Some(image) = image {
                bench.push(&variant, terms, times, &image, &exact);
            }
        }
    }
    bench.finish(&format!("jaffe ({DEFAULT_TOLERANCE:.0e})"))
}

fn plan(scene: &ChartScene, water: &Water, fidelity: Fidelity) -> Plan {
    let stats = SceneBounds::measure(&scene.radiance, &scene.range, water);
    Plan::for_water(&stats, water, fidelity)
}

fn render_exact(scene: &ChartScene, water: &Water) -> Option<Rgb<f32>> {
    if scene.range.data().len() <= MAX_REFERENCE_PIXELS {
        let (light, range) = (
            scene.radiance.map(|&v| f64::from(v)),
            scene.range.map(|&z| f64::from(z)),
        );
        let exact = chain::water_reference(&light, &range, water).ok()?;
        return Some(exact.scattered.map(|&v| v as f32));
    }
    let plan = plan(scene, water, Fidelity::Terms(PLENTY));
    let cache = &mut KernelCache::new();
    let layers = chain::water(&scene.radiance, &scene.range, water, &plan, cache);
    Some(layers.ok()?.scattered)
}
