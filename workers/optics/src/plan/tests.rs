//! Plans are compared, not run.

use imaging::{Plane, Rgb};
use spec::{ForwardScatter, Optics, ScatterModel};

use super::*;
use crate::forward_scatter::Nodes;
use crate::medium::Medium;

fn wall(range_m: &[f32]) -> (Rgb<f32>, Plane<f32>) {
    let radiance = Rgb::from_fn(range_m.len(), 1, |_, _| [0.5f32; 3]);
    (radiance, Plane::new(range_m.len(), 1, range_m.to_vec()).unwrap())
}

fn water(model: ScatterModel, g: f64, spread_px_per_m: f64) -> Water {
    let scatter = ForwardScatter {
        spread_px_per_m: Some([spread_px_per_m; 3]),
        g_per_m: Some([g; 3]),
        ..model.into()
    };
    let request = Medium::from(Optics {
        beam_attenuation_per_m: Some([0.4; 3]),
        veiling_light: Some([0.1; 3]),
        forward_scatter: Some(scatter),
        ..Optics::default()
    });
    Water::resolve(&request, 500.0).unwrap()
}

fn plan(range_m: &[f32], water: &Water, fidelity: Fidelity) -> Plan {
    let (radiance, range) = wall(range_m);
    Plan::for_water(&SceneBounds::measure(&radiance, &range, water), water, fidelity)
}

/// Forward scatter of the red channel.
fn red(plan: &Plan) -> &Variant {
    plan.variant(StageId::ForwardScatter(0))
}

const SLOPE: [f32; 40] = {
    let mut slope = [1.0; 40];
    let mut i = 0;
    while i < 40 {
        slope[i] = 1.0 + 0.25 * i as f32;
        i += 1;
    }
    slope
};

#[test]
fn without_scattered_light_nothing_is_spread() {
    let all_absorbed = water(ScatterModel::Jaffe, 0.4, 1.0);
    for fidelity in [Fidelity::Tolerance(1e-6), Fidelity::Terms(4)] {
        assert_eq!(red(&plan(&SLOPE, &all_absorbed, fidelity)), &Variant::Skip);
    }
    let holes = [f32::NAN; 3];
    let lit = water(ScatterModel::Jaffe, 0.1, 1.0);
    assert_eq!(red(&plan(&holes, &lit, Fidelity::Terms(4))), &Variant::Skip);
}

#[test]
fn a_kernel_without_width_needs_no_transform() {
    for (model, variant) in [
        (ScatterModel::Jaffe, Variant::Pointwise),
        (ScatterModel::Simplified, Variant::Skip),
    ] {
        let plan = plan(&SLOPE, &water(model, 0.1, 0.0), Fidelity::Terms(4));
        assert_eq!(red(&plan), &variant);
    }
}

#[test]
fn a_kernel_within_the_pixel_is_pointwise_as_the_tolerance_allows() {
    let narrow = water(ScatterModel::Jaffe, 0.1, 1e-4);
    let loose = plan(&SLOPE, &narrow, Fidelity::Tolerance(1e-3));
    assert_eq!(red(&loose), &Variant::Pointwise);
    let tight = plan(&SLOPE, &narrow, Fidelity::Tolerance(1e-6));
    assert!(matches!(red(&tight), Variant::Interpolated(_)));
}

#[test]
fn few_distinct_ranges_have_their_own_kernels() {
    let steps = [2.0, 15.0, 2.0, 15.0, 2.0];
    let exact = Nodes::exact([2.0, 15.0]);
    let plan = plan(&steps, &water(ScatterModel::Jaffe, 0.1, 1.0), Fidelity::Terms(4));
    assert_eq!(
        plan.variant(StageId::ForwardScatter(1)),
        &Variant::Interpolated(exact)
    );
}

#[test]
fn a_smaller_tolerance_takes_more_kernels() {
    let water = water(ScatterModel::Jaffe, 0.1, 1.0);
    let terms = [1e-2, 1e-3, 1e-5].map(|tolerance| {
        let plan = plan(&SLOPE, &water, Fidelity::Tolerance(tolerance));
        red(&plan).kernels().unwrap()
    });
    assert!(terms.is_sorted() && terms[0] < terms[2], "{terms:?}");
}

