//! Two kernels, and forward scatter that near objects stop.

use imaging::{Plane, Rgb};
use optics::chain::{Layers, water, water_reference};
use optics::forward_scatter::KernelCache;
use optics::layering::Layering;
use optics::medium::{Kernels, Medium};
use optics::plan::{Plan, SceneBounds, StageId, Variant};
use optics::water::Water;
use spec::{Fidelity, Optics, PhaseFunction, ScatterModel};

use crate::case::Case;
use crate::cut::forward_of_cut_kernels;

/// Stored with 24 kernels, computed with the exact kernel of every pixel.
const REFERENCE: f64 = 1e-7;
/// The default tolerance, and a smaller one.
const TOLERANCES: [f64; 2] = [3e-4, 1e-5];
/// Rounding of f32, added to a tolerance.
const FLOAT: f64 = 5e-6;
/// Cuts and gates, relative.
const CUTS: f64 = 1e-9;
/// The light of a wall on a pole before it, as a share of Monte Carlo.
const LEAK: (f64, f64) = (0.9, 1.15);
/// Direct light of the pole next to it, as a share of Monte Carlo.
const OWN: (f64, f64) = (0.8, 1.18);

/// Layers of gated frames.
const MOST_LAYERS: usize = 3;

fn resolved(case: &Case, kernels: Kernels, layers: Option<usize>) -> Water {
    let phase = if case.text("law") == "hg" {
        PhaseFunction::Hg
    } else {
        PhaseFunction::Ff
    };
    let optics = Optics {
        absorption_per_m: case.triple("absorption"),
        scattering_per_m: case.triple("scattering"),
        veiling_light: Some([0.0; 3]),
        phase,
        forward_scatter: Some(ScatterModel::Jaffe.into()),
        ..Optics::default()
    };
    let medium = Medium {
        kernels,
        layers,
        ..optics.into()
    };
    let focal_px = case.number("focal_px").unwrap_or(POLE_FOCAL_PX);
    Water::resolve(&medium, focal_px).unwrap_or_else(|errors| panic!("{errors:?}"))
}

fn fast(radiance: &Rgb<f64>, range: &Plane<f64>, of: &Water, fidelity: Fidelity) -> (Layers, Plan) {
    let (radiance, range) = (radiance.map(|&j| j as f32), range.map(|&z| z as f32));
    let plan = Plan::for_water(&SceneBounds::measure(&radiance, &range, of), of, fidelity);
    let layers = water(&radiance, &range, of, &plan, &mut KernelCache::new()).expect("a good frame");
    (layers, plan)
}

/// The stored arrays of two kernels were made with narrow kernels that end 60 pixels away, with the tail, up to 0.4 % of the light, added
/// to the middle pixel. The definition has no end. The difference is up to 4e-4 of light here, more than the default tolerance. Kernels
/// with an end reproduce the arrays to 1e-7, so the fast form is compared after subtracting the exact effect of the missing tail.
pub(crate) fn gated(case: &Case) {
    let (radiance, range) = (case.radiance(), case.range());
    let layering = Layering::find(&range, MOST_LAYERS).expect("something hides something");
    for (name, found) in [("cuts_m", &layering.cuts_m), ("gates_m", &layering.gates_m)] {
        let expected = case.numbers(name);
        assert_eq!(expected.len(), found.len(), "{name}: {found:?}");
        for (expected, found) in expected.iter().zip(found) {
            assert!(
                (found / expected - 1.0).abs() < CUTS,
                "{name}: {found} for {expected}"
            );
        }
    }
    let layers: Vec<i32> = range
        .data()
        .iter()
        .map(|&z| layering.layer_of(z) as i32)
        .collect();
    assert_eq!(layers, case.integers("layer"));
    for (name, kernels, layering) in [
        ("forward_one", Kernels::One, None),
        ("forward_two", Kernels::Two, None),
        ("forward_gated", Kernels::Two, Some(&layering)),
    ] {
        let water = resolved(case, kernels, layering.map(|_| MOST_LAYERS));
        let exact = water_reference(&radiance, &range, &water).expect("a small frame");
        case.compare("direct", &exact.direct, REFERENCE, "the reference");
        let ends = if name == "forward_one" {
            case.compare(name, &exact.forward_scatter, REFERENCE, "the reference");
            exact.forward_scatter.map(|_| 0.0)
        } else {
            let cut = forward_of_cut_kernels(case, &radiance, &range, layering);
            case.compare(name, &cut, REFERENCE, "kernels that are cut off");
            difference(&exact.forward_scatter, &cut)
        };
        let compare = |forward: &Rgb<f64>, tolerance: f64, what: &str| {
            case.compare(name, &difference(forward, &ends), tolerance, what);
        };
        for tolerance in TOLERANCES {
            let (layers, plan) = fast(&radiance, &range, &water, Fidelity::Tolerance(tolerance));
            let is_gated = |plan: &Plan| matches!(plan.variant(StageId::Occlusion), Variant::Gated(_));
            assert_eq!(is_gated(&plan), name == "forward_gated");
            compare(
                &widened(&layers),
                tolerance,
                &format!("the fast form within {tolerance:e}"),
            );
        }
        let (layers, _) = fast(&radiance, &range, &water, Fidelity::Terms(24));
        compare(&widened(&layers), FLOAT, "24 kernels");
    }
}

