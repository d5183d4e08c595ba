//! A sequence shows one unchanging world, and no camera breaks a frame.
#![allow(clippy::unwrap_used)]

use imaging::geometry::Intrinsics;
use imaging::vector::vec3;
use scenes::categories::Finding;
use scenes::{CameraPose, FAMILIES, Labels, Scene, World};
use spec::Path;

const SIZE: (usize, usize) = (160, 102);
const PATH: Path = Path {
    frames: 40,
    frame: 0,
    start: None,
    end: None,
    sway_m: 0.03,
    sway_deg: 1.145_915_590_261_646_4,
    sway_frames: 25.0,
};

fn lens() -> Intrinsics {
    Intrinsics::centered(95.0, SIZE.0, SIZE.1)
}

fn frame(world: &World, pose: &CameraPose) -> (Scene, Labels) {
    world.render_labeled(pose, SIZE, &lens())
}

/// Every visible point appears in the next frame with the same category and, mostly, the same findings.
#[test]
fn points_stay_where_they_are_from_frame_to_frame() {
    for family in FAMILIES {
        for seed in 0..8 {
            let world = World::new(family, seed).unwrap();
            let path = world.path(&PATH, 11).unwrap();
            let (one, other) = (path.pose(18), path.pose(21));
            assert_ne!(one, other);
            let ((before, labels), (after, later)) = (frame(&world, &one), frame(&world, &other));
            let (mut seen, mut same, mut grown, mut same_growth) = (0.0, 0.0, 0.0, 0.0);
            for y in 0..SIZE.1 {
                for x in 0..SIZE.0 {
                    let range = f64::from(before.range.as_ref().unwrap().pixel(x, y));
                    if range >= 12.0 {
                        continue;
                    }
                    let ray = lens().ray(x as f64, y as f64).normalized() * range;
                    let aside = one.right * ray.x + one.down * ray.y;
                    let point = one.position_m + aside + one.ahead * ray.z;
                    let [u, v, z]: [f64; 3] = other.to_camera(point).into();
                    let (u, v) = (
                        (lens().cx + lens().focal_px * u / z).round(),
                        (lens().cy + lens().focal_px * v / z).round(),
                    );
                    let inside = z > 0.1 && u >= 0.0 && v >= 0.0 && u < SIZE.0 as f64 && v < SIZE.1 as f64;
                    if !inside {
                        continue;
                    }
                    let (u, v) = (u as usize, v as usize);
                    let expected = other.to_camera(point).length();
                    let found = f64::from(after.range.as_ref().unwrap().pixel(u, v));
                    // Occluded, or next to an edge.
                    if (found - expected).abs() > 0.03 * expected {
                        continue;
                    }
                    seen += 1.0;
                    same += f64::from(u8::from(
                        labels.semantics.pixel(x, y) == later.semantics.pixel(u, v),
                    ));
                    let growth = Finding::Growth.bit();
                    let (was, is) = (
                        labels.surfaces.as_ref().unwrap().findings.pixel(x, y) & growth,
                        later.surfaces.as_ref().unwrap().findings.pixel(u, v) & growth,
                    );
                    grown += f64::from(u8::from(was != 0));
                    same_growth += f64::from(u8::from(was != 0 && is != 0));
                }
            }
            assert!(seen > 100.0, "{family} {seed}: {seen}");
            // A point moves by up to half a pixel, across the border of a category too.
            assert!(same > 0.96 * seen, "{family} {seed}: {same} of {seen}");
            // Growth has ragged borders, and a point moves by up to half a pixel.
            assert!(
                grown < 100.0 || same_growth >= 0.7 * grown,
                "{family} {seed}: {same_growth} of {grown}"
            );
        }
    }
}

#[test]
fn odd_cameras_still_give_finite_frames() {
    let world = World::new("structure", 2).unwrap();
    let lenses = [
        Intrinsics {
            focal_px: 0.5,
            cx: -900.0,
            cy: 4000.0,
        },
        Intrinsics {
            focal_px: 1e6,
            cx: 3.0,
            cy: 2.0,
        },
    ];
    let target = world.target();
    let poses = [
        world.pose(),
        // Inside the target, under the ground, straight down from far above.
        CameraPose::looking(target, target + vec3(1.0, 0.0, 0.0), 0.0),
        CameraPose::looking(vec3(0.0, -2.0, -3.0), target, 1.0),
        CameraPose::looking(vec3(0.0, 0.0, 500.0), vec3(0.0, 0.0, 0.0), 0.0),
    ];
    for family in FAMILIES {
        let world = World::new(family, 2).unwrap();
        for lens in lenses {
            for pose in &poses {
                let (scene, labels) = world.render_labeled(pose, (31, 17), &lens);
                let light = scene.radiance.planes().iter().flat_map(|plane| plane.data());
                assert!(
                    light.into_iter().all(|v| v.is_finite() && *v >= 0.0),
                    "{family} {pose:?}"
                );
                let normals = labels
                    .surfaces
                    .iter()
                    .flat_map(|surfaces| &surfaces.normals)
                    .flat_map(|plane| plane.data());
                assert!(normals.into_iter().all(|v| v.is_finite()), "{family} {pose:?}");
            }
        }
    }
}

#[test]
fn a_frame_without_pixels_is_empty() {
    let world = World::new("shaft", 1).unwrap();
    for size in [(0, 0), (0, 5), (5, 0)] {
        let (scene, labels) = world.render_labeled(&world.pose(), size, &lens());
        assert_eq!(scene.radiance.size(), size);
        assert!(labels.instances.is_empty());
    }
}
