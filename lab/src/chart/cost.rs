//! Time against the size of the frame, the number of kernels, of lights and of lamps.

use optics::chain;
use optics::forward_scatter::KernelCache;
use optics::haze;
use optics::lamp::airlight;
use optics::plan::{Plan, SceneBounds};
use spec::{Fidelity, ScatterModel};

use super::forward_scatter::{DEFAULT_TOLERANCE, coastal};
use super::lamps::lighting;
use super::overlay::lights;
use super::stopwatch::time;
use super::{ChartScene, Point, standard_scenes};

/// From 0.1 to 16 megapixels, aspect ratio 3:2.
const SIZES: [(usize, usize); 7] = [
    (384, 256),
    (768, 492),
    (1248, 832),
    (1728, 1152),
    (2448, 1632),
    (3456, 2304),
    (4896, 3264),
];
/// Frame size for varying kernels and lights.
const USUAL: (usize, usize) = SIZES[1];

/// Measures attenuation, forward scatter, haze and lamps on a slope. Sizes above `most_megapixels` are skipped.
#[must_use]
pub fn cost(runs: usize, most_megapixels: f64) -> Vec<Point> {
    let mut points = Vec::new();
    for size in SIZES
        .into_iter()
        .filter(|(w, h)| (w * h) as f64 <= most_megapixels * 1e6)
    {
        let scene = &standard_scenes(size.0, size.1)[1];
        points.push(water("attenuation", scene, ScatterModel::None, 1, runs));
        let kernels: &[usize] = if size == USUAL {
            &[2, 4, 6, 8, 10, 12, 14, 16]
        } else {
            &[6]
        };
        points.extend(
            kernels
                .iter()
                .map(|&k| water("jaffe", scene, ScatterModel::Jaffe, k, runs)),
        );
        points.push(water("simplified", scene, ScatterModel::Simplified, 6, runs));
        let lamps: &[usize] = if size == USUAL { &[1, 2, 4, 8] } else { &[2] };
        for &count in lamps {
            let Some(lighting) = lighting(size.0, size.1, count) else {
                continue;
            };
            let (times, _) = time(runs, || airlight(&scene.range, &lighting, DEFAULT_TOLERANCE));
            let variant = ("lamps", Some(count));
            points.push(Point::new("cost", variant, &scene.name, size, times, None));
        }
        let counts: &[usize] = if size == USUAL { &[1, 2, 4, 8, 16] } else { &[4] };
        for &count in counts {
            let lights = lights(count);
            let mut image = Some(scene.radiance.clone());
            let (times, ()) = time(runs, || {
                let taken = image.take().unwrap_or_else(|| scene.radiance.clone());
                image = Some(haze(taken, &lights));
            });
            points.push(Point::new(
                "cost",
                ("haze", Some(count)),
                &scene.name,
                size,
                times,
                None,
            ));
        }
    }
    points
}

fn water(name: &str, scene: &ChartScene, model: ScatterModel, terms: usize, runs: usize) -> Point {
    let mut cache = KernelCache::new();
    let size = scene.range.size();
    let (times, _) = time(runs, || {
        let water = coastal(size.0, model)?;
        let stats = SceneBounds::measure(&scene.radiance, &scene.range, &water);
        let plan = Plan::for_water(&stats, &water, Fidelity::Terms(terms));
        let layers = chain::water(&scene.radiance, &scene.range, &water, &plan, &mut cache).ok()?;
        cache.recycle(layers);
        Some(())
    });
    let terms = Some(terms).filter(|_| model != ScatterModel::None);
    Point::new("cost", (name, terms), &scene.name, size, times, None)
}
