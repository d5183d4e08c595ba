//! The whole frame as it is planned, tolerance by tolerance: statistics, plan, water, haze of four lights, 8-bit codes.

use imaging::{Rgb, transfer};
use optics::chain;
use optics::forward_scatter::{KernelCache, MAX_REFERENCE_PIXELS};
use optics::plan::{Plan, SceneBounds};
use optics::water::Water;
use spec::{Fidelity, ScatterModel};

use super::difference::difference;
use super::forward_scatter::{DEFAULT_TOLERANCE, coastal};
use super::overlay::{lights, overlay};
use super::stopwatch::time;
use super::{ChartScene, Point};

const STAGE: &str = "frame";
const TOLERANCES: [f64; 6] = [1.0 / 255.0, 1e-3, DEFAULT_TOLERANCE, 1e-4, 1e-5, 1e-6];
/// Enough kernels to leave only the rounding of f32.
const PLENTY: usize = 24;

/// Measures everything but scene, style and files for one scene, with both scatter models: `jaffe` and `simplified`. A frame too
/// large for the reference is compared with the same chain of 24 kernels, which is as exact as f32.
#[must_use]
pub fn whole_frame(scene: &ChartScene, runs: usize) -> Vec<Point> {
    let mut points = Vec::new();
    for (model, name) in [
        (ScatterModel::Jaffe, "jaffe"),
        (ScatterModel::Simplified, "simplified"),
    ] {
        let Some(water) = coastal(scene.range.width(), model) else {
            continue;
        };
        let Some(exact) = exact(scene, &water) else {
            continue;
        };
        let lights = lights(4);
        let mut cache = KernelCache::new();
        let mut add = |variant: String, fidelity: Fidelity, is_default: bool| {
            let (times, answer) = time(runs, || {
                let plan = planned(scene, &water, fidelity);
                let layers = chain::water(&scene.radiance, &scene.range, &water, &plan, &mut cache);
                let image = layers.map(|layers| {
                    let hazed = optics::haze(layers.scattered.clone(), &lights);
                    cache.recycle(layers);
                    (transfer::encode_rgb8(&hazed), hazed).1
                });
                (plan, image.ok())
            });
            let (plan, Some(image)) = answer else { return };
            let terms = plan.stages.iter().filter_map(|stage| stage.terms).max();
            let mut point = Point::new(
                STAGE,
                (&variant, terms),
                &scene.name,
                scene.range.size(),
                times,
                Some(difference(&image, &exact)),
            );
            point.default = is_default;
            points.push(point);
        };
        for tolerance in TOLERANCES {
            let is_default = tolerance == DEFAULT_TOLERANCE && model == ScatterModel::Jaffe;
            add(
                format!("{name} ({tolerance:.0e})"),
                Fidelity::Tolerance(tolerance),
                is_default,
            );
        }
        add(format!("{name} (16 kernels)"), Fidelity::Terms(16), false);
    }
    points
}

fn planned(scene: &ChartScene, water: &Water, fidelity: Fidelity) -> Plan {
    let stats = SceneBounds::measure(&scene.radiance, &scene.range, water);
    Plan::for_water(&stats, water, fidelity)
}

fn exact(scene: &ChartScene, water: &Water) -> Option<Rgb<f32>> {
    if scene.range.data().len() <= MAX_REFERENCE_PIXELS {
        let radiance = scene.radiance.map(|&j| f64::from(j));
        let layers = chain::water_reference(&radiance, &scene.range.map(|&z| f64::from(z)), water).ok()?;
        return Some(overlay(&layers.scattered, &lights(4), f64::INFINITY).map(|&v| v as f32));
    }
    let plan = planned(scene, water, Fidelity::Terms(PLENTY));
    let layers = chain::water(
        &scene.radiance,
        &scene.range,
        water,
        &plan,
        &mut KernelCache::new(),
    );
    let hazed = overlay(
        &layers.ok()?.scattered.map(|&v| f64::from(v)),
        &lights(4),
        f64::INFINITY,
    );
    Some(hazed.map(|&v| v as f32))
}
