//! Rays through a world agree with its pictures.
#![allow(clippy::unwrap_used)]

use imaging::geometry::Intrinsics;
use imaging::random::Stream;
use imaging::rays::{Cuboid, Rays, ShadowRays, leaving, offset};
use imaging::vector::DVec3;
use scenes::{FAMILIES, Labels, Scene, World};

const SEEDS: std::ops::Range<u64> = 0..24;
const SIZE: (usize, usize) = (97, 61);
/// Ranges: single precision on both sides, from an origin moved along the ray.
const SAME: f64 = 2e-4;
/// Normals of labels, which are computed at rounded positions.
const SAME_NORMAL: f64 = 0.02;
/// Allowed share of rays that graze an edge and hit either side.
const GRAZING: f64 = 0.002;

struct View {
    world: World,
    lens: Intrinsics,
    scene: Scene,
    labels: Labels,
}

impl View {
    fn new(family: &str, seed: u64) -> Self {
        let world = World::new(family, seed).unwrap();
        let lens = Intrinsics::centered(0.6 * SIZE.0 as f64, SIZE.0, SIZE.1);
        let (scene, labels) = world.render_labeled(&world.pose(), SIZE, &lens);
        Self {
            world,
            lens,
            scene,
            labels,
        }
    }

    fn range(&self, x: usize, y: usize) -> f64 {
        self.scene.range.as_ref().unwrap().pixel(x, y).into()
    }

    fn ray(&self, x: usize, y: usize) -> DVec3 {
        self.lens.ray(x as f64, y as f64).normalized()
    }

    fn normal(&self, x: usize, y: usize) -> DVec3 {
        let normals = &self.labels.surfaces.as_ref().unwrap().normals;
        [0, 1, 2].map(|axis| f64::from(normals[axis].pixel(x, y))).into()
    }

    /// Surface points with their normals.
    fn surfaces(&self) -> Vec<(DVec3, DVec3)> {
        let pixels = (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y)));
        let seen = pixels.filter(|&(x, y)| self.range(x, y).is_finite());
        seen.map(|(x, y)| (self.ray(x, y) * self.range(x, y), self.normal(x, y)))
            .collect()
    }
}

/// Counts of tests and failures by family.
fn every_view(mut check: impl FnMut(&View) -> (usize, usize)) {
    for family in FAMILIES {
        let counts = SEEDS.map(|seed| check(&View::new(family, seed)));
        let (all, wrong) = counts.fold((0, 0), |(a, b), (c, d)| (a + c, b + d));
        assert!(
            all > 5_000 && wrong as f64 <= GRAZING * all as f64,
            "{family}: {wrong} of {all}"
        );
    }
}

#[test]
fn the_ray_through_a_pixel_meets_what_the_pixel_shows() {
    every_view(|view| {
        let rays = view.world.rays(&view.world.pose());
        let (mut all, mut wrong) = (0, 0);
        let mut objects: Vec<Vec<u32>> = vec![Vec::new(); 200];
        for (x, y) in (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y))) {
            let (ray, range) = (view.ray(x, y), view.range(x, y));
            let hit = rays.hit([0.0; 3], ray.into(), 0.0, f64::INFINITY);
            let is_same = match hit {
                Some(hit) => {
                    let away = DVec3::from(hit.normal) - view.normal(x, y);
                    let instance = view.scene.instances.as_ref().unwrap().pixel(x, y);
                    objects[usize::from(instance)].push(hit.object);
                    assert!(DVec3::from(hit.normal).dot(ray) <= 0.0);
                    (hit.distance / range - 1.0).abs() < SAME && away.length() < SAME_NORMAL
                }
                None => range.is_infinite(),
            };
            all += 1;
            wrong += usize::from(!is_same);
        }
        // An instance corresponds to one object, except for grazing rays.
        for met in objects.iter_mut().filter(|met| met.len() > 20) {
            met.sort_unstable();
            let middle = met[met.len() / 2];
            let others = met.iter().filter(|&&object| object != middle).count();
            assert!(
                others as f64 <= 2.0 + 0.02 * met.len() as f64,
                "{others} of {}",
                met.len()
            );
        }
        (all, wrong)
    });
}

#[test]
fn the_camera_is_seen_from_all_that_it_sees() {
    every_view(|view| {
        let rays = view.world.rays(&view.world.pose());
        let mut ways = ShadowRays::default();
        let surfaces = view.surfaces();
        for (place, normal) in &surfaces {
            let from: [f64; 3] = (*place + *normal * offset((*place).into())).into();
            ways.push(from.map(|v| v as f32), [0.0; 3]);
        }
        let mut clear = vec![false; ways.len()];
        rays.trace_shadow_rays(&ways, &mut clear);
        (clear.len(), clear.iter().filter(|clear| !**clear).count())
    });
}

