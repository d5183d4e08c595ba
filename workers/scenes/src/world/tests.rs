use super::*;
use crate::FAMILIES;
use crate::path::tests::{STILL, straight};
use crate::site::solid::Solid;

const SEEDS: std::ops::Range<u64> = 0..24;

fn frame(family: &str, seed: u64, width: usize, height: usize) -> (World, CameraPose, Intrinsics, Scene) {
    let world = World::new(family, seed).unwrap();
    let lens = Intrinsics::centered(0.6 * width as f64, width, height);
    let pose = world.pose();
    let scene = world.render(&pose, (width, height), &lens);
    (world, pose, lens, scene)
}

#[test]
fn every_size_and_seed_gives_finite_light_that_is_never_negative() {
    for family in FAMILIES {
        for (width, height) in [(1, 1), (3, 2), (97, 61)] {
            for seed in SEEDS {
                let (.., scene) = frame(family, seed, width, height);
                assert_eq!(scene.radiance.size(), (width, height));
                let light = scene.radiance.planes().iter().flat_map(|plane| plane.data());
                assert!(
                    light.into_iter().all(|v| v.is_finite() && *v >= 0.0),
                    "{family} {seed}"
                );
            }
        }
    }
}

#[test]
fn the_same_seed_is_the_same_scene_and_another_one_is_not() {
    for family in FAMILIES {
        assert_eq!(frame(family, 5, 64, 41).3, frame(family, 5, 64, 41).3);
        assert_ne!(
            frame(family, 5, 64, 41).3.radiance,
            frame(family, 6, 64, 41).3.radiance
        );
    }
}

#[test]
fn rows_do_not_depend_on_the_band_that_they_are_rendered_in() {
    for family in FAMILIES {
        for seed in [1, 8] {
            let (world, pose, lens, scene) = frame(family, seed, 97, 61);
            for bands in [2, 3, 61] {
                let mut radiance = [const { Vec::new() }; 3];
                let mut range = Vec::new();
                for band in 0..bands {
                    let rows = 61 * band / bands..61 * (band + 1) / bands;
                    let part = site::render(
                        &world.site,
                        &pose,
                        (97, 61),
                        &lens,
                        rows,
                        RenderOptions::default(),
                    );
                    radiance
                        .iter_mut()
                        .zip(part.bands)
                        .for_each(|(all, part)| all.extend(part));
                    range.extend(part.range);
                }
                let whole = scene.radiance.planes();
                assert!((0..3).all(|c| whole[c].data() == radiance[c]), "{family} {seed}");
                assert!(scene.range.as_ref().unwrap().data() == range);
            }
        }
    }
}

#[test]
fn paths_are_clear_and_the_world_stays_as_it_is() {
    let path = Path {
        frames: 60,
        sway_m: 0.04,
        sway_deg: 1.1,
        ..STILL
    };
    for family in FAMILIES {
        let mut shortest = f64::INFINITY;
        for seed in SEEDS {
            let world = World::new(family, seed).unwrap();
            let path = world.path(&path, 3).unwrap();
            assert_eq!(world.check(&path), Ok(()), "{family} {seed}");
            let (first, last) = (path.pose(0).position_m, path.pose(59).position_m);
            shortest = shortest.min((last - first).length());
        }
        assert!(shortest > 0.2, "{family}: {shortest}");
    }
}

#[test]
fn piles_reach_beyond_the_surface_and_nothing_below_moves() {
    const SURFACE_M: f64 = 25.0;
    let mut raised = 0;
    for seed in SEEDS {
        let bare = World::new("structure", seed).unwrap();
        let mut world = World::new("structure", seed).unwrap();
        world.raise_piles(SURFACE_M);
        assert_eq!(bare.pose(), world.pose());
        for (before, after) in bare.site.solids.iter().zip(&world.site.solids) {
            let top = |solid: &Solid| solid.corners()[4].z;
            assert_eq!(before.pose, after.pose);
            if top(before) != top(after) {
                raised += 1;
                assert!(top(before) < top(after) && f64::from(top(after)) > SURFACE_M);
            }
        }
    }
    assert!(raised > 20, "{raised}");
}

#[test]
fn a_path_through_something_is_refused() {
    let world = World::new("pipeline", 3).unwrap();
    let [x, y, _]: [f64; 3] = world.target().into();
    let [start, through] = [3.0, -1.0].map(|height| Waypoint {
        position_m: [x, y, height],
        target_m: [x, y + 1.0, height],
    });
    let path = straight(start, through, 101);
    let error = world.check(&path).unwrap_err();
    assert!(
        matches!(error, SceneError::Blocked { frame: 10..=90, .. }),
        "{error}"
    );
}

#[test]
fn instances_have_no_gaps_and_nothing_is_where_there_is_no_range() {
    for family in FAMILIES {
        for seed in SEEDS {
            let (.., scene) = frame(family, seed, 96, 62);
            let (instances, range) = (scene.instances.unwrap(), scene.range.unwrap());
            let most = *instances.data().iter().max().unwrap();
            assert!(most >= 2, "{family} {seed} shows no structure");
            assert!(
                (2..=most).all(|id| instances.data().contains(&id)),
                "{family} {seed}"
            );
            let mut pixels = instances.data().iter().zip(range.data());
            assert!(
                pixels.all(|(&id, z)| (id == 0) == z.is_infinite()),
                "{family} {seed}"
            );
        }
    }
}
