//! Daylight: surfaces and caustics against the case, and radiance by direction against Monte Carlo.

use imaging::Plane;
use imaging::geometry::Intrinsics;
use optics::daylight::{
    Blur, Caustics, Daylight, DaylightModel, Field, Gaze, RAYS_PER_CELL, REFRACTIVE_INDEX, Reaching,
    Refraction, SLOPES, Sun, SurfaceLight, Tiles, Waves, caustics, caustics_reference, share_by_slope,
    slices, surfaces_reference, tile_reference,
};
use optics::legendre::gauss_legendre;
use optics::medium::Medium;
use optics::water::Water;
use serde_json::Value;
use spec::{Optics, PhaseFunction, ScatterModel};

use crate::case::Case;

/// Surfaces in f64.
const REFERENCE: f64 = 1e-10;
/// Surfaces in f32, as a share of the brightest.
const FLOAT: f64 = 1e-5;
/// Nodes of the case's table by slope.
const COSINES: usize = 32;
/// A caustic tile in f64, and in f32 as a share of its peak.
const TILE: f64 = 1e-8;
const FAST_TILE: f64 = 2e-3;
/// Radiance by direction over that of Monte Carlo.
const BY_DIRECTION: (f64, f64) = (0.85, 1.15);

fn number(case: &Case, key: &str) -> f64 {
    case.number(key).unwrap_or_else(|| panic!("`{key}` is missing"))
}

fn medium(case: &Case) -> Medium {
    let triple = |key: &str| Some(case.triple(key).unwrap_or_else(|| panic!("`{key}` is missing")));
    Medium {
        depth_m: Some(number(case, "depth_m")),
        daylight: Some(DaylightModel::default()),
        airlight_phase: PhaseFunction::Ff,
        ..Medium::from(Optics {
            absorption_per_m: triple("absorption"),
            scattering_per_m: triple("scattering"),
            diffuse_attenuation_per_m: triple("K_d"),
            backscatter_fraction: Some(number(case, "backscatter_fraction")),
            forward_scatter: Some(ScatterModel::None.into()),
            ..Optics::default()
        })
    }
}

fn gaze(case: &Case, size: (usize, usize)) -> Gaze {
    let camera = Intrinsics::centered(number(case, "focal_px"), size.0, size.1);
    Gaze::new(camera, size, case.triple("up").expect("up"))
}

pub(crate) fn from_above(case: &Case) {
    surfaces(case, &case.range());
}

/// The light of a channel as the case has it: radiance `exp(p μ + q μ²)` around, sunlight that decays by a + 0.05 b.
fn field(case: &Case, own: &Field, channel: usize) -> Field {
    let shapes = case.get("field").and_then(Value::as_array).expect("a list");
    let [p, q] = ["p", "q"].map(|name| {
        shapes[channel]
            .get(name)
            .and_then(Value::as_f64)
            .expect("a number")
    });
    let part = |name: &str| case.triple(name).expect("a triple")[channel];
    let rule: Vec<[f64; 2]> = gauss_legendre(COSINES)
        .into_iter()
        .map(|(rise, weight)| [rise, weight])
        .collect();
    let radiance: Vec<f64> = rule
        .iter()
        .map(|[rise, _]| (rise * (p + q * rise)).exp())
        .collect();
    let mut field = *own;
    field.attenuation = part("absorption") + 0.05 * part("scattering");
    field.slopes = share_by_slope(&rule, &radiance);
    field
}

