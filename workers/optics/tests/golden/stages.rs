//! Comparisons of each stage.

use imaging::Rgb;
use imaging::geometry::Intrinsics;
use optics::chain::{self, ChainError, Layers};
use optics::forward_scatter::{KernelCache, MAX_REFERENCE_PIXELS};
use optics::kernel::{Transfer, pixel};
use optics::lamp::{self, GlowPhase, LAMP_RADIUS_M, Lamp, Lighting, REFERENCE_NODES};
use optics::medium::{Ambient, Medium};
use optics::plan::{Plan, SceneBounds};
use optics::water::Water;
use optics::{haze as lay_haze, style_blend};
use serde_json::Value;
use spec::{
    Fidelity, ForwardScatter, Haze, HazeBlend, HazeSpace, HoleRule, Optics, ScatterModel, ScatterSource,
};

use crate::case::Case;

/// f64 against f64: rounding alone.
const REFERENCE: f64 = 1e-12;
/// Transfer functions are fitted to 1e-8; that error affects many coefficients of the light of a frame.
const REFERENCE_SCATTER: f64 = 1e-7;
/// f32 arithmetic on light up to 1.
const FLOAT: f64 = 2e-6;
/// The error of sixteen kernels is only the floor of f32.
const SIXTEEN_TERMS: f64 = 1e-6;
/// A tolerance that guarantees one 8-bit code at the steep foot of the sRGB curve.
const ONE_CODE: f64 = 3e-4;
const LOOSE: f64 = 4e-3;
const TIGHT: f64 = 1e-5;
const KERNEL: f64 = 1e-7;
/// Transfer functions stored in f64 are fitted to 1e-8.
const OTF: f64 = 1e-8;
/// Share of 8-bit codes that may differ by one: rounding alone, and rounding after a tolerance of [`ONE_CODE`].
const CODES_EXACT: f64 = 1e-3;
const CODES_SCATTER: f64 = 1e-2;
/// Light of lamps, as a share of the frame's peak: accuracy of the vectors, and tolerance of the fast form.
const LAMPS: f64 = 1e-5;
const LAMPS_ASKED: f64 = 5e-6;

fn water(case: &Case) -> Water {
    let stage = case.text("stage");
    let spreads = case.get("G_per_m").is_some() || stage == "jaffe";
    let model = match stage.as_str() {
        "simplified" => ScatterModel::Simplified,
        "jaffe" | "chain" if spreads => ScatterModel::Jaffe,
        _ => ScatterModel::None,
    };
    case.expect_text("border", &["mirror"]);
    case.expect_text(
        "interpretation",
        &[if model == ScatterModel::Simplified {
            "gather"
        } else {
            "scatter"
        }],
    );
    case.expect_text("scatter_source", &["radiance", "direct"]);
    case.expect_text("hole_range", &["largest valid range in the frame"]);
    let direct = case.text("scatter_source") == "direct";
    let request = Medium {
        depth_m: case.number("depth_m"),
        ambient: if case.get("kd_per_m").is_some() {
            Ambient::Absolute
        } else {
            Ambient::None
        },
        holes: hole_rule(&case.text("hole_rule")),
        ..Optics {
            beam_attenuation_per_m: case.triple("attenuation_per_m"),
            backscatter_attenuation_per_m: case.triple("backscatter_per_m"),
            diffuse_attenuation_per_m: case.triple("kd_per_m"),
            veiling_light: case
                .triple("background")
                .or(case.triple("background_surface"))
                .or(Some([0.0; 3])),
            forward_scatter: Some(ForwardScatter {
                spread_px_per_m: Some(case.triple("spread_px_per_m").unwrap_or([0.0; 3])),
                spread_offset_px: case.triple("spread_offset_px"),
                source: if direct {
                    ScatterSource::Direct
                } else {
                    ScatterSource::Radiance
                },
                g_per_m: case.triple("G_per_m"),
                ..model.into()
            }),
            ..Optics::default()
        }
        .into()
    };
    Water::resolve(&request, 1.0).unwrap_or_else(|errors| panic!("{errors:?}"))
}

