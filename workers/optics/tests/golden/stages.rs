//! What each stage compares.

use fathom_optics::chain::{self, Layers};
use fathom_optics::forward_scatter::KernelCache;
use fathom_optics::kernel::{Transfer, pixel};
use fathom_optics::plan::{Fidelity, Plan, SceneStats};
use fathom_optics::water::{Ambient, ScatterModel, ScatterRequest, ScatterSource, Water, WaterRequest};
use fathom_optics::{HazeBlend, HazeLight, HazeSpace, haze as lay_haze, style_blend};
use imaging::Rgb;
use serde_json::Value;

use crate::case::Case;

/// f32 arithmetic on light up to a few units.
const FLOAT: f64 = 2e-6;
/// Sixteen kernels leave only the floor of f32.
const SIXTEEN_TERMS: f64 = 2e-6;
/// A tolerance that guarantees one 8-bit code at the steep foot of the sRGB curve.
const ONE_CODE: f64 = 3e-4;
const LOOSE: f64 = 4e-3;
const KERNEL: f64 = 1e-7;
/// Transfer functions stored in f64 are fitted to 1e-8 per term.
const OTF: f64 = 1e-8;
/// Share of 8-bit codes that may differ by one: rounding alone, and rounding after a tolerance of [`ONE_CODE`].
const CODES_EXACT: f64 = 1e-3;
const CODES_SCATTER: f64 = 1e-2;

fn water(case: &Case) -> Water {
    let known = case.triple("background").or(case.triple("background_surface"));
    let request = WaterRequest {
        beam_attenuation: case.triple("attenuation_per_m"),
        backscatter_attenuation: case.triple("backscatter_per_m"),
        diffuse_attenuation: case.triple("kd_per_m"),
        veiling_light: Some(known.unwrap_or([0.0; 3])),
        depth_m: case.number("depth_m"),
        ambient: if case.get("kd_per_m").is_some() {
            Ambient::Absolute
        } else {
            Ambient::None
        },
        scatter: Some(ScatterRequest {
            model: match case.text("stage").as_str() {
                "simplified" => ScatterModel::Simplified,
                "attenuation" => ScatterModel::None,
                _ => ScatterModel::Jaffe,
            },
            g: case.triple("G_per_m"),
            spread_px_per_m: Some(case.triple("spread_px_per_m").unwrap_or([0.0; 3])),
            spread_offset_px: case.triple("spread_offset_px"),
            source: if case.text("scatter_source") == "direct" {
                ScatterSource::Direct
            } else {
                ScatterSource::Radiance
            },
        }),
        ..WaterRequest::default()
    };
    Water::resolve(&request, 1.0).unwrap_or_else(|errors| panic!("{errors:?}"))
}

fn layers(case: &Case, fidelity: Fidelity) -> Layers {
    let (radiance, range, water) = (case.radiance(), case.range(), water(case));
    let stats = SceneStats::measure(&radiance, &range, &water);
    let plan = Plan::for_frame(&stats, &water, None, &[], fidelity);
    chain::water(&radiance, &range, &water, &plan, &mut KernelCache::new())
        .unwrap_or_else(|error| panic!("{error}"))
}

pub(crate) fn attenuation(case: &Case) {
    for (fidelity, what) in [
        (Fidelity::Reference, "reference"),
        (Fidelity::Tolerance(ONE_CODE), "f32"),
    ] {
        let layers = layers(case, fidelity);
        case.compare("output_linear", &layers.scattered, FLOAT, what);
        case.compare_codes("output_srgb", &layers.scattered, CODES_EXACT, what);
    }
}

pub(crate) fn scatter(case: &Case) {
    let variants = [
        (Fidelity::Reference, FLOAT, "reference"),
        (Fidelity::Terms(16), SIXTEEN_TERMS, "16 terms"),
        (Fidelity::Tolerance(ONE_CODE), ONE_CODE + FLOAT, "tolerance 3e-4"),
        (Fidelity::Tolerance(LOOSE), LOOSE + FLOAT, "tolerance 4e-3"),
    ];
    for (fidelity, tolerance, what) in variants {
        let layers = layers(case, fidelity);
        case.compare("direct", &layers.direct, FLOAT, what);
        case.compare("backscatter", &layers.backscatter, FLOAT, what);
        case.compare("forward", &layers.forward_scatter, tolerance, what);
        case.compare("output_linear", &layers.scattered, tolerance, what);
        let attenuated = zipped(&layers.direct, &layers.backscatter, |d, b| d + b);
        case.compare("attenuated", &attenuated, FLOAT, what);
        let share = if fidelity == Fidelity::Reference {
            CODES_EXACT
        } else {
            CODES_SCATTER
        };
        if tolerance < LOOSE {
            case.compare_codes("output_srgb", &layers.scattered, share, what);
        }
    }
}

fn zipped(a: &Rgb<f32>, b: &Rgb<f32>, combine: impl Fn(f32, f32) -> f32) -> Rgb<f32> {
    Rgb::from_fn(a.width(), a.height(), |x, y| {
        let (a, b) = (a.at(x, y), b.at(x, y));
        [combine(a[0], b[0]), combine(a[1], b[1]), combine(a[2], b[2])]
    })
}

fn lights(case: &Case) -> Vec<HazeLight> {
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
        HazeLight {
            x: number(&light["position"][0]),
            y: number(&light["position"][1]),
            size: number(&light["size"]),
            intensity: number(&light["intensity"]),
            color: [0, 1, 2].map(|c| number(&light["color"][c])),
            blend: if light["blend"] == "add" {
                HazeBlend::Add
            } else {
                HazeBlend::Over
            },
        }
    };
    list.iter().map(light).collect()
}

pub(crate) fn haze(case: &Case) {
    let lights = lights(case);
    let linear = lay_haze(case.radiance(), &lights, HazeSpace::Linear);
    case.compare("output_linear", &linear, FLOAT, "linear");
    let display = lay_haze(case.radiance(), &lights, HazeSpace::Display);
    case.compare("output_display_space", &display, FLOAT, "display");
}

pub(crate) fn chain(case: &Case) {
    let alpha = case.number("alpha").unwrap_or(1.0);
    let space = if case.text("haze_space") == "display" {
        HazeSpace::Display
    } else {
        HazeSpace::Linear
    };
    let variants = [
        (Fidelity::Reference, FLOAT, CODES_EXACT, "reference"),
        (Fidelity::Terms(16), SIXTEEN_TERMS, CODES_SCATTER, "16 terms"),
        (
            Fidelity::Tolerance(ONE_CODE),
            ONE_CODE + FLOAT,
            CODES_SCATTER,
            "tolerance 3e-4",
        ),
    ];
    for (fidelity, tolerance, share, what) in variants {
        let layers = layers(case, fidelity);
        case.compare("after_water", &layers.scattered, tolerance, what);
        let blended = match case.array("model_srgb") {
            Some(model) => style_blend(&layers.scattered, &model.rgb(|v| v as f32), alpha),
            None => layers.scattered,
        };
        case.compare("after_blend", &blended, tolerance, what);
        let hazed = lay_haze(blended, &lights(case), space);
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
                let error = (transfer.at(fx, fy) - otf.values[(n * count + q) * count + p]).abs();
                assert!(
                    error <= tolerance,
                    "transfer γ = {gamma} at ({fx}, {fy}): {error:e}"
                );
            }
        }
    }
}