/// Surfaces under an even sky and with the sun, against the case: without rays and caustics.
fn surfaces(case: &Case, range: &Plane<f64>) {
    let lit = DaylightModel {
        surfaces: SurfaceLight::Normal,
        ..DaylightModel::default()
    };
    let sunny = DaylightModel {
        sun_share: case
            .get("sun")
            .map_or(0.0, |sun| sun["share"].as_f64().expect("a share")),
        sun: sun(case),
        caustics: Some(waves(case)),
        ..lit
    };
    let resolve = |above: DaylightModel| {
        let medium = Medium {
            daylight: Some(above),
            ..medium(case)
        };
        Water::resolve(&medium, number(case, "focal_px"))
            .unwrap_or_else(|errors| panic!("{errors:?}"))
            .seen_by(gaze(case, range.size()))
    };
    let albedo = case.needed("albedo").rgb(|v| v);
    let normals = case.needed("normals").rgb(|v| v).into_planes();
    let (width, height) = range.size();
    let factor = case.needed("caustic_factor").values;
    let factor = Plane::new(width, height, factor.iter().map(|&v| v as f32).collect())
        .expect("a factor for each pixel");
    let tables = case.needed("D_table");
    for (above, name) in [(lit, "surfaces_overcast"), (sunny, "surfaces_sun")] {
        let water = resolve(above);
        let own = water.daylight().expect("asked for");
        let daylight = &own.with_fields([0, 1, 2].map(|c| field(case, &own.fields()[c], c)));
        for (c, field) in daylight.fields().iter().enumerate() {
            for (k, share) in field.slopes.iter().enumerate() {
                let expected = tables.values[if tables.shape[0] == 3 {
                    c * SLOPES + k
                } else {
                    k * 3 + c
                }];
                assert!(
                    (share - expected).abs() < REFERENCE,
                    "D of {c} at {k}: {share} for {expected}"
                );
            }
        }
        let is_sunny = daylight.sun().is_some();
        if let Some((waves, blur)) = daylight.waves(seed(case), 0) {
            let time_s = case.get("caustics").and_then(|waves| waves["time_s"].as_f64());
            let time_s = time_s.expect("a time");
            patterns(case, range, daylight, &Waves { time_s, ..waves }, &blur);
        }
        let reaching = Reaching {
            sunlight: is_sunny.then_some(&factor),
            access: None,
        };
        let exact = surfaces_reference(&albedo, range, &normals, daylight, reaching);
        // The factor comes in f32.
        let within = if is_sunny { 2e-7 } else { REFERENCE };
        case.compare(name, &exact, within, "the reference");
        let fast = optics::daylight::surfaces(
            &albedo.map(|&v| v as f32),
            &range.map(|&z| z as f32),
            &normals.each_ref().map(|axis| axis.map(|&v| v as f32)),
            daylight,
            reaching,
        );
        let peak = case.needed(name).values.iter().copied().fold(0.0, f64::max);
        case.compare(name, &fast, FLOAT * peak, "the fast form");
    }
}

/// The tiles of the case and the pattern on its surfaces, in both forms.
fn patterns(case: &Case, range: &Plane<f64>, daylight: &Daylight, waves: &Waves, blur: &Blur) {
    let depths = case.numbers("tile_depths_m");
    let expected = case.needed("caustic_tiles");
    let cells = waves.cells;
    let own = Tiles::new(waves, blur, depths.clone());
    for (slice, &depth) in depths.iter().enumerate() {
        let exact = tile_reference(waves, blur, depth, RAYS_PER_CELL, Refraction::Small);
        let stored = &expected.values[slice * cells * cells..(slice + 1) * cells * cells];
        let peak = stored.iter().copied().fold(0.0, f64::max);
        let apart = |of: &dyn Fn(usize, usize) -> f64| {
            let each = (0..cells * cells).map(|i| (of(i % cells, i / cells) - stored[i]).abs());
            each.fold(0.0, f64::max)
        };
        let by_reference = apart(&|x, y| exact.pixel(x, y));
        let by_fast = apart(&|x, y| f64::from(own.cell(slice, x, y))) / peak;
        println!("   tile at {depth} m: {by_reference:.1e} in f64, {by_fast:.1e} of the peak in f32");
        assert!(
            by_reference < TILE && by_fast < FAST_TILE,
            "{depth} m: {by_reference:e} {by_fast:e}"
        );
    }
    let single = range.map(|&z| z as f32);
    let (shallowest, deepest) = daylight.depths_m(&single).expect("surfaces");
    let depths = slices(shallowest, deepest);
    let tiles: Vec<Plane<f64>> = depths
        .iter()
        .map(|&depth| tile_reference(waves, blur, depth, RAYS_PER_CELL, Refraction::Small))
        .collect();
    let exact = caustics_reference(range, daylight, waves, (&tiles, &depths));
    let mut fast = Plane::filled(range.width(), range.height(), 1.0f32);
    let sun = daylight.sun().expect("a sun");
    let own = Tiles::new(waves, blur, depths);
    caustics(&single, daylight, sun, &own, &mut fast);
    let stored = case.needed("caustic_factor").values;
    for (i, stored) in stored.iter().enumerate() {
        let (exact, fast) = (exact.data()[i], f64::from(fast.data()[i]));
        let is_hole = !range.data()[i].is_finite();
        // The depths are computed from ranges in f32.
        assert!((exact - stored).abs() < 1e-6, "pixel {i}: {exact} for {stored}");
        assert!(
            is_hole || (fast - stored).abs() < FAST_TILE * own.peak(),
            "pixel {i}: {fast} for {stored}"
        );
    }
}

