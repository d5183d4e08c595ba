//! The whole frame as it is planned, tolerance by tolerance: statistics, plan, water, haze of four lights, 8-bit codes.

use imaging::{Rgb, transfer};
use optics::chain;
use optics::forward_scatter::{KernelCache, MAX_REFERENCE_PIXELS};
use optics::plan::{Plan, SceneBounds};
use optics::water::Water;
use spec::{Fidelity, ScatterModel};

use super::bench::{Bench, DEFAULT_TOLERANCE, TOLERANCES, coastal, double};
use super::haze::{lights, overlay};
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
        let mut variants: Vec<(String, Fidelity)> = TOLERANCES
            .map(|tolerance| {
                (
                    format!("{name} ({tolerance:.0e})"),
                    Fidelity::Tolerance(tolerance),
                )
            })
            .into();
        variants.push((format!("{name} (16 kernels)"), Fidelity::Terms(16)));
        let (lights, mut cache) = (lights(4), KernelCache::new());
        for (variant, fidelity) in variants {
            let (times, (plan, image)) = time(runs, || {
                let plan = plan(scene, &water, fidelity);
                let layers = chain::water(&scene.radiance, &scene.range, &water, &plan, &mut cache);
                let image = layers.map(|layers| {
                    let hazed = optics::haze(layers.scattered.clone(), &lights);
                    cache.recycle(layers);
                    (transfer::encode_rgb8(&hazed), hazed).1
                });
                (plan, image.ok())
            });
            let terms = plan.stages.iter().filter_map(|stage| stage.terms).max();
            if let Some(image) = image {
                bench.push(&variant, terms, times, &image, &exact);
            }
        }
    }
    bench.finish(&format!("jaffe ({DEFAULT_TOLERANCE:.0e})"), None)
}

fn plan(scene: &ChartScene, water: &Water, fidelity: Fidelity) -> Plan {
    let stats = SceneBounds::measure(&scene.radiance, &scene.range, water);
    Plan::for_water(&stats, water, fidelity)
}

fn render_exact(scene: &ChartScene, water: &Water) -> Option<Rgb<f32>> {
    let scattered = if scene.range.data().len() <= MAX_REFERENCE_PIXELS {
        let range = scene.range.map(|&z| f64::from(z));
        chain::water_reference(&double(&scene.radiance), &range, water)
            .ok()?
            .scattered
    } else {
        let plan = plan(scene, water, Fidelity::Terms(PLENTY));
        let cache = &mut KernelCache::new();
        let layers = chain::water(&scene.radiance, &scene.range, water, &plan, cache);
        double(&layers.ok()?.scattered)
    };
    Some(overlay(&scattered, &lights(4), f64::INFINITY).map(|&v| v as f32))
}
