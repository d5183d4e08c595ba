//! Flow against re-projection from published numbers, the analytic plane, and the pictures.

use imaging::Rgb;
use imaging::rays::Rays;
use scenes::{CameraPose, World};
use serde_json::{Value, json};
use spec::LensRecord;

use super::{along, contents, describe, linear, moved_path, picture, range, scene, to_camera, to_world};

/// Rounding of positions to f32 in a picture of 120 px, and of the range: px.
const ROUNDING_PX: f64 = 1e-4;
/// Two samples of a range image differ by more than this share at an edge.
const EDGE: f64 = 0.05;

fn flow_job(camera: &Value, fields: &Value) -> Value {
    let mut camera = camera.clone();
    if camera.get("path").is_none() {
        camera["path"] = moved_path(3, [0.3, 0.1, 0.2]);
    }
    let mut fields = fields.clone();
    fields["artifacts"] = json!(["flow", "range", "clean", "instances"]);
    fields["count"] = json!(3);
    describe(&camera, &fields)
}

/// Pixels of two planes by row.
fn pixels(flow: &Rgb<f32>) -> impl Iterator<Item = (usize, usize, [f32; 3])> + '_ {
    let (width, height) = flow.size();
    (0..height).flat_map(move |y| (0..width).map(move |x| (x, y, flow.pixel(x, y))))
}

fn near(flow: f32, expected: f64) -> bool {
    (f64::from(flow) - expected).abs() < ROUNDING_PX
}

#[test]
fn flow_is_the_reprojection_by_range_and_both_poses() {
    let job = flow_job(
        &json!({"path": {"frames": 5, "sway_m": 0.1, "sway_deg": 3}}),
        &json!({}),
    );
    let (this, next) = (contents(&job, 1), contents(&job, 2));
    let camera = scene(&this).intrinsics;
    let poses = [&this, &next].map(|contents| scene(contents).world_from_camera.unwrap());
    let (mut found, mut moved) = (0, 0.0f32);
    for (x, y, [dx, dy, _]) in pixels(linear(&this, "flow")) {
        let meters = range(&this).pixel(x, y);
        if !meters.is_finite() {
            assert!(dx.is_nan() && dy.is_nan());
            continue;
        }
        let point = along(&camera, [x as f64, y as f64], f64::from(meters));
        let [u, v, w] = to_camera(&poses[1], to_world(&poses[0], point));
        let target = [
            camera.cx + camera.focal_px * u / w,
            camera.cy + camera.focal_px * v / w,
        ];
        assert!(
            near(dx, target[0] - x as f64) && near(dy, target[1] - y as f64),
            "{x} {y}"
        );
        (found, moved) = (found + 1, moved.max(dx.abs()));
    }
    assert!(found > 5000 && moved > 3.0, "{found} {moved}");
}

#[test]
fn flow_of_the_ground_is_that_of_the_plane() {
    let job = flow_job(&json!({}), &json!({}));
    let (this, next) = (contents(&job, 0), contents(&job, 1));
    let camera = scene(&this).intrinsics;
    let poses = [&this, &next].map(|contents| scene(contents).world_from_camera.unwrap());
    let mut found = 0;
    for (x, y, [dx, dy, _]) in pixels(linear(&this, "flow")) {
        // Where the ray meets z = 0, without the range image.
        let ray = along(&camera, [x as f64, y as f64], 1.0);
        let tip = to_world(&poses[0], ray);
        let [height, fall] = [poses[0][2][3], poses[0][2][3] - tip[2]];
        let meters = height / fall;
        if fall <= 0.0 || (f64::from(range(&this).pixel(x, y)) - meters).abs() > 1e-4 * meters {
            continue;
        }
        let ground = to_world(&poses[0], ray.map(|v| v * meters));
        let [u, v, w] = to_camera(&poses[1], ground);
        assert!((camera.cx + camera.focal_px * u / w - x as f64 - f64::from(dx)).abs() < 1e-2);
        assert!((camera.cy + camera.focal_px * v / w - y as f64 - f64::from(dy)).abs() < 1e-2);
        found += 1;
    }
    assert!(found > 1000, "{found}");
}

#[test]
fn flow_follows_distortion_and_port() {
    let lens = json!({"distortion": {"k1": -0.1, "k2": 0.01, "p1": 0.002}, "port": {"kind": "flat"}});
    let job = flow_job(&lens, &json!({}));
    let (this, next) = (contents(&job, 0), contents(&job, 1));
    let camera = scene(&this).intrinsics;
    let record = scene(&this).lens.clone().unwrap();
    let poses = [&this, &next].map(|contents| scene(contents).world_from_camera.unwrap());
    let mut found = 0;
    for (x, y, [dx, dy, _]) in pixels(linear(&this, "flow")) {
        let meters = f64::from(range(&this).pixel(x, y));
        if !meters.is_finite() {
            continue;
        }
        let [x, y] = [x as f64, y as f64];
        let ray = ray_in_water(
            &record,
            [
                (x - camera.cx) / camera.focal_px,
                (y - camera.cy) / camera.focal_px,
            ],
        );
        let [u, v, w] = to_camera(&poses[1], to_world(&poses[0], ray.map(|v| v * meters)));
        let [u, v] = image_of(&record, [u / w, v / w]);
        let target = [camera.cx + camera.focal_px * u, camera.cy + camera.focal_px * v];
        assert!(
            near(dx, target[0] - x) && near(dy, target[1] - y),
            "{x} {y}: {dx} {target:?}"
        );
        found += 1;
    }
    assert!(found > 5000, "{found}");
}