#[test]
fn many_ways_at_once_are_as_clear_as_one_at_a_time() {
    let (mut hidden, mut all) = (0, 0);
    every_view(|view| {
        let rays = view.world.rays(&view.world.pose());
        let stream = Stream::stage(3, "ways");
        let surfaces = view.surfaces();
        let mut ways = ShadowRays::default();
        let mut alone = Vec::new();
        for (i, (place, normal)) in surfaces.iter().enumerate() {
            let random = |choice| 4.0 * stream.unit(i as u64 / 50, choice) - 2.0;
            let lamp = DVec3::from([random(0), random(1), random(2)]);
            let start = leaving((*place).into(), (*normal).into());
            let way = lamp + -DVec3::from(start.origin);
            ways.push(
                start.origin.map(|v| v as f32),
                <[f64; 3]>::from(lamp).map(|v| v as f32),
            );
            alone.push(!rays.occluded(start.origin, way.normalized().into(), start.from, way.length()));
        }
        let mut clear = vec![false; ways.len()];
        rays.trace_shadow_rays(&ways, &mut clear);
        hidden += clear.iter().filter(|clear| !**clear).count();
        all += clear.len();
        let wrong = clear.iter().zip(&alone).filter(|(a, b)| a != b).count();
        (clear.len(), wrong)
    });
    assert!(hidden * 20 > all, "{hidden} of {all}");
}

#[test]
fn what_lies_out_of_reach_is_not_met() {
    let view = View::new("structure", 2);
    let rays = view.world.rays(&view.world.pose());
    let column = (0..SIZE.0).find(|&x| view.range(x, 45).is_finite()).unwrap();
    let (ray, range) = (view.ray(column, 45), view.range(column, 45));
    let occluded = |from, to| rays.occluded([0.0; 3], ray.into(), from, to);
    assert!(occluded(0.0, range + 1e-3) && !occluded(0.0, range - 1e-3));
    let behind = rays.hit([0.0; 3], ray.into(), range + 1e-3, f64::INFINITY);
    assert!(behind.is_none_or(|hit| hit.distance > range + 1e-3));
}

#[test]
fn what_may_not_be_hidden_is_clear_and_nothing_is_nearer_than_its_clearance() {
    let (mut clear_boxes, mut met) = (0, 0);
    for family in FAMILIES {
        for seed in SEEDS {
            let world = World::new(family, seed).unwrap();
            let rays = world.rays(&world.pose());
            let dice = Stream::stage(seed, family);
            for number in 0..60u64 {
                let draw = |k: u64| dice.unit(number, k);
                let place = |k: u64| [0, 1, 2].map(|i| 6.0 * draw(k + i) - if i == 2 { 0.5 } else { 3.0 });
                let (from, to) = (place(0), place(3));
                let boxes = [
                    Cuboid::centered(from, 0.4 * draw(6)),
                    Cuboid::centered(to, 0.1 * draw(7)),
                ];
                let within = |cuboid: &Cuboid, k: u64| {
                    [0, 1, 2].map(|i| {
                        let share = draw(k + i as u64).powi(if k.is_multiple_of(2) { 1 } else { 4 });
                        cuboid.low[i] + share * (cuboid.high[i] - cuboid.low[i])
                    })
                };
                let mut ways = ShadowRays::default();
                for k in 0..24 {
                    let ends = [within(&boxes[0], 10 + 8 * k), within(&boxes[1], 13 + 8 * k)];
                    ways.push(ends[0].map(|v| v as f32), ends[1].map(|v| v as f32));
                }
                if !rays.may_occlude(&boxes[0], &boxes[1]) {
                    let mut clear = [false; 24];
                    rays.trace_shadow_rays(&ways, &mut clear);
                    assert!(clear.iter().all(|&clear| clear), "{family} {seed} {number}");
                    clear_boxes += 1;
                }
                let clearance = rays.clearance(from);
                for k in 0..24 {
                    let toward =
                        DVec3::from([0, 1, 2].map(|i| 2.0 * draw(300 + 3 * k + i) - 1.0)).normalized();
                    if let Some(hit) = rays.hit(from, toward.into(), 0.0, 1e3) {
                        met += 1;
                        assert!(
                            hit.distance >= clearance - 1e-3,
                            "{family} {seed}: {} {clearance}",
                            hit.distance
                        );
                    }
                }
            }
        }
    }
    assert!(clear_boxes > 500 && met > 10_000, "{clear_boxes} {met}");
}
