//! Plans are compared, not run.

use imaging::{Plane, Rgb};
use spec::{ForwardScatter, Optics, ScatterModel};

use super::*;

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
    let request = spec::Water::from(Optics {
        beam_attenuation_per_m: Some([0.4; 3]),
        veiling_light: Some([0.1; 3]),
        forward_scatter: Some(scatter),
        ..Optics::default()
    });
    Water::resolve(&request, 500.0).unwrap()
}

fn plan(range_m: &[f32], water: &Water, fidelity: Fidelity) -> Plan {
    let (radiance, range) = wall(range_m);
    Plan::for_water(&SceneStats::measure(&radiance, &range, water), water, fidelity)
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
        assert_eq!(
            plan(&SLOPE, &all_absorbed, fidelity).scatter[0].form,
            ScatterStep::Skip
        );
    }
    let holes = [f32::NAN; 3];
    assert_eq!(
        plan(&holes, &water(ScatterModel::Jaffe, 0.1, 1.0), Fidelity::Terms(4)).scatter[0].form,
        ScatterStep::Skip
    );
}

#[test]
fn a_kernel_without_width_needs_no_transform() {
    assert_eq!(
        plan(&SLOPE, &water(ScatterModel::Jaffe, 0.1, 0.0), Fidelity::Terms(4)).scatter[0].form,
        ScatterStep::Pointwise
    );
    assert_eq!(
        plan(
            &SLOPE,
            &water(ScatterModel::Simplified, 0.1, 0.0),
            Fidelity::Terms(4)
        )
        .scatter[0]
            .form,
        ScatterStep::Skip
    );
}

#[test]
fn a_kernel_within_the_pixel_is_pointwise_as_the_tolerance_allows() {
    let narrow = water(ScatterModel::Jaffe, 0.1, 1e-4);
    assert_eq!(
        plan(&SLOPE, &narrow, Fidelity::Tolerance(1e-3)).scatter[0].form,
        ScatterStep::Pointwise
    );
    assert!(matches!(
        plan(&SLOPE, &narrow, Fidelity::Tolerance(1e-6)).scatter[0].form,
        ScatterStep::Interpolated(_)
    ));
}

#[test]
fn few_distinct_ranges_have_their_own_kernels() {
    let steps = [2.0, 15.0, 2.0, 15.0, 2.0];
    let exact = Nodes::exact([2.0, 15.0]);
    assert_eq!(
        plan(&steps, &water(ScatterModel::Jaffe, 0.1, 1.0), Fidelity::Terms(4)).scatter[1].form,
        ScatterStep::Interpolated(exact)
    );
}

#[test]
fn a_smaller_tolerance_takes_more_kernels() {
    let water = water(ScatterModel::Jaffe, 0.1, 1.0);
    let terms = [1e-2, 1e-3, 1e-5].map(|tolerance| {
        plan(&SLOPE, &water, Fidelity::Tolerance(tolerance)).lines()[4]
            .terms
            .unwrap()
    });
    assert!(terms.is_sorted() && terms[0] < terms[2], "{terms:?}");
}

#[test]
fn the_widest_kernel_is_four_frame_sides() {
    let water = water(ScatterModel::Jaffe, 0.001, 1e5);
    let ScatterStep::Interpolated(nodes) = &plan(&SLOPE, &water, Fidelity::Terms(9)).scatter[0].form else {
        panic!("nothing is spread")
    };
    assert_eq!(nodes.terms(), 1);
    assert!((nodes.gamma(0) - 160.0).abs() < 1e-9);
}

#[test]
fn a_frame_in_air_skips_every_stage_at_no_cost() {
    let lines = Plan::in_air(1000).lines();
    assert_eq!(lines.len(), 12);
    assert!(
        lines
            .iter()
            .all(|line| line.variant == "skip" && line.bound.is_none()),
        "{lines:?}"
    );
    assert!(
        lines.iter().all(|line| line.cost_ms.unwrap_or(0.0) == 0.0),
        "{lines:?}"
    );
}

#[test]
fn the_bound_of_a_plan_stays_within_its_tolerance_and_says_what_is_used() {
    let water = water(ScatterModel::Jaffe, 0.1, 1.0);
    for tolerance in [1e-2, 3e-4, 1e-5] {
        let plan = plan(&SLOPE, &water, Fidelity::Tolerance(tolerance));
        let bounds = plan.bounds().unwrap();
        assert_eq!(plan.exceeds, None);
        assert!(
            bounds.iter().all(|&bound| bound <= tolerance && bound > 0.0),
            "{bounds:?}"
        );
    }
    assert_eq!(plan(&SLOPE, &water, Fidelity::Terms(4)).bounds(), None);
}

#[test]
fn one_code_of_a_bright_picture_allows_more_than_one_of_a_dark_one() {
    let terms = |veil: f64| {
        let request = spec::Water::from(Optics {
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
        plan(&SLOPE, &water, Fidelity::DISPLAY).lines()[4].terms.unwrap()
    };
    assert!(terms(0.6) < terms(0.0), "{} and {}", terms(0.6), terms(0.0));
}

#[test]
fn attenuation_that_nobody_sees_is_left_out() {
    let request = |c: f64| {
        spec::Water::from(Optics {
            beam_attenuation_per_m: Some([c; 3]),
            veiling_light: Some([0.1; 3]),
            forward_scatter: Some(ForwardScatter::from(ScatterModel::None)),
            ..Optics::default()
        })
    };
    let step = |c: f64, range: &[f32]| {
        let water = Water::resolve(&request(c), 500.0).unwrap();
        plan(range, &water, Fidelity::Tolerance(3e-4)).attenuation.form
    };
    assert_eq!(step(1e-6, &SLOPE), Form::Skip);
    assert_eq!(step(1e-4, &SLOPE), Form::Fast);
    // At a hole the path never ends.
    assert_eq!(step(1e-6, &[2.0, f32::NAN, 3.0]), Form::Fast);
}

#[test]
fn every_physical_stage_that_runs_says_what_its_model_is_wrong_by() {
    let water = |scattering: f64| {
        let request = spec::Water::from(Optics {
            absorption_per_m: Some([0.1; 3]),
            scattering_per_m: Some([scattering; 3]),
            veiling_light: Some([0.1; 3]),
            ..Optics::default()
        });
        Water::resolve(&request, 500.0).unwrap()
    };
    let errors = |water: &Water| {
        let lines = plan(&SLOPE, water, Fidelity::Tolerance(1e-4)).lines();
        let errors = lines
            .into_iter()
            .map(|line| (line.stage, (line.variant, line.model_error)));
        errors.collect::<std::collections::BTreeMap<_, _>>()
    };
    let clear = errors(&water(0.3));
    assert_eq!(
        clear["attenuation"].1.as_deref(),
        Some("unscattered light: none; veil: not measured")
    );
    assert!(
        clear["forward_scatter.r"]
            .1
            .as_deref()
            .unwrap()
            .contains("1.6-5.1")
    );
    // Beyond what was measured, and of stages that do not run or have no truth.
    assert_eq!(
        errors(&water(2.0))["forward_scatter.b"].1.as_deref(),
        Some("not measured")
    );
    assert!(
        clear
            .values()
            .all(|(variant, error)| *variant != "skip" || error.is_none())
    );
    assert_eq!(clear["style"].1, None);
}
