//! Random frames with lamps, patches of turbidity and snow. Lamps stand where light and its rounding are worst: from a millimeter
//! to a kilometer off a surface, their cone just past it, as faint and as bright as a description may say.

use imaging::codec::{encode_npy_plane, encode_npy_rgb};
use imaging::geometry::Intrinsics;
use imaging::random::Stream;
use optics::snow;
use renderer::SceneBytes;
use spec::{Ambient, Light, PointLamp, RangeFile, RangeKind, Snow, SpotLamp, Turbidity};

use super::cases::tolerance;
use super::random_water::RandomWater;
use super::scene::RandomScene;

/// A frame of an uploaded scene.
pub(super) struct Mixture {
    /// What is in the water, and the scene.
    pub(super) about: String,
    /// The scene with its camera.
    pub(super) scene: SceneBytes,
    /// Water, patches and snow.
    pub(super) water: spec::Water,
    /// Lamps.
    pub(super) lights: Vec<Light>,
    /// The error that is allowed.
    pub(super) tolerance: f64,
}

/// Longest side in patches, where the reference takes one transform for each pixel, and elsewhere.
const LONGEST_PX: [usize; 2] = [20, 48];
/// Most particles in view, for the time that the reference takes.
const MOST_PARTICLES: f64 = 3000.0;
/// Most lamps.
const MOST_LAMPS: f64 = 3.0;

/// Addresses of the random numbers of a mixture, apart from those of water and scene.
const OWN: u64 = 1 << 20;
const OF_A_LAMP: u64 = 1 << 21;

impl Mixture {
    /// The mixture of a seed.
    pub(super) fn draw(seed: u64) -> Self {
        let stream = Stream::stage(seed, "mixture");
        let unit = |what: u64| stream.unit(u64::MAX, what);
        let own = |what: u64| unit(OWN + what);
        let (is_patchy, is_snowy) = (own(0) < 0.5, own(1) < 0.5);
        let is_lit = own(2) < 0.6 || !(is_patchy || is_snowy);
        let scene = RandomScene::draw(&stream, LONGEST_PX[usize::from(!is_patchy)]);
        let drawn = RandomWater::draw(&unit);
        let (width, height) = scene.range.size();
        let camera = Intrinsics::centered(drawn.focal_px, width, height);
        let mut water = drawn.request;
        if own(3) < 0.4 && drawn.water.preset().is_some() {
            water.depth_m = Some(60.0 * own(4).powi(2));
            water.ambient = if own(5) < 0.5 {
                Ambient::Absolute
            } else {
                Ambient::Exposed
            };
        }
        water.turbidity = is_patchy.then(|| Turbidity {
            contrast: 0.05 + 0.9 * own(6),
            scale_m: 0.1 * 1000f64.powf(own(7)),
        });
        water.snow = is_snowy.then(|| falling(|what| own(16 + what), snow::solid(&camera, (width, height))));
        let lamps = if is_lit {
            (1.0 + MOST_LAMPS * own(8)) as u64
        } else {
            0
        };
        let lights = (0..lamps).map(|lamp| {
            let draw = |what: u64| unit(OF_A_LAMP + 32 * lamp + what);
            random_lamp(draw, &scene, &camera)
        });
        let held = [(is_lit, "lamps"), (is_patchy, "patches"), (is_snowy, "snow")];
        let held: Vec<&str> = held
            .into_iter()
            .filter(|held| held.0)
            .map(|held| held.1)
            .collect();
        Self {
            about: format!("mixture, {}, {}, {}", held.join(" and "), drawn.name, scene.about),
            lights: lights.collect(),
            scene: SceneBytes {
                rgb: encode_npy_rgb(&scene.radiance),
                range: Some(RangeFile {
                    file: encode_npy_plane(&scene.range),
                    kind: RangeKind::Range,
                    unit_m: None,
                    invalid_code: None,
                }),
                instances: None,
                classes: None,
                world_from_camera: None,
                intrinsics: Some(camera),
            },
            water,
            tolerance: tolerance(own(9)),
        }
    }
}

/// Snow from a few particles to as many as are allowed.
fn falling(unit: impl Fn(u64) -> f64, solid: f64) -> Snow {
    let near_m = 0.05 * 40f64.powf(unit(0));
    let mut law = Snow {
        density_per_m3: 1.0,
        near_m,
        far_m: (near_m * (1.1 + 20.0 * unit(1))).min(100.0),
        radius_m: 1e-5 * 2000f64.powf(unit(2)),
        radius_spread: unit(3),
        albedo: [unit(4), unit(5), unit(6)],
        ..Snow::of(0.0)
    };
    let most = MOST_PARTICLES / snow::expected(&law, solid);
    let most = most.min(snow::MOST_COVER / snow::cover(&law, 0.0)).min(1e6);
    law.density_per_m3 = 0.999 * most * 1e-4f64.powf(unit(7));
    law
}

/// A lamp near the surface that a random pixel shows.
fn random_lamp(draw: impl Fn(u64) -> f64, scene: &RandomScene, camera: &Intrinsics) -> Light {
    let (width, height) = scene.range.size();
    let (x, y) = (
        ((draw(0) * width as f64) as usize).min(width - 1),
        ((draw(1) * height as f64) as usize).min(height - 1),
    );
    let seen_m = f64::from(scene.range.pixel(x, y));
    let range_m = if seen_m.is_finite() && seen_m > 0.0 {
        seen_m
    } else {
        1.0
    };
    let ray = [
        (x as f64 - camera.cx) / camera.focal_px,
        (y as f64 - camera.cy) / camera.focal_px,
        1.0,
    ];
    let length = ray.iter().map(|v| v * v).sum::<f64>().sqrt();
    let surface = ray.map(|v| v / length * range_m);
    let away_m = 1e-3 * 1e6f64.powf(draw(2));
    let position_m = [0, 1, 2]
        .map(|axis| (surface[axis] + (2.0 * draw(3 + axis as u64) - 1.0) * away_m).clamp(-999.0, 999.0));
    let intensity = [0.5, 1.0, 0.7].map(|tint| tint * 1e-3 * 1e8f64.powf(draw(6)));
    let point = Light::Point(PointLamp {
        position_m,
        intensity,
        ..PointLamp::default()
    });
    if draw(7) < 0.5 {
        return point;
    }
    let cone_deg = 0.5 * 180f64.powf(draw(8));
    // Turned from the surface by about the angle of the cone.
    let (sin, cos) = (cone_deg.to_radians() * (0.8 + 0.4 * draw(9))).sin_cos();
    let [dx, dy, dz] = [0, 1, 2].map(|axis| surface[axis] - position_m[axis]);
    let direction = [dx * cos - dz * sin, dy, dx * sin + dz * cos];
    let longest = direction.iter().fold(0.0f64, |most, v| most.max(v.abs()));
    if longest < 1e-6 {
        return point;
    }
    Light::Spot(SpotLamp {
        position_m,
        intensity,
        direction: direction.map(|v| v / longest),
        cone_deg,
        ..SpotLamp::default()
    })
}
