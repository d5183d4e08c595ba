//! Views drawn from a seed, and changes by a description.
#![allow(clippy::unwrap_used)]

use imaging::geometry::Intrinsics;
use scenes::categories::Category;
use scenes::{CameraPose, FAMILIES, LEAST_CLEARANCE_M, SceneError, World};
use spec::CameraView;

const SIZE: (usize, usize) = (96, 62);
const SEEDS: std::ops::Range<u64> = 0..60;
/// Single precision of positions and angles.
const ROUNDING: f64 = 1e-5;

#[derive(Debug, Clone, Copy)]
struct Shares {
    water: f64,
    ground: f64,
}

fn shares(world: &World) -> Shares {
    let focal = 0.5 * SIZE.0 as f64 / libm::tan(40f64.to_radians());
    let lens = Intrinsics::centered(focal, SIZE.0, SIZE.1);
    let (_, labels) = world.render_labeled(&world.pose(), SIZE, &lens);
    let share = |category: Category| {
        let codes = labels.semantics.data();
        codes.iter().filter(|&&code| code == category as u8).count() as f64 / codes.len() as f64
    };
    Shares {
        water: share(Category::Background),
        ground: share(Category::Seabed),
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn pitch_deg(pose: &CameraPose) -> f64 {
    libm::asin(pose.ahead.z).to_degrees()
}

#[test]
fn drawn_views_are_clear_look_up_and_down_and_show_water_and_things() {
    for family in FAMILIES {
        let (mut water, mut pitches, mut empty) = (Vec::new(), Vec::new(), 0);
        for seed in SEEDS {
            let world = World::new(family, seed).unwrap();
            let pose = world.pose();
            assert!(world.clearance(pose.position_m) >= 0.29, "{family} {seed}");
            let shown = shares(&world);
            empty += usize::from(shown.water + shown.ground > 0.985);
            water.push(shown.water);
            pitches.push(pitch_deg(&pose));
        }
        let up = pitches.iter().filter(|&&pitch| pitch > 5.0).count();
        let down = pitches.iter().filter(|&&pitch| pitch < -5.0).count();
        let water = median(water);
        println!(
            "{family}: median share of water {water:.2}, {up} look up, {down} down, {empty} are empty, median pitch {:.0}",
            median(pitches)
        );
        assert!(up >= 15 && down >= 10, "{family}: {up} up, {down} down");
        assert!(empty <= 1, "{family}: {empty} views show nothing");
        assert!(*family == "shaft" || water > 0.3, "{family}: {water}");
    }
}

#[test]
fn given_values_replace_the_drawn_ones_and_the_world_stays() {
    for family in FAMILIES {
        for seed in 0..8 {
            let mut world = World::new(family, seed).unwrap();
            let drawn = world.pose();
            world.set_view(&CameraView::default()).unwrap();
            assert_eq!(world.pose(), drawn, "{family} {seed}");
            let view = CameraView {
                pitch_deg: Some(-12.5),
                height_m: Some(1.75),
                ..CameraView::default()
            };
            world.set_view(&view).unwrap();
            let pose = world.pose();
            assert!((pitch_deg(&pose) + 12.5).abs() < ROUNDING);
            assert!(world.clearance(pose.position_m) >= LEAST_CLEARANCE_M);
            let turned = CameraView {
                yaw_deg: Some(30.0),
                ..view
            };
            world.set_view(&turned).unwrap();
            let ahead = world.pose().ahead;
            let yaw = libm::atan2(ahead.x, ahead.y).to_degrees();
            assert!((yaw - 30.0).abs() < ROUNDING, "{family} {seed}: {yaw}");
            let mut other = World::new(family, seed).unwrap();
            other.set_view(&turned).unwrap();
            assert_eq!(other.pose(), world.pose(), "{family} {seed}");
        }
    }
}

#[test]
fn height_and_distance_are_those_of_the_camera() {
    let mut world = World::new("structure", 2).unwrap();
    let view = CameraView {
        pitch_deg: Some(20.0),
        height_m: Some(2.5),
        distance_m: Some(6.0),
        ..CameraView::default()
    };
    world.set_view(&view).unwrap();
    let position = world.pose().position_m;
    assert!((position.z - 2.5).abs() < ROUNDING);
    assert!(((world.target() - position).length() - 6.0).abs() < ROUNDING);
}

#[test]
fn a_value_that_leaves_no_free_place_is_named() {
    let mut world = World::new("shaft", 1).unwrap();
    let view = CameraView {
        distance_m: Some(30.0),
        ..CameraView::default()
    };
    let error = world.set_view(&view).unwrap_err();
    assert!(
        matches!(
            error,
            SceneError::View {
                field: "view.distance_m",
                ..
            }
        ),
        "{error}"
    );
    let text = error.to_string();
    assert!(
        text.starts_with("`camera.view.distance_m` is 30, which puts the camera -"),
        "{text}"
    );
}
