//! The previous picture of a path is the same, cached or rendered again.

use imaging::Rgb8;
use renderer::{SceneSource, Slot};
use serde_json::{Value, json};
use spec::Job;

use super::{contents, describe, picture, range};
use crate::common::{engine_without_runtime, parse};

const FRAMES: u64 = 6;

fn noisy() -> Value {
    let camera = json!({"path": {"frames": 3, "sway_m": 0.05}, "sensor": {"light_level": 0.1}, "exposure": {"auto": {}},
                        "distortion": {"k1": -0.05}});
    let fields = json!({"count": FRAMES, "artifacts": ["rgb", "range"], "metrics": ["entropy"], "fidelity": {"budget_ms": 40},
                        "water": {"optics": "jerlov-1C", "snow": {"density_per_m3": 300}}});
    describe(&camera, &fields)
}

fn previous_picture(slot: &mut Slot, job: &Job, index: u64) -> Option<Rgb8> {
    let frame = job.resolve(index).unwrap();
    let held = slot.previous(&frame, &SceneSource::Local).unwrap();
    held.map(|held| held.rgb.clone())
}

#[test]
fn the_previous_picture_is_that_of_the_previous_frame() {
    let job = parse(&noisy());
    for index in 0..FRAMES {
        let mut slot = Slot::new(&engine_without_runtime());
        let frame = job.resolve(index).unwrap();
        let held = slot.previous(&frame, &SceneSource::Local).unwrap();
        assert_eq!(held.is_none(), index % 3 == 0, "{index}");
        if let Some(held) = held {
            let expected = contents(&noisy(), index - 1);
            assert_eq!(held.rgb, *picture(&expected, "rgb"));
            assert_eq!(held.range.as_ref(), Some(range(&expected)));
            let pose = super::scene(&expected).world_from_camera.unwrap();
            assert_eq!(held.viewpoint.pose.world_from_camera(), pose);
        }
    }
}

#[test]
fn pictures_and_records_do_not_depend_on_the_order_or_the_cache() {
    let job = parse(&noisy());
    let fresh: Vec<_> = (0..FRAMES)
        .map(|index| previous_picture(&mut Slot::new(&engine_without_runtime()), &job, index))
        .collect();
    let mut digests: Vec<Vec<String>> = Vec::new();
    for order in [[0, 1, 2, 3, 4, 5], [5, 2, 4, 1, 0, 3], [3, 3, 4, 5, 5, 2]] {
        let mut slot = Slot::new(&engine_without_runtime());
        let mut own = vec![String::new(); FRAMES as usize];
        for index in order {
            assert_eq!(
                previous_picture(&mut slot, &job, index),
                fresh[index as usize],
                "{index}"
            );
            let frame = job.resolve(index).unwrap();
            let rendered = slot.render(&frame, &SceneSource::Local).unwrap();
            own[index as usize] = rendered.record.digest();
        }
        digests.push(own);
    }
    let plain = |index: u64| {
        let frame = job.resolve(index).unwrap();
        let mut slot = Slot::new(&engine_without_runtime());
        slot.render(&frame, &SceneSource::Local).unwrap().record.digest()
    };
    for (index, (one, other)) in digests[0].iter().zip(&digests[1]).enumerate() {
        assert_eq!((one, other), (&plain(index as u64), one), "{index}");
    }
    for (one, other) in digests[2]
        .iter()
        .zip(&digests[0])
        .filter(|(one, _)| !one.is_empty())
    {
        assert_eq!(one, other);
    }
}

#[test]
fn rays_and_projections_of_a_viewpoint_are_inverse() {
    let job = parse(&noisy());
    let mut slot = Slot::new(&engine_without_runtime());
    let frame = job.resolve(1).unwrap();
    let held = slot.previous(&frame, &SceneSource::Local).unwrap().unwrap();
    for place in [[0.0, 0.0], [60.5, 40.25], [119.0, 79.0]] {
        let ray = held.viewpoint.ray(place).unwrap();
        assert!((ray.iter().map(|v| v * v).sum::<f64>() - 1.0).abs() < 1e-12);
        let [x, y] = held.viewpoint.project(ray.map(|v| 3.0 * v)).unwrap();
        assert!((x - place[0]).hypot(y - place[1]) < 1e-9);
    }
    assert_eq!(held.viewpoint.project([0.0, 0.0, -1.0]), None);
    let same = held.viewpoint.relative_to(&held.viewpoint);
    let [x, y, z] = same.apply([1.0, 2.0, 3.0]);
    assert!((x - 1.0).abs() + (y - 2.0).abs() + (z - 3.0).abs() < 1e-12);
}