/// `range=<m>` replaces holes; any other text describes the default.
fn hole_rule(text: &str) -> HoleRule {
    match text.strip_prefix("range=") {
        Some(meters) => HoleRule::RangeM(meters.parse().expect("meters")),
        None => HoleRule::Background,
    }
}

/// `None` for a frame too large for the reference.
fn exact(case: &Case) -> Option<Layers<f64>> {
    match chain::water_reference(&case.radiance(), &case.range(), &water(case)) {
        Ok(layers) => Some(layers),
        Err(ChainError::ReferenceTooLarge { .. }) => None,
        Err(error) => panic!("{error}"),
    }
}

fn layers(case: &Case, fidelity: Fidelity) -> Layers {
    let (radiance, range, water) = (
        case.radiance().map(|&j| j as f32),
        case.range().map(|&z| z as f32),
        water(case),
    );
    let stats = SceneBounds::measure(&radiance, &range, &water);
    let plan = Plan::for_water(&stats, &water, fidelity);
    chain::water(&radiance, &range, &water, &plan, &mut KernelCache::new())
        .unwrap_or_else(|error| panic!("{error}"))
}

pub(crate) fn attenuation(case: &Case) {
    let reference = exact(case).expect("attenuation has no largest frame");
    case.compare("output_linear", &reference.scattered, REFERENCE, "reference");
    case.compare_codes(
        "output_srgb",
        &reference.scattered.map(|&v| v as f32),
        CODES_EXACT,
        "reference",
    );
    let fast = layers(case, Fidelity::Tolerance(ONE_CODE));
    case.compare("output_linear", &fast.scattered, FLOAT, "f32");
    case.compare_codes("output_srgb", &fast.scattered, CODES_EXACT, "f32");
}

pub(crate) fn scatter(case: &Case) {
    if let Some(reference) = exact(case) {
        case.compare("direct", &reference.direct, REFERENCE, "reference");
        case.compare("backscatter", &reference.backscatter, REFERENCE, "reference");
        case.compare("attenuated", &attenuated(&reference), REFERENCE, "reference");
        case.compare(
            "forward",
            &reference.forward_scatter,
            REFERENCE_SCATTER,
            "reference",
        );
        case.compare(
            "output_linear",
            &reference.scattered,
            REFERENCE_SCATTER,
            "reference",
        );
        case.compare_codes(
            "output_srgb",
            &reference.scattered.map(|&v| v as f32),
            CODES_EXACT,
            "reference",
        );
    }
    let variants = [
        (
            Fidelity::Terms(16),
            SIXTEEN_TERMS,
            Some(CODES_SCATTER),
            "16 terms",
        ),
        (
            Fidelity::Tolerance(TIGHT),
            TIGHT + FLOAT,
            Some(CODES_SCATTER),
            "tolerance 1e-5",
        ),
        (
            Fidelity::Tolerance(ONE_CODE),
            ONE_CODE + FLOAT,
            Some(CODES_SCATTER),
            "tolerance 3e-4",
        ),
        (Fidelity::Tolerance(LOOSE), LOOSE + FLOAT, None, "tolerance 4e-3"),
    ];
    for (fidelity, tolerance, codes, what) in variants {
        let layers = layers(case, fidelity);
        case.compare("direct", &layers.direct, FLOAT, what);
        case.compare("backscatter", &layers.backscatter, FLOAT, what);
        case.compare("attenuated", &attenuated(&layers), FLOAT, what);
        case.compare("forward", &layers.forward_scatter, tolerance, what);
        case.compare("output_linear", &layers.scattered, tolerance, what);
        if let Some(share) = codes {
            case.compare_codes("output_srgb", &layers.scattered, share, what);
        }
    }
}