fn widened(layers: &Layers) -> Rgb<f64> {
    layers.forward_scatter.map(|&v| f64::from(v))
}

fn difference(a: &Rgb<f64>, b: &Rgb<f64>) -> Rgb<f64> {
    Rgb::from_fn(a.width(), a.height(), |x, y| {
        let (a, b) = (a.pixel(x, y), b.pixel(x, y));
        [0, 1, 2].map(|channel| a[channel] - b[channel])
    })
}

/// The frame that the pole is rendered into: wide enough for the mirror at its sides to be far away.
const POLE_FOCAL_PX: f64 = 400.0;
const POLE_SIZE: (usize, usize) = (641, 5);

/// Light of a wall, and of a plate before it, at a few angles from the middle of the plate, against Monte Carlo.
pub(crate) fn pole(case: &Case) {
    let number = |name: &str| case.number(name).unwrap_or_else(|| panic!("`{name}` is missing"));
    let (pole_z, wall_z, half) = (number("pole_z"), number("wall_z"), number("pole_half_width_tan"));
    let (width, height) = POLE_SIZE;
    let tan = |x: usize| (x as f64 - (width as f64 - 1.0) / 2.0) / POLE_FOCAL_PX;
    let is_pole = |x: usize| tan(x).abs() <= half;
    let range = Plane::from_fn(width, height, |x, _| {
        (if is_pole(x) { pole_z } else { wall_z }) * (1.0 + tan(x) * tan(x)).sqrt()
    });
    let water = resolved(case, Kernels::Two, Some(MOST_LAYERS));
    let angles = case.needed("tan_x").values;
    for (name, is_near, (least, most)) in [("far", false, LEAK), ("near", true, OWN)] {
        let radiance = Rgb::from_fn(width, height, |x, _| {
            [f64::from(u8::from(is_pole(x) == is_near)); 3]
        });
        let (layers, _) = fast(&radiance, &range, &water, Fidelity::Tolerance(1e-5));
        let errors = case.needed(&format!("{name}_se")).values;
        for ((&angle, truth), error) in angles.iter().zip(case.needed(name).values).zip(errors) {
            let at = (width as f64 - 1.0) / 2.0 + POLE_FOCAL_PX * angle;
            let row = layers.scattered.planes()[0].row(height / 2);
            let (left, share) = (at.floor() as usize, at.fract());
            let model = f64::from(row[left]) * (1.0 - share) + f64::from(row[left + 1]) * share;
            let near_edge = (angle.abs() - half).abs() < 1.5 / POLE_FOCAL_PX;
            println!("   {name} at {angle:.3}: {model:.5} for {truth:.5} +- {error:.5}");
            assert!(
                near_edge || (model + 4.0 * error >= least * truth && model - 4.0 * error <= most * truth),
                "{name} at {angle}: {model} for {truth}"
            );
        }
    }
}
