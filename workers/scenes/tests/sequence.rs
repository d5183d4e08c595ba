//! A sequence shows one world that stays as it is, and no camera breaks a frame.
#![allow(clippy::unwrap_used)]

use imaging::geometry::Intrinsics;
use scenes::categories::Finding;
use scenes::path::Sway;
use scenes::{CameraPose, FAMILIES, Labels, Scene, World};

const SIZE: (usize, usize) = (160, 102);
const SWAY: Sway = Sway {
    position_m: 0.03,
    angle_rad: 0.02,
    period_frames: 25.0,
    seed: 11,
};

fn lens() -> Intrinsics {
    Intrinsics::centred(95.0, SIZE.0, SIZE.1)
}

fn frame(world: &World, pose: &CameraPose) -> (Scene, Labels) {
    world.render_labelled(pose, SIZE, &lens())
}

/// The ray of a pixel in camera axes, of length 1.
fn ray(x: f64, y: f64) -> [f64; 3] {
    let lens = lens();
    let ray = [(x - lens.cx) / lens.focal_px, (y - lens.cy) / lens.focal_px, 1.0];
    let length = (ray[0] * ray[0] + ray[1] * ray[1] + 1.0).sqrt();
    ray.map(|v| v / length)
}

/// Every point that a frame shows is where the next frame shows it, with the same category and, mostly, the same findings.
#[test]
fn points_stay_where_they_are_from_frame_to_frame() {
    for family in FAMILIES {
        for seed in 0..8 {
            let world = World::of(family, seed).unwrap();
            let path = world.path(40, SWAY).unwrap();
            let (one, other) = (path.pose(18), path.pose(21));
            assert_ne!(one, other);
            let ((before, labels), (after, later)) = (frame(&world, &one), frame(&world, &other));
            let (mut seen, mut same, mut grown, mut same_growth) = (0.0, 0.0, 0.0, 0.0);
            for y in 0..SIZE.1 {
                for x in 0..SIZE.0 {
                    let range = f64::from(before.range.as_ref().unwrap().at(x, y));
                    if range >= 12.0 {
                        continue;
                    }
                    let r = ray(x as f64, y as f64).map(|v| v * range);
                    let m = one.world_from_camera();
                    let point = [0, 1, 2].map(|i| m[i][0] * r[0] + m[i][1] * r[1] + m[i][2] * r[2] + m[i][3]);
                    let [u, v, z] = other.to_camera(point);
                    let (u, v) = (
                        (lens().cx + lens().focal_px * u / z).round(),
                        (lens().cy + lens().focal_px * v / z).round(),
                    );
                    let inside = z > 0.1 && u >= 0.0 && v >= 0.0 && u < SIZE.0 as f64 && v < SIZE.1 as f64;
                    if !inside {
                        continue;
                    }
                    let (u, v) = (u as usize, v as usize);
                    let expected = {
                        let away = other.to_camera(point);
                        (away[0] * away[0] + away[1] * away[1] + away[2] * away[2]).sqrt()
                    };
                    let found = f64::from(after.range.as_ref().unwrap().at(u, v));
                    // Hidden by something nearer, or beside an edge.
                    if (found - expected).abs() > 0.03 * expected {
                        continue;
                    }
                    seen += 1.0;
                    same += f64::from(u8::from(labels.semantics.at(x, y) == later.semantics.at(u, v)));
                    let growth = Finding::Growth.bit();
                    let (was, is) = (
                        labels.findings.at(x, y) & growth,
                        later.findings.at(u, v) & growth,
                    );
                    grown += f64::from(u8::from(was != 0));
                    same_growth += f64::from(u8::from(was != 0 && is != 0));
                }
            }
            assert!(seen > 1000.0, "{family} {seed}: {seen}");
            assert!(same > 0.97 * seen, "{family} {seed}: {same} of {seen}");
            // Growth has ragged borders, and a point moves by up to half a pixel.
            assert!(
                same_growth >= 0.7 * grown,
                "{family} {seed}: {same_growth} of {grown}"
            );
        }
    }
}

#[test]
fn odd_cameras_still_give_finite_frames() {
    let world = World::of("structure", 2).unwrap();
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
        // In the middle of what it looks at, under the ground, straight down from far above.
        CameraPose::looking(target, [target[0] + 1.0, target[1], target[2]], 0.0),
        CameraPose::looking([0.0, -2.0, -3.0], target, 1.0),
        CameraPose::looking([0.0, 0.0, 500.0], [0.0, 0.0, 0.0], 0.0),
    ];
    for family in FAMILIES {
        let world = World::of(family, 2).unwrap();
        for lens in lenses {
            for pose in &poses {
                let (scene, labels) = world.render_labelled(pose, (31, 17), &lens);
                let light = scene.radiance.planes().iter().flat_map(|plane| plane.data());
                assert!(
                    light.into_iter().all(|v| v.is_finite() && *v >= 0.0),
                    "{family} {pose:?}"
                );
                let normals = labels.normals.iter().flat_map(|plane| plane.data());
                assert!(normals.into_iter().all(|v| v.is_finite()), "{family} {pose:?}");
            }
        }
    }
}

#[test]
fn a_frame_without_pixels_is_empty() {
    let world = World::of("shaft", 1).unwrap();
    for size in [(0, 0), (0, 5), (5, 0)] {
        let (scene, labels) = world.render_labelled(&world.pose(), size, &lens());
        assert_eq!(scene.radiance.size(), size);
        assert!(labels.instances.is_empty());
    }
}
