//! Airlight of two lamps: quadratures of fixed length, and the one chosen for the tolerance.

use imaging::geometry::Intrinsics;
use optics::lamp::{LAMP_RADIUS_M, Lamp, Lighting, REFERENCE_NODES, airlight, airlight_reference};
use spec::ScatterModel;

use super::bench::{Bench, DEFAULT_TOLERANCE, TOLERANCES, coastal};
use super::scenes::{ChartScene, focal_px};
use crate::measurement::Measurement;

/// Two lamps in coastal water: one next to the camera, one in view.
fn lighting(width: usize, height: usize) -> Option<Lighting> {
    let water = coastal(width, ScatterModel::Jaffe)?;
    let lamps = [[0.5, 0.2, 0.0], [-0.6, 0.3, 2.0]];
    Some(Lighting {
        lamps: lamps
            .into_iter()
            .filter_map(|position_m| Lamp::point(position_m, [1.0, 0.9, 0.7]).ok())
            .collect(),
        radius_m: LAMP_RADIUS_M,
        camera: Intrinsics::centered(focal_px(width), width, height),
        attenuation: water.direct_attenuation(),
        scattering: water.scattering()?,
        absorption: None,
        phase: water.glow_phase(),
        patches: None,
    })
}

/// Measures every variant on one scene.
pub(super) fn measure(scene: &ChartScene, runs: usize) -> Vec<Measurement> {
    let (width, height) = scene.range.size();
    let Some(lighting) = lighting(width, height) else {
        return Vec::new();
    };
    let range = scene.range.map(|&z| f64::from(z));
    let exact = airlight_reference(&range, &lighting, REFERENCE_NODES).map(|&v| v as f32);
    let mut bench = Bench::new("lamps", scene, runs);
    for nodes in [4, 8, 16, 32] {
        bench.measure("fixed nodes in f64", Some(nodes), &exact, || {
            airlight_reference(&range, &lighting, nodes).map(|&v| v as f32)
        });
    }
    for tolerance in TOLERANCES {
        let name = format!("by tolerance ({tolerance:.0e})");
        bench.measure(&name, None, &exact, || {
            airlight(&scene.range, &lighting, tolerance).light
        });
    }
    bench.finish(&format!("by tolerance ({DEFAULT_TOLERANCE:.0e})"))
}