#[test]
fn the_widest_kernel_is_four_frame_sides() {
    let water = water(ScatterModel::Jaffe, 0.001, 1e5);
    let plan = plan(&SLOPE, &water, Fidelity::Terms(9));
    let Variant::Interpolated(nodes) = red(&plan) else {
        panic!("nothing is spread")
    };
    assert_eq!(nodes.terms(), 1);
    assert!((nodes.gamma(0) - 160.0).abs() < 1e-9);
}

#[test]
fn the_promise_of_a_plan_stays_within_its_tolerance() {
    let water = water(ScatterModel::Jaffe, 0.1, 1.0);
    for tolerance in [1e-2, 3e-4, 1e-5] {
        let promise = plan(&SLOPE, &water, Fidelity::Tolerance(tolerance))
            .promise()
            .unwrap();
        assert_eq!(promise.exceeds, None);
        assert!(promise.bound <= tolerance && promise.bound > 0.0, "{promise:?}");
    }
    assert_eq!(plan(&SLOPE, &water, Fidelity::Terms(4)).promise(), None);
}

#[test]
fn one_code_of_a_bright_picture_allows_more_than_one_of_a_dark_one() {
    let terms = |veil: f64| {
        let request = Medium::from(Optics {
            beam_attenuation_per_m: Some([0.4; 3]),
            veiling_light: Some([veil; 3]),
            forward_scatter: Some(ForwardScatter {
                spread_px_per_m: Some([1.0; 3]),
                g_per_m: Some([0.1; 3]),
                ..ScatterModel::Jaffe.into()
            }),
            ..Optics::default()
        });
        let water = Water::resolve(&request, 500.0).unwrap();
        red(&plan(&SLOPE, &water, Fidelity::Picture)).kernels().unwrap()
    };
    assert!(terms(0.6) < terms(0.0), "{} and {}", terms(0.6), terms(0.0));
}

#[test]
fn attenuation_that_nobody_sees_is_left_out() {
    let request = |c: f64| {
        Medium::from(Optics {
            beam_attenuation_per_m: Some([c; 3]),
            veiling_light: Some([0.1; 3]),
            forward_scatter: Some(ForwardScatter::from(ScatterModel::None)),
            ..Optics::default()
        })
    };
    let step = |c: f64, range: &[f32]| {
        let water = Water::resolve(&request(c), 500.0).unwrap();
        plan(range, &water, Fidelity::Tolerance(3e-4))
            .variant(StageId::Attenuation)
            .clone()
    };
    assert_eq!(step(1e-6, &SLOPE), Variant::Skip);
    assert_eq!(step(1e-4, &SLOPE), Variant::Fast("f32"));
    // At a hole the path never ends.
    assert_eq!(step(1e-6, &[2.0, f32::NAN, 3.0]), Variant::Fast("f32"));
}

#[test]
fn every_physical_stage_that_runs_says_what_its_model_is_wrong_by() {
    let water = |scattering: f64| {
        let request = Medium::from(Optics {
            absorption_per_m: Some([0.1; 3]),
            scattering_per_m: Some([scattering; 3]),
            veiling_light: Some([0.1; 3]),
            ..Optics::default()
        });
        Water::resolve(&request, 500.0).unwrap()
    };
    let errors = |water: &Water| {
        let plan = plan(&SLOPE, water, Fidelity::Tolerance(1e-4));
        let errors = plan.stages.iter();
        let errors = errors.map(|stage| (stage.id.name(), stage.printed_model_error()));
        errors.collect::<std::collections::BTreeMap<_, _>>()
    };
    let clear = errors(&water(0.3));
    assert_eq!(
        clear["attenuation"].as_deref(),
        Some("unscattered light: none; veil: not measured")
    );
    assert!(clear["forward_scatter.r"].as_deref().unwrap().contains("1.6-5.1"));
    // Outside the measured range.
    assert_eq!(
        errors(&water(2.0))["forward_scatter.b"].as_deref(),
        Some("not measured")
    );
}