/// Distorted coordinates of a direction in water, by Snell's law and the Brown–Conrady model.
fn image_of(lens: &LensRecord, [x, y]: [f64; 2]) -> [f64; 2] {
    let tangent = x.hypot(y);
    let sine = lens.flat_port_n_w.unwrap()[1] * tangent.atan().sin();
    let factor = if tangent > 0.0 {
        sine.asin().tan() / tangent
    } else {
        1.0
    };
    let [x, y] = [x * factor, y * factor];
    let (d, r2) = (&lens.distortion, x * x + y * y);
    let radial = 1.0 + r2 * (d.k1 + r2 * (d.k2 + r2 * d.k3));
    [
        x * radial + 2.0 * d.p1 * x * y + d.p2 * (r2 + 2.0 * x * x),
        y * radial + d.p1 * (r2 + 2.0 * y * y) + 2.0 * d.p2 * x * y,
    ]
}

/// The unit ray of distorted coordinates: the inverse of [`image_of`] by Newton's method with numeric slopes.
fn ray_in_water(lens: &LensRecord, target: [f64; 2]) -> [f64; 3] {
    const STEP: f64 = 1e-6;
    let mut at = target.map(|v| v / 1.34);
    for _ in 0..20 {
        let image = image_of(lens, at);
        let [right, below] =
            [[at[0] + STEP, at[1]], [at[0], at[1] + STEP]].map(|place| image_of(lens, place));
        let [[a, c], [b, d]] = [right, below].map(|side| [0, 1].map(|i| (side[i] - image[i]) / STEP));
        let off = [0, 1].map(|i| image[i] - target[i]);
        let determinant = a * d - b * c;
        at[0] -= (d * off[0] - b * off[1]) / determinant;
        at[1] -= (a * off[1] - c * off[0]) / determinant;
    }
    let length = (at[0] * at[0] + at[1] * at[1] + 1.0).sqrt();
    [at[0] / length, at[1] / length, 1.0 / length]
}

#[test]
fn a_point_is_visible_if_no_surface_is_before_it() {
    let structure = json!({"kind": "procedural", "family": "structure", "seed": 3});
    let job = flow_job(&json!({"path": {"frames": 4}}), &json!({"scene": structure}));
    let (this, next) = (contents(&job, 0), contents(&job, 1));
    let camera = scene(&this).intrinsics;
    let poses = [&this, &next].map(|contents| scene(contents).world_from_camera.unwrap());
    let world = World::filled("structure", 3, None, None).unwrap();
    let solids = world.rays(&CameraPose::from_matrix(&poses[1]).unwrap());
    let (mut counts, mut by_ray, mut by_range) = ([0; 2], 0, 0);
    for (x, y, [dx, dy, visible]) in pixels(linear(&this, "flow")) {
        let target = [x as f32 + dx, y as f32 + dy].map(f32::round);
        let [width, height] = [range(&next).width(), range(&next).height()].map(|side| side as f32);
        let is_inside = target[0] >= 0.0 && target[1] >= 0.0 && target[0] < width && target[1] < height;
        if !is_inside {
            assert_eq!(visible, 0.0, "{x} {y}");
            continue;
        }
        let is_visible = visible == 1.0;
        counts[usize::from(is_visible)] += 1;
        let meters = f64::from(range(&this).pixel(x, y));
        let point = to_world(&poses[0], along(&camera, [x as f64, y as f64], meters));
        let point = to_camera(&poses[1], point);
        let meters = point.iter().map(|v| v * v).sum::<f64>().sqrt();
        let hit = solids.hit([0.0; 3], point.map(|v| v / meters), 0.0, 0.999 * meters);
        by_ray += u32::from(is_visible == hit.is_some());
        // The nearest pixel, whose center is up to 0.7 px away.
        let shown = f64::from(range(&next).pixel(target[0] as usize, target[1] as usize));
        by_range += u32::from(is_visible != ((shown - meters).abs() < EDGE * meters));
    }
    let all = counts[0] + counts[1];
    assert!(counts[0] > 30 && counts[1] > 3000, "{counts:?}");
    assert!(by_ray == 0 && by_range * 20 < all, "{by_ray} {by_range} of {all}");
}