/// D + B.
fn attenuated<T: Copy + std::ops::Add<Output = T>>(layers: &Layers<T>) -> Rgb<T> {
    let (direct, veil) = (&layers.direct, &layers.backscatter);
    Rgb::from_fn(direct.width(), direct.height(), |x, y| {
        let (d, b) = (direct.pixel(x, y), veil.pixel(x, y));
        [d[0] + b[0], d[1] + b[1], d[2] + b[2]]
    })
}

fn lights(case: &Case) -> Vec<Haze> {
    let list = case
        .get("lights")
        .and_then(Value::as_array)
        .cloned()
        .unwrap_or_default();
    let light = |light: &Value| {
        for key in light.as_object().expect("an object").keys() {
            let known = ["position", "size", "intensity", "color", "blend"];
            assert!(
                known.contains(&key.as_str()),
                "light parameter `{key}` is not known"
            );
        }
        let number = |value: &Value| value.as_f64().expect("a number");
        Haze {
            x: number(&light["position"][0]),
            y: number(&light["position"][1]),
            size: number(&light["size"]),
            intensity: number(&light["intensity"]),
            color: [0, 1, 2].map(|c| number(&light["color"][c])),
            blend: match light["blend"].as_str() {
                None | Some("over") => HazeBlend::Over,
                Some("add") => HazeBlend::Add,
                Some(other) => panic!("blend `{other}` is not known"),
            },
            space: haze_space(case),
        }
    };
    list.iter().map(light).collect()
}

fn haze_space(case: &Case) -> HazeSpace {
    match case.text("haze_space").as_str() {
        "" | "linear" => HazeSpace::Linear,
        "display" => HazeSpace::Display,
        other => panic!("haze space `{other}` is not known"),
    }
}

pub(crate) fn haze(case: &Case) {
    let (lights, radiance) = (lights(case), case.radiance().map(|&j| j as f32));
    let hazed = lay_haze(radiance.clone(), &lights);
    case.compare("output_linear", &hazed, FLOAT, "haze");
    case.compare_codes("output_srgb", &hazed, CODES_EXACT, "haze");
    let in_display_space = |light: Haze| Haze {
        space: HazeSpace::Display,
        ..light
    };
    let lights: Vec<_> = lights.into_iter().map(in_display_space).collect();
    let display = lay_haze(radiance, &lights);
    case.compare("output_display_space", &display, FLOAT, "haze");
}

pub(crate) fn chain(case: &Case) {
    case.expect_text("blend_space", &["srgb-encoded"]);
    let alpha = case.number("alpha").unwrap_or(1.0);
    let variants = [
        (Fidelity::Reference, FLOAT, CODES_EXACT, "reference"),
        (Fidelity::Terms(16), FLOAT, CODES_SCATTER, "16 terms"),
        (
            Fidelity::Tolerance(ONE_CODE),
            ONE_CODE + FLOAT,
            CODES_SCATTER,
            "tolerance 3e-4",
        ),
    ];
    for (fidelity, tolerance, share, what) in variants {
        // A scene without range stays in air.
        let in_water = match case.array("range_m") {
            Some(range) if fidelity == Fidelity::Reference && range.values.len() > MAX_REFERENCE_PIXELS => {
                continue;
            }
            Some(_) => layers(case, fidelity).scattered,
            None => case.radiance().map(|&j| j as f32),
        };
        case.compare("after_water", &in_water, tolerance, what);
        let blended = match case.array("model_srgb") {
            Some(model) => {
                let top_code = model.top_code.unwrap_or(1.0);
                style_blend(&in_water, &model.rgb(|v| (v / top_code) as f32), alpha)
            }
            None => in_water,
        };
        case.compare("after_blend", &blended, tolerance, what);
        let hazed = lay_haze(blended, &lights(case));
        case.compare("output_linear", &hazed, tolerance, what);
        case.compare_codes("output_srgb", &hazed, share, what);
    }
}

