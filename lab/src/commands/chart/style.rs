//! Tiers of the style stage: the network in f32, its color table, and the network in f64 as the reference.

use imaging::{Rgb, transfer};
use lab::chart::{ChartScene, Point, difference, time};
use style::{Library, Session, net};

/// The stage.
pub(super) const STAGE: &str = "style";

/// Measures the tiers of every shipped water on one scene; the networks see the scene in air, alpha is 1.
pub(super) fn tiers(scene: &ChartScene, library: &Library, runs: usize) -> Vec<Point> {
    let encoded = transfer::encode_unit(&scene.radiance);
    let mut points = Vec::new();
    for name in library.names() {
        let Some(model) = library.get(name) else { continue };
        // Models with a range input are skipped: their cost is that of the others.
        let Some(weights) = net::onnx::read(&model.onnx).filter(|weights| !weights.takes_range()) else {
            continue;
        };
        let (weights, doubled) = (weights.map(|&w| f64::from(w)), encoded.map(|&v| f64::from(v)));
        let (slow, exact) = time(1, || {
            net::apply_reference(&weights, &doubled, None).map(|&v| v as f32)
        });
        let exact = transfer::decode_unit(&exact);
        let mut add = |tier: &str, times, picture: &Rgb<f32>| {
            let variant = format!("{tier} ({name})");
            let difference = Some(difference(picture, &exact));
            let size = encoded.size();
            points.push(Point::new(
                STAGE,
                (&variant, None),
                &scene.name,
                size,
                times,
                difference,
            ));
        };
        for (tier, session) in [
            ("network", Session::native(model)),
            ("color table", Session::table(model)),
        ] {
            let Some(mut session) = session else { continue };
            let (times, styled) = time(runs, || session.apply(&encoded, style::ModelInputs::default()));
            if let Ok(styled) = styled {
                add(tier, times, &transfer::decode_unit(&styled));
            }
        }
        add("network in f64", slow, &exact);
    }
    let first = library.names().first().map(|name| format!("network ({name})"));
    points
        .iter_mut()
        .for_each(|point| point.default = Some(&point.variant) == first.as_ref());
    points
}
