use imaging::rays::Hit;

use super::*;
use crate::lamp::normals_of;
use crate::view::lattice::READ_UP_TO;

const WALL_M: f64 = 4.0;
const BARS_M: f64 = 2.5;
const RADIUS_M: f64 = 0.02;
/// Share of the pixels whose visible share of a lamp may differ by more than is interpolated: shadows between the traced pixels.
const MISSED: f64 = 2e-3;
/// Mean difference in the visible share: penumbras are interpolated over up to a quarter.
const MEAN: f64 = 5e-3;

/// A wall behind bars of 2 mm to 20 mm, upright, level and oblique.
struct Bars;

impl Rays for Bars {
    fn hit(&self, origin: [f64; 3], direction: [f64; 3], from: f64, to: f64) -> Option<Hit> {
        let distance_to = |depth: f64| (depth - origin[2]) / direction[2];
        let is_in_reach = |distance: f64| distance >= from && distance <= to;
        let near = distance_to(BARS_M);
        let [x, y] = [0, 1].map(|axis| origin[axis] + near * direction[axis]);
        let across = [x, y, 0.8 * x + 0.6 * y].map(|v| (v + 0.1).rem_euclid(0.7));
        let is_bar = across
            .iter()
            .zip([0.02, 0.005, 0.002])
            .any(|(across, width)| *across < width);
        let hit = |distance| Hit {
            distance,
            normal: [0.0, 0.0, -1.0],
            object: 0,
        };
        if is_bar && is_in_reach(near) {
            return Some(hit(near));
        }
        Some(distance_to(WALL_M))
            .filter(|distance| is_in_reach(*distance))
            .map(hit)
    }
}

#[test]
fn shadows_are_found_as_if_each_pixel_were_traced() {
    let (width, height) = (640, 400);
    let camera = Intrinsics::centered(600.0, width, height);
    let range = Plane::from_fn(width, height, |x, y| {
        let ray = camera.ray(x as f64, y as f64);
        let direction = <[f64; 3]>::from(ray).map(|v| v / ray.length());
        let hit = Bars.hit([0.0; 3], direction, 0.0, 1e3);
        hit.map_or(f32::INFINITY, |hit| hit.distance as f32)
    });
    let normals = normals_of(&range, &camera);
    let surfaces = Surfaces {
        camera: &camera,
        range: &range,
        normals: &normals,
    };
    let facing = vec![IN_BEAM; width * height];
    for radius_m in [0.0, RADIUS_M] {
        let lamp = Lamp::point([0.6, -0.3, 0.2], [1.0; 3]).unwrap();
        let lamp = lamp.with_shadow(Shadow::of_lamp(radius_m), true);
        let found = surfaces.see_lamp(&lamp, &Bars, &facing);
        let (disc, mut sight, mut starts) = (
            Disc::new(lamp.shadow.disc().1),
            Sight::new(&Bars),
            Starts::default(),
        );
        (0..width * height).for_each(|at| starts.push(surfaces.start(at)));
        let mut exact = Vec::new();
        let all = (&disc, Radius::Same(radius_m as f32));
        sight.shares(&starts, lamp.position_m.map(|v| v as f32), all, &mut exact);
        let pairs = || {
            found
                .iter()
                .zip(&exact)
                .map(|(found, exact)| (found - exact).abs())
        };
        let wrong = pairs().filter(|apart| *apart > READ_UP_TO).count() as f64;
        let mean = pairs().map(f64::from).sum::<f64>() / exact.len() as f64;
        let dark = exact.iter().filter(|share| **share < 0.5).count() as f64;
        let count = exact.len() as f64;
        assert!(
            wrong <= MISSED * count && mean <= MEAN,
            "{radius_m}: {} {mean}",
            wrong / count
        );
        assert!(
            dark > 0.02 * count,
            "hardly anything is in shadow: {}",
            dark / count
        );
    }
}
