//! Tiers of the style stage: the network in f32, its color table, and the network in f64 as the reference.

use imaging::transfer;
use style::{Library, ModelInputs, Session, net};

use super::bench::Bench;
use super::scenes::ChartScene;
use crate::measurement::{Measurement, time};

/// Measures the tiers of every shipped water on one scene; the networks see the scene in air, alpha is 1.
pub(super) fn measure(scene: &ChartScene, library: &Library, runs: usize) -> Vec<Measurement> {
    let encoded = transfer::encode_unit(&scene.radiance);
    let mut bench = Bench::new("style", scene, runs);
    for model in library.names().into_iter().filter_map(|name| library.get(name)) {
        // Models with a range input are skipped: their cost is that of the others.
        let Some(weights) = net::onnx::read(&model.onnx).filter(|weights| !weights.takes_range()) else {
            continue;
        };
        let (weights, doubled) = (weights.map(|&w| f64::from(w)), encoded.map(|&v| f64::from(v)));
        let (slow, exact) = time(1, || {
            net::apply_reference(&weights, &doubled, None).map(|&v| v as f32)
        });
        let exact = transfer::decode_unit(&exact);
        let tiers = [
            ("network", Session::native(model)),
            ("color table", Session::table(model)),
        ];
        for (tier, session) in tiers {
            let Some(mut session) = session else { continue };
            let (times, styled) = time(runs, || session.apply(&encoded, ModelInputs::default()));
            if let Ok(styled) = styled {
                let variant = format!("{tier} ({})", model.name);
                bench.push(&variant, None, times, &transfer::decode_unit(&styled), &exact);
            }
        }
        bench.push(
            &format!("network in f64 ({})", model.name),
            None,
            slow,
            &exact,
            &exact,
        );
    }
    let first = library.names().first().copied().unwrap_or_default();
    bench.finish(&format!("network ({first})"))
}
