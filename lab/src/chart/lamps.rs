//! Airlight of lamps: quadratures of fixed length, and the one chosen for the tolerance.

use imaging::Rgb;
use imaging::geometry::Intrinsics;
use optics::lamp::{LAMP_RADIUS_M, Lamp, Lighting, REFERENCE_NODES, airlight, airlight_reference};
use spec::ScatterModel;

use super::difference::difference;
use super::forward_scatter::{DEFAULT_TOLERANCE, coastal};
use super::stopwatch::time;
use super::{ChartScene, Point};

const STAGE: &str = "lamps";
const FIXED: [usize; 4] = [4, 8, 16, 32];
const TOLERANCES: [f64; 6] = [1.0 / 255.0, 1e-3, DEFAULT_TOLERANCE, 1e-4, 1e-5, 1e-6];

/// `count` lamps in coastal water: the first next to the camera, the others in view at growing distance.
pub(super) fn lighting(width: usize, height: usize, count: usize) -> Option<Lighting> {
    let water = coastal(width, ScatterModel::Jaffe)?;
    let focal_px = width as f64 / (2.0 * 40f64.to_radians().tan());
    let lamp = |index: usize| {
        let i = index as f64;
        let place = if index == 0 {
            [0.5, 0.2, 0.0]
        } else {
            [0.4 * i - 1.0, 0.3, 1.5 + 0.5 * i]
        };
        Lamp::point(place, [1.0, 0.9, 0.7]).ok()
    };
    Some(Lighting {
        lamps: (0..count).filter_map(lamp).collect(),
        radius_m: LAMP_RADIUS_M,
        camera: Intrinsics::centered(focal_px, width, height),
        attenuation: water.direct_attenuation(),
        scattering: water.scattering()?,
        absorption: None,
        phase: water.glow_phase(),
        patches: None,
    })
}

/// The airlight of two lamps in one scene.
#[must_use]
pub fn glow(scene: &ChartScene, runs: usize) -> Vec<Point> {
    let (width, height) = scene.range.size();
    let Some(lighting) = lighting(width, height, 2) else {
        return Vec::new();
    };
    let doubled = scene.range.map(|&z| f64::from(z));
    let fixed = |nodes: usize| airlight_reference(&doubled, &lighting, nodes).map(|&v| v as f32);
    let exact = fixed(REFERENCE_NODES);
    let mut points = Vec::new();
    let mut add = |(variant, terms): (&str, Option<usize>), work: &mut dyn FnMut() -> Rgb<f32>| {
        let (times, glow) = time(runs, work);
        let difference = Some(difference(&glow, &exact));
        let size = (width, height);
        points.push(Point::new(
            STAGE,
            (variant, terms),
            &scene.name,
            size,
            times,
            difference,
        ));
    };
    for nodes in FIXED {
        add(("fixed nodes in f64", Some(nodes)), &mut || fixed(nodes));
    }
    for tolerance in TOLERANCES {
        let name = format!("by tolerance ({tolerance:.0e})");
        add((&name, None), &mut || {
            airlight(&scene.range, &lighting, tolerance).light
        });
    }
    let default = format!("by tolerance ({DEFAULT_TOLERANCE:.0e})");
    points
        .iter_mut()
        .for_each(|point| point.default = point.variant == default);
    points
}
