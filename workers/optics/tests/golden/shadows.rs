//! A lamp whose light a box cuts off, on a wall and in the water.

use imaging::geometry::Intrinsics;
use imaging::rays::{Hit, Rays};
use imaging::{Plane, Rgb};
use optics::lamp::{self, GlowPhase, Lamp, Lighting, REFERENCE_NODES, Shadow};
use serde_json::Value;

use crate::case::Case;

/// Largest differences as a share of the peak: light on surfaces and airlight in f64.
const SURFACES: f64 = 1e-10;
const GLOW: f64 = 1e-7;
/// The same in f32: rounding, interpolation of discs between pixels, and an edge of a shadow in one of 32 angles.
const SURFACES_F32: f64 = 1e-5;
const READ_F32: f64 = 2e-3;
const GLOW_F32: f64 = 0.02;
/// Share of pixels with an occluder that covers a part of a soft lamp but no rim sample.
const RIM: f64 = 0.02;
/// Share of pixels with a ray that may graze an edge.
const GRAZING: f64 = 0.005;

/// Boxes along the axes, by their lowest and highest corners, before a wall at a depth.
struct Boxes {
    boxes: Vec<[[f64; 3]; 2]>,
    wall_z: f64,
}

impl Rays for Boxes {
    fn hit(&self, origin: [f64; 3], direction: [f64; 3], from: f64, to: f64) -> Option<Hit> {
        let wall = (self.wall_z - origin[2]) / direction[2];
        let wall = (wall >= from && wall <= to).then_some(Hit {
            distance: wall,
            normal: [0.0, 0.0, -direction[2].signum()],
            object: 0,
        });
        let boxes = self.boxes.iter().enumerate().filter_map(|(index, [low, high])| {
            let (mut enter, mut leave, mut axis) = (f64::NEG_INFINITY, f64::INFINITY, 0);
            for i in 0..3 {
                let [a, b] = [low[i], high[i]].map(|side| (side - origin[i]) / direction[i]);
                if a.min(b) > enter {
                    (enter, axis) = (a.min(b), i);
                }
                leave = leave.min(a.max(b));
            }
            let mut normal = [0.0; 3];
            normal[axis] = -direction[axis].signum();
            (enter <= leave && enter >= from && enter <= to).then_some(Hit {
                distance: enter,
                normal,
                object: index as u32 + 1,
            })
        });
        boxes.chain(wall).min_by(|a, b| a.distance.total_cmp(&b.distance))
    }
}

fn triple(value: &Value) -> [f64; 3] {
    [0, 1, 2].map(|i| value[i].as_f64().expect("a number"))
}

/// Compares all pixels except those with a ray that grazes an edge.
fn compare(case: &Case, name: &str, actual: &Rgb<f64>, tolerance: f64, grazing: f64) {
    let expected = case.needed(name).rgb(|v| v);
    let peak = expected
        .planes()
        .iter()
        .flat_map(|plane| plane.data())
        .copied()
        .fold(0.0, f64::max);
    let (width, height) = actual.size();
    let error = |x: usize, y: usize| {
        let (a, b) = (actual.pixel(x, y), expected.pixel(x, y));
        (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max)
    };
    let errors: Vec<f64> = (0..height)
        .flat_map(|y| (0..width).map(move |x| error(x, y)))
        .collect();
    let wrong = errors
        .iter()
        .filter(|&&error| error.is_nan() || error > tolerance * peak)
        .count();
    let worst = errors.iter().copied().fold(0.0, f64::max);
    println!("   {name}: {worst:.2e} of {peak:.2e}, {wrong} pixels");
    assert!(
        wrong as f64 <= grazing * errors.len() as f64,
        "{name}: {wrong} pixels differ by up to {worst:e} of {peak:e}"
    );
}

struct Scene {
    boxes: Boxes,
    range: Plane<f64>,
    normals: [Plane<f32>; 3],
    lighting: Lighting,
    lamp: Lamp,
    /// The same as seen from a point of the surfaces, which were stored as if moved off themselves; all face the camera.
    moved_lamp: Lamp,
    soft: Shadow,
}