pub(crate) fn kernel(case: &Case) {
    let gammas: Vec<f64> = case
        .get("gamma_px")
        .and_then(Value::as_array)
        .expect("scales")
        .iter()
        .filter_map(Value::as_f64)
        .collect();
    let table = case.needed("kernel");
    let (rows, columns) = (table.shape[1], table.shape[2]);
    for (n, &gamma) in gammas.iter().enumerate() {
        for j in 0..rows {
            for i in 0..columns {
                let expected = table.values[(n * rows + j) * columns + i];
                let error = (pixel(i as i64, j as i64, gamma) - expected).abs();
                assert!(error <= KERNEL, "kernel γ = {gamma} at ({i}, {j}): {error:e}");
            }
        }
    }
    let (Some(otf), Some(frequencies)) = (case.array("otf"), case.array("freq")) else {
        return;
    };
    let tolerance = case.number("otf_tolerance").unwrap_or(OTF);
    let count = frequencies.values.len();
    for (n, &gamma) in gammas.iter().enumerate() {
        let transfer = Transfer::new(gamma);
        for (q, &fy) in frequencies.values.iter().enumerate() {
            for (p, &fx) in frequencies.values.iter().enumerate() {
                let error = (transfer.at_frequency(fx, fy) - otf.values[(n * count + q) * count + p]).abs();
                assert!(
                    error <= tolerance,
                    "transfer γ = {gamma} at ({fx}, {fy}): {error:e}"
                );
            }
        }
    }
}

fn lamp(light: &Value) -> Lamp {
    let triple = |value: &Value| [0, 1, 2].map(|i| value[i].as_f64().expect("three numbers"));
    for key in light.as_object().expect("an object").keys() {
        let known = ["position_m", "intensity", "direction", "axis", "cone_deg"];
        assert!(
            known.contains(&key.as_str()),
            "lamp parameter `{key}` is not known"
        );
    }
    let (place, intensity) = (triple(&light["position_m"]), triple(&light["intensity"]));
    let lamp = match light["cone_deg"].as_f64() {
        None => Lamp::point(place, intensity),
        Some(cone_deg) => {
            let axis = light.get("direction").or(light.get("axis")).expect("an axis");
            Lamp::spot(place, intensity, triple(axis), cone_deg)
        }
    };
    lamp.unwrap_or_else(|errors| panic!("{errors:?}"))
}

pub(crate) fn airlight(case: &Case) {
    let range = case.range();
    let focal_px = case.number("focal_px").expect("a focal length");
    let centered = Intrinsics::centered(focal_px, range.width(), range.height());
    let center = case.get("principal_point");
    let coordinate = |i: usize, usual| center.map_or(usual, |p| p[i].as_f64().expect("a number"));
    let scattering = case.triple("scattering_per_m").expect("scattering");
    let absorption = case.triple("absorption_per_m").expect("absorption");
    let lights = case.get("lights").and_then(Value::as_array).expect("lights");
    let lighting = Lighting {
        lamps: lights.iter().map(lamp).collect(),
        radius_m: case.number("min_radius_m").unwrap_or(LAMP_RADIUS_M),
        camera: Intrinsics {
            focal_px,
            cx: coordinate(0, centered.cx),
            cy: coordinate(1, centered.cy),
        },
        attenuation: [0, 1, 2].map(|i| absorption[i] + scattering[i]),
        scattering,
        absorption: None,
        phase: GlowPhase::henyey_greenstein(case.number("hg_g").expect("an asymmetry")),
        patches: None,
    };
    let exact = lamp::airlight_reference(&range, &lighting, REFERENCE_NODES);
    let peak = case
        .needed("output_linear")
        .values
        .into_iter()
        .fold(0.0, f64::max);
    // The compared light is scaled to a peak of at most 1.
    let tolerance = LAMPS * peak / peak.max(1.0);
    case.compare("output_linear", &exact, tolerance, "reference");
    let fast = lamp::airlight(&range.map(|&z| z as f32), &lighting, LAMPS_ASKED * peak).light;
    case.compare("output_linear", &fast, tolerance, "f32");
}
