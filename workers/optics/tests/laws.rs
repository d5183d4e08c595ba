//! Properties of the water stage in any method: conservation, symmetry, limits.

#![allow(clippy::unwrap_used)]

use imaging::dct::Dct2;
use imaging::random::Stream;
use imaging::{Plane, Rgb};
use optics::chain::{Layers, water};
use optics::forward_scatter::{KernelCache, Nodes, gather, scatter};
use optics::kernel::Transfer;
use optics::medium::Medium;
use optics::plan::{Plan, SceneBounds, StageId, Variant};
use optics::water::Water;
use spec::{Fidelity, ForwardScatter, HoleRule, Optics, ScatterModel};

const WIDTH: usize = 41;
const HEIGHT: usize = 29;

fn noise(element: u64) -> Plane<f32> {
    let stream = Stream::stage(5, "laws");
    Plane::from_fn(WIDTH, HEIGHT, |x, y| {
        stream.unit((y * WIDTH + x) as u64, element) as f32
    })
}

fn scales() -> (Plane<f32>, Nodes) {
    (noise(9).map(|r| 0.1 + 8.0 * r), Nodes::chebyshev(0.1, 8.1, 6))
}

fn sum(plane: &Plane<f32>) -> f64 {
    plane.data().iter().map(|&v| f64::from(v)).sum()
}

fn dot(a: &Plane<f32>, b: &Plane<f32>) -> f64 {
    a.data()
        .iter()
        .zip(b.data())
        .map(|(&a, &b)| f64::from(a) * f64::from(b))
        .sum()
}

fn request() -> Medium {
    let scatter = ForwardScatter {
        spread_px_per_m: Some([0.7; 3]),
        g_per_m: Some([0.1; 3]),
        ..ScatterModel::Jaffe.into()
    };
    Medium::from(Optics {
        beam_attenuation_per_m: Some([0.4, 0.2, 0.15]),
        veiling_light: Some([0.03, 0.12, 0.18]),
        forward_scatter: Some(scatter),
        ..Optics::default()
    })
}

fn with_g(g: [f64; 3]) -> Medium {
    let mut request = request();
    let scatter = request.optics.forward_scatter.as_mut();
    scatter.expect("the request has it").g_per_m = Some(g);
    request
}

fn render(request: &Medium, range: &Plane<f32>, fidelity: Fidelity) -> (Layers, Plan, Rgb<f32>) {
    let radiance = Rgb::new([noise(0), noise(1), noise(2)]).expect("planes of one size");
    let optics = Water::resolve(request, 500.0).expect("a consistent water");
    let plan = Plan::for_water(
        &SceneBounds::measure(&radiance, range, &optics),
        &optics,
        fidelity,
    );
    let layers = water(&radiance, range, &optics, &plan, &mut KernelCache::new()).expect("a good frame");
    (layers, plan, radiance)
}

#[test]
fn scatter_keeps_all_light() {
    let (gamma, nodes) = scales();
    let light = noise(0);
    let spread = scatter(&light, &gamma, &nodes, &mut KernelCache::new());
    assert!((sum(&spread) / sum(&light) - 1.0).abs() < 1e-6);
}

#[test]
fn gather_keeps_a_uniform_field() {
    let (gamma, nodes) = scales();
    let uniform = gather(
        &Plane::filled(WIDTH, HEIGHT, 0.5),
        &gamma,
        &nodes,
        &mut KernelCache::new(),
    );
    assert!(uniform.data().iter().all(|v| (v - 0.5).abs() < 1e-6));
}

#[test]
fn scatter_and_gather_are_adjoint() {
    let (gamma, nodes) = scales();
    let (u, v) = (noise(0), noise(1));
    let cache = &mut KernelCache::new();
    let (left, right) = (
        dot(&scatter(&u, &gamma, &nodes, cache), &v),
        dot(&u, &gather(&v, &gamma, &nodes, cache)),
    );
    assert!((left / right - 1.0).abs() < 1e-6, "{left} and {right}");
}

#[test]
fn a_flat_wall_is_one_transform() {
    let range = Plane::filled(WIDTH, HEIGHT, 3.0);
    let (layers, plan, radiance) = render(&request(), &range, Fidelity::Tolerance(1e-6));
    let Variant::Interpolated(nodes) = plan.variant(StageId::ForwardScatter(1)) else {
        panic!("nothing is spread")
    };
    assert_eq!(nodes.terms(), 1);
    let (g, c, gamma) = (0.1, 0.2, 0.7 * 3.0);
    let share = f64::exp(-g * 3.0) - f64::exp(-c * 3.0);
    let mut light: Vec<f64> = radiance.planes()[1]
        .data()
        .iter()
        .map(|&j| f64::from(j) * share)
        .collect();
    let mut transform = Dct2::new(WIDTH, HEIGHT);
    transform.forward(&mut light);
    light
        .iter_mut()
        .zip(Transfer::new(gamma).grid(WIDTH, HEIGHT))
        .for_each(|(value, h)| *value *= h);
    transform.inverse(&mut light);
    for (forward, expected) in layers.forward_scatter.planes()[1].data().iter().zip(light) {
        assert!((f64::from(*forward) - expected).abs() < 1e-6);
    }
}