#[test]
fn forward_and_backward_flow_cancel() {
    let path = moved_path(2, [0.3, 0.1, 0.2]);
    let back = json!({"frames": 2, "start": path["end"], "end": path["start"]});
    let forward = contents(&flow_job(&json!({"path": path}), &json!({})), 0);
    let backward = contents(&flow_job(&json!({"path": back}), &json!({})), 0);
    let returned = linear(&backward, "flow");
    let mut offsets = Vec::new();
    for (x, y, [dx, dy, visible]) in pixels(linear(&forward, "flow")) {
        if visible == 1.0 {
            let target = [(x as f32 + dx).round() as usize, (y as f32 + dy).round() as usize];
            let [bx, by, _] = returned.pixel(target[0], target[1]);
            offsets.push((dx + bx).hypot(dy + by));
        }
    }
    offsets.sort_by(f32::total_cmp);
    // The nearest pixel is up to 0.7 px away; the flow changes by a tenth over that distance.
    let quantile = |share: f64| offsets[(share * offsets.len() as f64) as usize];
    assert!(
        offsets.len() > 4000 && quantile(0.5) < 0.1 && quantile(0.95) < 0.5,
        "{} {}",
        quantile(0.5),
        quantile(0.95)
    );
}

#[test]
fn the_next_picture_warped_by_flow_is_this_picture() {
    let scene = json!({"kind": "procedural", "family": "structure", "seed": 3, "lighting": "water"});
    let job = flow_job(&json!({"path": {"frames": 24}}), &json!({"scene": scene}));
    let (this, next) = (contents(&job, 0), contents(&job, 1));
    let (before, after) = (picture(&this, "clean"), picture(&next, "clean"));
    let (mut warped, mut still) = (Vec::new(), Vec::new());
    for (x, y, [dx, dy, visible]) in pixels(linear(&this, "flow")) {
        if visible == 1.0 {
            let target = [(x as f32 + dx), (y as f32 + dy)];
            let own = before.pixel(x, y);
            warped.push(difference(own, bilinear(after, target)));
            still.push(difference(own, after.pixel(x, y).map(f32::from)));
        }
    }
    let mean = |values: &[f32]| values.iter().sum::<f32>() / values.len() as f32;
    // Bilinear interpolation blurs edges and textures.
    assert!(
        warped.len() > 4000 && mean(&warped) < 3.0 && mean(&still) > 2.0 * mean(&warped),
        "{} {} {}",
        warped.len(),
        mean(&warped),
        mean(&still)
    );
}

fn difference(own: [u8; 3], other: [f32; 3]) -> f32 {
    (0..3).map(|i| (f32::from(own[i]) - other[i]).abs()).sum::<f32>() / 3.0
}

fn bilinear(picture: &imaging::Rgb8, [x, y]: [f32; 2]) -> [f32; 3] {
    let [column, row] = [x.max(0.0), y.max(0.0)].map(f32::floor);
    let sample = |i: usize, dx: usize, dy: usize| {
        let [x, y] = [column as usize + dx, row as usize + dy];
        f32::from(picture.pixel(x.min(picture.width() - 1), y.min(picture.height() - 1))[i])
    };
    let (sx, sy) = (x - column, y - row);
    [0, 1, 2].map(|i| {
        let upper = sample(i, 0, 0) * (1.0 - sx) + sample(i, 1, 0) * sx;
        let lower = sample(i, 0, 1) * (1.0 - sx) + sample(i, 1, 1) * sx;
        upper * (1.0 - sy) + lower * sy
    })
}

#[test]
fn the_last_frame_of_a_path_has_no_flow_whatever_the_count() {
    let mut job = flow_job(&json!({"path": {"frames": 2}}), &json!({}));
    let warning = "there is no artifact `flow`: the path has no next frame, or the shutter is rolling";
    let last = contents(&job, 1);
    assert!(
        last.record.warnings.iter().any(|text| text == warning),
        "{:?}",
        last.record.warnings
    );
    assert_eq!(last.artifacts.len(), 3);
    let first = contents(&job, 0);
    job["count"] = json!(1);
    assert_eq!(contents(&job, 0).artifacts.len(), first.artifacts.len());
}

#[test]
fn a_next_frame_with_another_lens_has_its_own_projection() {
    let job = flow_job(
        &json!({"path": {"frames": 3, "start": moved_path(2, [0.0; 3])["start"], "end": moved_path(2, [0.3, 0.0, 0.0])["end"]},
                "hfov_deg": {"uniform": [60, 90]}}),
        &json!({}),
    );
    let (this, next) = (contents(&job, 0), contents(&job, 1));
    let cameras = [&this, &next].map(|contents| scene(contents).intrinsics);
    assert_ne!(cameras[0].focal_px, cameras[1].focal_px);
    let poses = [&this, &next].map(|contents| scene(contents).world_from_camera.unwrap());
    let (x, y) = (10, 70);
    let [dx, dy, _] = linear(&this, "flow").pixel(x, y);
    let point = along(
        &cameras[0],
        [x as f64, y as f64],
        f64::from(range(&this).pixel(x, y)),
    );
    let [u, v, w] = to_camera(&poses[1], to_world(&poses[0], point));
    assert!(near(dx, cameras[1].cx + cameras[1].focal_px * u / w - x as f64));
    assert!(near(dy, cameras[1].cy + cameras[1].focal_px * v / w - y as f64));
}