fn waves(case: &Case) -> Caustics {
    let waves = case.get("caustics").expect("caustics");
    let number = |name: &str| waves[name].as_f64().expect("a number");
    Caustics {
        tile_m: number("tile_m"),
        cells: number("cells") as usize,
        slope: number("slope"),
        wind_deg: number("wind").to_degrees(),
        fps: None,
    }
}

fn seed(case: &Case) -> u64 {
    case.get("caustics")
        .and_then(|waves| waves["seed"].as_u64())
        .expect("a seed")
}

fn sun(case: &Case) -> Sun {
    let angle = |name: &str| {
        case.get("sun")
            .and_then(|sun| sun[name].as_f64())
            .expect("an angle")
    };
    Sun {
        elevation_deg: angle("elevation_deg"),
        azimuth_deg: angle("azimuth_deg"),
        ..Sun::default()
    }
}

/// Radiance in some directions under an even sky. All directional light of these cases comes from a, b and b_b/b.
pub(crate) fn by_direction(case: &Case) {
    let (a, b) = (number(case, "absorption"), number(case, "scattering"));
    let depth = number(case, "depth_m");
    let medium = Medium {
        depth_m: Some(depth),
        daylight: Some(DaylightModel::default()),
        airlight_phase: PhaseFunction::Ff,
        ..Medium::from(Optics {
            absorption_per_m: Some([a; 3]),
            scattering_per_m: Some([b; 3]),
            backscatter_fraction: Some(number(case, "backscatter_fraction")),
            ..Optics::default()
        })
    };
    let water = Water::resolve(&medium, 100.0).unwrap_or_else(|errors| panic!("{errors:?}"));
    let daylight = water.daylight().expect("asked for");
    // The sky of the case has the radiance 1 within the cone.
    let at_surface = std::f64::consts::PI / (REFRACTIVE_INDEX * REFRACTIVE_INDEX);
    let irradiance = at_surface * (-daylight.fields()[0].decay * depth).exp();
    let veil = daylight.veil_of(0);
    let rises = case.needed("mu").values;
    let truths = case.needed("radiance").values;
    let errors = case.needed("standard_error").values;
    for ((rise, truth), error) in rises.iter().zip(truths).zip(errors) {
        let white = veil.at([0.0, 0.0, 1.0], *rise, None) / std::f64::consts::PI;
        let model = irradiance * white / daylight.level()[0];
        println!("   at {rise:.3}: {:.3} of the truth", model / truth);
        let (least, most) = BY_DIRECTION;
        assert!(
            model + 4.0 * error >= least * truth && model - 4.0 * error <= most * truth,
            "at {rise}: {model} for {truth} +- {error}"
        );
    }
}