#[test]
fn the_image_is_direct_and_scattered_light_and_veil() {
    let (layers, ..) = render(&request(), &noise(3).map(|r| 1.0 + 9.0 * r), Fidelity::Terms(5));
    for (x, y) in [(0, 0), (20, 11), (40, 28)] {
        for channel in 0..3 {
            let parts = [&layers.direct, &layers.forward_scatter, &layers.backscatter]
                .map(|l| l.pixel(x, y)[channel]);
            assert!((layers.scattered.pixel(x, y)[channel] - parts.iter().sum::<f32>()).abs() < 1e-6);
            assert!(parts.iter().all(|&part| part > 0.0));
        }
    }
}

#[test]
fn veiling_light_is_all_that_remains_at_long_range() {
    let (layers, ..) = render(
        &request(),
        &Plane::filled(WIDTH, HEIGHT, 1e4),
        Fidelity::Tolerance(1e-4),
    );
    assert_eq!(layers.scattered.pixel(7, 7), [0.03, 0.12, 0.18]);
}

#[test]
fn the_scene_is_all_there_is_at_no_range() {
    let (layers, _, radiance) = render(
        &request(),
        &Plane::filled(WIDTH, HEIGHT, 0.001),
        Fidelity::Tolerance(1e-6),
    );
    for (seen, scene) in layers.scattered.pixel(5, 6).iter().zip(radiance.pixel(5, 6)) {
        assert!((seen - scene).abs() < 1e-3);
    }
}

#[test]
fn where_all_scattered_light_is_lost_none_is_spread() {
    let (layers, plan, _) = render(
        &with_g([0.4, 0.1, 0.1]),
        &noise(3).map(|r| 1.0 + 9.0 * r),
        Fidelity::Terms(5),
    );
    assert_eq!(plan.variant(StageId::ForwardScatter(0)), &Variant::Skip);
    assert!(
        layers.forward_scatter.planes()[0]
            .data()
            .iter()
            .all(|&v| v == 0.0)
    );
    assert!(layers.forward_scatter.planes()[1].data().iter().all(|&v| v > 0.0));
}

#[test]
fn only_the_red_coefficient_changes_only_red() {
    let range = noise(3).map(|r| 1.0 + 9.0 * r);
    let (before, ..) = render(&request(), &range, Fidelity::Terms(5));
    let redder = Medium::from(Optics {
        beam_attenuation_per_m: Some([0.5, 0.2, 0.15]),
        ..request().optics
    });
    let (after, ..) = render(&redder, &range, Fidelity::Terms(5));
    assert_ne!(after.scattered.planes()[0], before.scattered.planes()[0]);
    let others = after.scattered.planes()[1..]
        .iter()
        .zip(&before.scattered.planes()[1..]);
    for (after, before) in others {
        for (after, before) in after.data().iter().zip(before.data()) {
            assert!((after - before).abs() < SHARED_TRANSFORM, "{after} and {before}");
        }
    }
}

/// Two channels share a complex transform, and each of its sums is rounded with both of them in it: light up to 1 has an
/// f32 step of 6e-8, which some ten stages add up to this at most.
const SHARED_TRANSFORM: f32 = 1e-6;

#[test]
fn range_scale_is_the_same_as_a_longer_range() {
    let range = noise(3).map(|r| 1.0 + 4.0 * r);
    let (scaled, ..) = render(
        &Medium {
            range_scale: 2.0,
            ..request()
        },
        &range,
        Fidelity::Terms(6),
    );
    let (longer, ..) = render(&request(), &range.map(|z| 2.0 * z), Fidelity::Terms(6));
    for (a, b) in scaled.scattered.planes().iter().zip(longer.scattered.planes()) {
        assert!(a.data().iter().zip(b.data()).all(|(a, b)| (a - b).abs() < 2e-6));
    }
}

#[test]
fn holes_follow_their_rule() {
    let range = Plane::from_fn(WIDTH, HEIGHT, |x, _| if x == 3 { f32::NAN } else { 4.0 });
    let (background, ..) = render(&request(), &range, Fidelity::Terms(5));
    assert_eq!((background.holes, background.direct.pixel(3, 3)), (29, [0.0; 3]));
    let rule = |holes| Medium { holes, ..request() };
    let (replaced, ..) = render(&rule(HoleRule::RangeM(4.0)), &range, Fidelity::Terms(5));
    let (flat, ..) = render(&request(), &Plane::filled(WIDTH, HEIGHT, 4.0), Fidelity::Terms(5));
    assert_eq!((replaced.holes, &replaced.scattered), (29, &flat.scattered));
    let optics = Water::resolve(&rule(HoleRule::Reject), 500.0).unwrap();
    let plan = Plan::default();
    let radiance = Rgb::new([noise(0), noise(1), noise(2)]).unwrap();
    let error = water(&radiance, &range, &optics, &plan, &mut KernelCache::new()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "29 pixels have no valid range and the rule for holes is `reject`"
    );
}

#[test]
fn frames_that_do_not_fit_are_refused() {
    let optics = Water::resolve(&request(), 500.0).unwrap();
    let plan = Plan::default();
    let radiance = |w, h| Rgb::from_fn(w, h, |_, _| [0.5f32; 3]);
    let refused = |radiance: Rgb<f32>, range: Plane<f32>| {
        water(&radiance, &range, &optics, &plan, &mut KernelCache::new())
            .unwrap_err()
            .to_string()
    };
    assert_eq!(
        refused(radiance(4, 3), Plane::filled(4, 4, 1.0)),
        "range map is 4×4 but the image is 4×3"
    );
    assert_eq!(
        refused(radiance(0, 3), Plane::filled(0, 3, 1.0)),
        "the frame is empty: 0×3"
    );
}