impl Scene {
    fn read(case: &Case) -> Self {
        let range = case.range();
        let lamp = case.get("lamp").expect("a lamp");
        let [x, y, z] = triple(&lamp["position_m"]);
        let spot = |place| {
            let (intensity, direction) = (triple(&lamp["intensity"]), triple(&lamp["direction"]));
            let cone_deg = lamp["cone_deg"].as_f64().expect("a cone");
            Lamp::spot(place, intensity, direction, cone_deg).expect("a lamp within its limits")
        };
        let boxes = case.get("boxes").and_then(Value::as_array).expect("boxes");
        let (absorption, scattering) = (case.triple("absorption"), case.triple("scattering"));
        let (absorption, scattering) = (absorption.expect("a"), scattering.expect("b"));
        let number = |key: &str| case.number(key).expect("a number");
        Self {
            boxes: Boxes {
                boxes: boxes.iter().map(|b| [triple(&b[0]), triple(&b[1])]).collect(),
                wall_z: number("wall_z"),
            },
            normals: case.needed("normals").rgb(|v| v as f32).into_planes(),
            lighting: Lighting {
                lamps: Vec::new(),
                radius_m: number("min_radius_m"),
                camera: Intrinsics::centered(number("focal_px"), range.width(), range.height()),
                attenuation: [0, 1, 2].map(|i| absorption[i] + scattering[i]),
                scattering,
                absorption: Some(absorption),
                phase: GlowPhase::henyey_greenstein(number("hg_g")),
                patches: None,
            },
            range,
            lamp: spot([x, y, z]),
            moved_lamp: spot([x, y, z + number("surface_offset_m")]),
            soft: Shadow::Soft {
                radius_m: number("soft_radius_m"),
                samples: number("soft_samples") as usize,
            },
        }
    }

    fn lighting(&self, lamp: Lamp, shadow: Shadow, multiple: bool) -> Lighting {
        Lighting {
            lamps: vec![lamp.with_shadow(shadow, true)],
            absorption: self.lighting.absorption.filter(|_| multiple),
            ..self.lighting.clone()
        }
    }
}

pub(crate) fn lamp(case: &Case) {
    let scene = Scene::read(case);
    let surfaces = |shadow, multiple| {
        let lighting = scene.lighting(scene.moved_lamp, shadow, multiple);
        lamp::shaded_irradiance_reference(&scene.range, &scene.normals, &lighting, &scene.boxes)
    };
    compare(
        case,
        "irradiance_hard",
        &surfaces(Shadow::Hard, false),
        SURFACES,
        GRAZING,
    );
    compare(
        case,
        "irradiance_soft",
        &surfaces(scene.soft, false),
        SURFACES,
        GRAZING,
    );
    compare(
        case,
        "irradiance_multiple",
        &surfaces(Shadow::Hard, true),
        SURFACES,
        GRAZING,
    );
    let glow = |multiple| {
        let lighting = scene.lighting(scene.lamp, Shadow::Hard, multiple);
        lamp::shaded_airlight_reference(&scene.range, &lighting, REFERENCE_NODES, &scene.boxes)
    };
    compare(case, "glow_shadowed", &glow(false), GLOW, 0.0);
    compare(case, "glow_multiple", &glow(true), GLOW, 0.0);
    fast(case, &scene);
}

/// The same in f32.
fn fast(case: &Case, scene: &Scene) {
    let range = scene.range.map(|&z| z as f32);
    let surfaces = |shadow, multiple| {
        let lighting = scene.lighting(scene.moved_lamp, shadow, multiple);
        let light = lamp::shaded_irradiance(&range, &scene.normals, &lighting, (&scene.boxes, 0.0)).light;
        light.map(|&e| f64::from(e))
    };
    let surface = |name, shadow, multiple, (tolerance, grazing)| {
        compare(case, name, &surfaces(shadow, multiple), tolerance, grazing);
    };
    surface("irradiance_hard", Shadow::Hard, false, (SURFACES_F32, GRAZING));
    surface("irradiance_soft", scene.soft, false, (SURFACES_F32, RIM));
    surface("irradiance_multiple", Shadow::Hard, true, (READ_F32, GRAZING));
    for (name, multiple) in [("glow_shadowed", false), ("glow_multiple", true)] {
        let lighting = scene.lighting(scene.lamp, Shadow::Hard, multiple);
        let light = lamp::shaded_airlight(&range, &lighting, 1e-6, &scene.boxes).light;
        compare(case, name, &light.map(|&v| f64::from(v)), GLOW_F32, GRAZING);
    }
}
