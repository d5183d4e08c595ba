//! Biota and bottom: their effect on pictures and labels, and the parts that stay unchanged.
#![allow(clippy::unwrap_used)]

use imaging::Plane;
use imaging::geometry::Intrinsics;
use imaging::rays::Rays;
use scenes::categories::{CATEGORIES, Category};
use scenes::{FAMILIES, Labels, Scene, World};
use spec::{Ground, Life};

const SIZE: (usize, usize) = (160, 104);
const ALL: Life = Life {
    mussels: 14.0,
    worms: 8.0,
    weed: 5.0,
    ropes: 3,
    fish: 0.3,
    jellyfish: 0.1,
    bubbles: 20.0,
};
/// Single precision along a ray of some meters.
const ROUNDING_M: f32 = 2e-3;

fn lens() -> Intrinsics {
    Intrinsics::centered(95.0, SIZE.0, SIZE.1)
}

fn seen(world: &World) -> (Scene, Labels) {
    world.render_labeled(&world.pose(), SIZE, &lens())
}

fn filled(family: &str, seed: u64, life: Option<&Life>, ground: Option<&Ground>) -> World {
    World::filled(family, seed, life, ground).unwrap()
}

fn ranges(scene: &Scene) -> &[f32] {
    scene.range.as_ref().unwrap().data()
}

#[test]
fn nothing_asked_for_is_nothing_changed() {
    for family in FAMILIES {
        let bare = World::new(family, 3).unwrap();
        let asked = filled(family, 3, Some(&Life::default()), Some(&Ground::default()));
        assert_eq!(seen(&bare).0, seen(&asked).0, "{family}");
    }
}

#[test]
fn life_has_categories_of_its_own_and_stands_before_what_was_there() {
    let kinds = [Category::Fauna, Category::Growth, Category::Bubble];
    let mut met = [0usize; 3];
    for family in FAMILIES {
        for seed in 0..6 {
            let (bare, _) = seen(&World::new(family, seed).unwrap());
            let (scene, labels) = seen(&filled(family, seed, Some(&ALL), None));
            let pixels = ranges(&bare)
                .iter()
                .zip(ranges(&scene))
                .zip(labels.semantics.data());
            for ((before, after), code) in pixels {
                let kind = kinds.iter().position(|&kind| kind as u8 == *code);
                match kind {
                    Some(kind) => {
                        met[kind] += 1;
                        assert!(after <= before, "{family} {seed}: {after} behind {before}");
                    }
                    None if *code == Category::Cable as u8 => assert!(after <= before),
                    None => assert_eq!(before, after, "{family} {seed}"),
                }
            }
            for instance in &labels.instances {
                assert!(instance.pixels > 0 && usize::from(instance.class) < CATEGORIES.len());
            }
        }
    }
    assert!(met[0] > 500 && met[1] > 2_000 && met[2] > 20, "{met:?}");
}

#[test]
fn growth_names_the_object_that_it_is_on() {
    let mut hosted = 0;
    for family in FAMILIES {
        for seed in 0..4 {
            let (scene, labels) = seen(&filled(family, seed, Some(&ALL), None));
            let shown: Vec<u16> = labels.instances.iter().map(|instance| instance.number).collect();
            for instance in &labels.instances {
                let Some(host) = instance.host else { continue };
                assert_eq!(instance.class, Category::Growth as u8, "{family} {seed}");
                let position = shown.binary_search(&host).unwrap();
                let is_life = |class: u8| CATEGORIES[usize::from(class)].0.is_life();
                assert!(
                    !is_life(labels.instances[position].class) && host != 1,
                    "{family} {seed}"
                );
                hosted += 1;
            }
            let numbers = scene.instances.unwrap();
            let codes = |plane: &Plane<u8>| plane.clone();
            let moved = labels.moved(&numbers, codes, Plane::clone);
            assert_eq!(moved.instances, labels.instances);
        }
    }
    assert!(hosted > 200, "{hosted}");
}

#[test]
fn the_same_seed_has_the_same_life_and_the_way_of_the_camera_stays() {
    for family in FAMILIES {
        let (one, other) = (
            filled(family, 2, Some(&ALL), None),
            filled(family, 2, Some(&ALL), None),
        );
        assert_eq!(seen(&one).0, seen(&other).0);
        let bare = World::new(family, 2).unwrap();
        assert_eq!(bare.pose(), one.pose());
        let place = bare.pose().position_m;
        assert_eq!(bare.clearance(place), one.clearance(place));
    }
}

#[test]
fn currents_dig_pits_that_pictures_and_rays_meet_alike() {
    let ground = Ground {
        scour: 1.0,
        ..Ground::default()
    };
    let mut deeper = 0;
    for seed in 0..12 {
        let (bare, _) = seen(&World::new("structure", seed).unwrap());
        let world = filled("structure", seed, None, Some(&ground));
        let (scene, labels) = seen(&world);
        let rays = world.rays(&world.pose());
        for y in (0..SIZE.1).step_by(3) {
            for x in (0..SIZE.0).step_by(3) {
                let position = y * SIZE.0 + x;
                if labels.semantics.data()[position] != Category::Seabed as u8 {
                    continue;
                }
                let ray = lens().ray(x as f64, y as f64);
                let length = ray.length();
                let way = [ray.x / length, ray.y / length, ray.z / length];
                let hit = rays.hit([0.0; 3], way, 0.0, 100.0).unwrap();
                let range = ranges(&scene)[position];
                assert!(
                    (hit.distance as f32 - range).abs() < ROUNDING_M * range,
                    "seed {seed}: {hit:?}, {range}"
                );
                deeper += usize::from(range > ranges(&bare)[position] + 0.05);
            }
        }
    }
    assert!(deeper > 100, "{deeper}");
}

#[test]
fn a_buried_pipe_shows_less_of_itself() {
    let shown = |share: f64| {
        let ground = Ground {
            burial: Some(share),
            ..Ground::default()
        };
        let pixels = |seed| {
            let (_, labels) = seen(&filled("pipeline", seed, None, Some(&ground)));
            let pipe = |&&code: &&u8| code == Category::Pipe as u8;
            labels.semantics.data().iter().filter(pipe).count()
        };
        (0..6).map(pixels).sum::<usize>()
    };
    let (on, half, under) = (shown(0.0), shown(0.5), shown(1.0));
    assert!(on > half && half > 2 * under, "{on} {half} {under}");
}

#[test]
fn grains_change_sand_and_stones_alone() {
    let ground = Ground {
        grain: 1.0,
        ..Ground::default()
    };
    let (bare, _) = seen(&World::new("pipeline", 1).unwrap());
    let (scene, labels) = seen(&filled("pipeline", 1, None, Some(&ground)));
    assert_eq!(ranges(&bare), ranges(&scene));
    let grainy = [Category::Seabed as u8, Category::Stone as u8];
    let mut changed = 0;
    for (at, code) in labels.semantics.data().iter().enumerate() {
        let (before, after) = (
            bare.radiance.planes()[1].data()[at],
            scene.radiance.planes()[1].data()[at],
        );
        assert!(grainy.contains(code) || before == after);
        changed += usize::from(before != after);
    }
    assert!(changed > 1000, "{changed}");
}
