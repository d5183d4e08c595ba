//! The fast water stage agrees with its f64 reference: scene × form × size × fidelity, the largest error bounded.

#![allow(clippy::unwrap_used)]

#[path = "agreement/daylight.rs"]
mod daylight;
#[path = "agreement/scenes.rs"]
mod scenes;

use imaging::{Plane, Rgb};
use optics::chain::{Layers, water, water_reference};
use optics::forward_scatter::KernelCache;
use optics::medium::{Kernels, Medium};
use optics::plan::{Plan, SceneBounds};
use optics::water::Water;

use scenes::{SCENES, Scene};
use spec::{Fidelity, ForwardScatter, Optics, PhaseFunction, ScatterModel, ScatterSource};

/// A single pixel, single lines, primes, odd, even and composite sides.
const SIZES: [(usize, usize); 8] = [
    (1, 1),
    (1, 7),
    (7, 1),
    (2, 2),
    (13, 17),
    (16, 9),
    (31, 8),
    (72, 41),
];

/// Rounding of f32 for light up to 1: a handful of operations in the attenuation, a few dozen in the transforms.
const FLOAT: f64 = 1e-6;

/// Largest error with a given number of kernels, for light up to 1 and kernel scales within a ratio of 45. Interpolation at
/// Chebyshev nodes converges geometrically; published trials on smooth scenes report 1.9e-3, 2e-4, 1.1e-5 and 3e-7 for the first
/// four, and noise, common in these scenes, has up to half more with four.
const BY_TERMS: [(usize, f64); 5] = [(4, 3.5e-3), (6, 4e-4), (8, 9e-5), (12, 3e-6), (16, FLOAT)];

/// Both forms, and both sources of the first. Spread differs between the channels: pixels to subpixels.
fn forms() -> [(&'static str, Water); 3] {
    let form = |name, model: ScatterModel, source| {
        let scatter = ForwardScatter {
            spread_px_per_m: Some([0.9, 0.3, 0.04]),
            spread_offset_px: Some([0.0, 0.5, 0.1]),
            source,
            g_per_m: Some([0.13, 0.042, 0.0315]),
            ..model.into()
        };
        let request = Medium::from(Optics {
            beam_attenuation_per_m: Some([0.37, 0.12, 0.09]),
            backscatter_attenuation_per_m: Some([0.25, 0.12, 0.11]),
            veiling_light: Some([0.03, 0.12, 0.18]),
            forward_scatter: Some(scatter),
            ..Optics::default()
        });
        (name, Water::resolve(&request, 500.0).expect("a consistent water"))
    };
    [
        form("jaffe", ScatterModel::Jaffe, ScatterSource::Radiance),
        form(
            "jaffe of direct light",
            ScatterModel::Jaffe,
            ScatterSource::Direct,
        ),
        form("simplified", ScatterModel::Simplified, ScatterSource::Radiance),
    ]
}

/// Two kernels, of both laws, alone and behind gates.
fn wide_forms() -> Vec<(&'static str, Water)> {
    let form = |name, phase, layers| {
        let optics = Optics {
            absorption_per_m: Some([0.35, 0.08, 0.06]),
            scattering_per_m: Some([0.2, 0.22, 0.5]),
            veiling_light: Some([0.03, 0.12, 0.18]),
            phase,
            ..Optics::default()
        };
        let medium = Medium {
            kernels: Kernels::Two,
            layers,
            ..optics.into()
        };
        (name, Water::resolve(&medium, 40.0).expect("a consistent water"))
    };
    vec![
        form("two kernels", PhaseFunction::Ff, None),
        form("two kernels of hg", PhaseFunction::Hg, None),
        form("gated, two layers", PhaseFunction::Ff, Some(2)),
        form("gated, four layers", PhaseFunction::Hg, Some(4)),
    ]
}

fn fast(
    radiance: &Rgb<f32>,
    range: &Plane<f32>,
    optics: &Water,
    fidelity: Fidelity,
    cache: &mut KernelCache,
) -> Layers {
    let plan = Plan::for_water(&SceneBounds::measure(radiance, range, optics), optics, fidelity);
    water(radiance, range, optics, &plan, cache).expect("a good frame")
}

fn reference(radiance: &Rgb<f32>, range: &Plane<f32>, optics: &Water) -> Layers<f64> {
    water_reference(&radiance.map(|&j| j.into()), &range.map(|&z| z.into()), optics).expect("a small frame")
}

/// The largest difference in any layer; NaN counts as infinite.
fn largest_error(fast: &Layers, exact: &Layers<f64>) -> f64 {
    assert_eq!(fast.holes, exact.holes);
    let layers = [
        (&fast.direct, &exact.direct),
        (&fast.forward_scatter, &exact.forward_scatter),
        (&fast.backscatter, &exact.backscatter),
        (&fast.scattered, &exact.scattered),
    ];
    let planes = layers
        .into_iter()
        .flat_map(|(fast, exact)| fast.planes().iter().zip(exact.planes()));
    let samples = planes.flat_map(|(fast, exact)| fast.data().iter().zip(exact.data()));
    samples
        .map(|(&f, e)| (f64::from(f) - e).abs())
        .fold(0.0, |worst, e| if e <= worst { worst } else { e })
}

/// Runs every scene, form and size, and returns all errors above the limit.
fn sweep(
    scenes: &[Scene],
    forms: &[(&str, Water)],
    sizes: &[(usize, usize)],
    cases: impl Fn(&Scene, &Rgb<f32>) -> Vec<(Fidelity, f64)>,
) -> Vec<String> {
    let mut failures = Vec::new();
    let mut cache = KernelCache::new();
    for scene in scenes {
        for &(width, height) in sizes {
            let (radiance, range) = scene.sized(width, height);
            for (form, optics) in forms {
                let exact = reference(&radiance, &range, optics);
                for (fidelity, limit) in cases(scene, &radiance) {
                    let layers = fast(&radiance, &range, optics, fidelity, &mut cache);
                    let error = largest_error(&layers, &exact);
                    if error.is_nan() || error > limit {
                        let name = scene.name;
                        failures.push(format!(
                            "{name}, {form}, {width}×{height}, {fidelity:?}: {error:.2e} > {limit:.1e}"
                        ));
                    }
                    cache.recycle(layers);
                }
            }
        }
    }
    failures
}

#[test]
fn fast_is_the_reference_within_what_its_number_of_kernels_allows() {
    let moderate: Vec<Scene> = SCENES.into_iter().filter(|scene| scene.is_moderate).collect();
    assert!(moderate.len() >= 4);
    let failures = sweep(&moderate, &forms(), &SIZES, |_, _| {
        BY_TERMS
            .iter()
            .map(|&(terms, limit)| (Fidelity::Terms(terms), limit + FLOAT))
            .collect()
    });
    assert!(failures.is_empty(), "{failures:#?}");
}

#[test]
fn fast_is_the_reference_within_the_tolerance_in_every_scene() {
    let failures = sweep(&SCENES, &forms(), &SIZES, |_, radiance| {
        within([1e-2, 1e-3, 3e-4, 1e-5].as_slice(), radiance)
    });
    assert!(failures.is_empty(), "{failures:#?}");
}

/// Rounding at gates and in fills behind them, relative to the rest.
const GATE_ROUNDING: f64 = 1.0;

#[test]
fn two_kernels_and_gates_are_the_reference_within_the_tolerance_in_every_scene() {
    let failures = sweep(
        &SCENES,
        &wide_forms(),
        &SIZES[..SIZES.len() - 1],
        |_, radiance| {
            let cases = within([3e-3, 3e-4, 3e-5].as_slice(), radiance).into_iter();
            let rounding = |(fidelity, limit)| (fidelity, limit + GATE_ROUNDING * FLOAT);
            cases.map(rounding).collect()
        },
    );
    assert!(failures.is_empty(), "{failures:#?}");
}

/// Tolerances, each with the rounding of light of this brightness.
fn within(tolerances: &[f64], radiance: &Rgb<f32>) -> Vec<(Fidelity, f64)> {
    let light = radiance.planes().iter().flat_map(Plane::data);
    let float = FLOAT * f64::from(light.copied().fold(1.0, f32::max));
    let case = |&tolerance: &f64| (Fidelity::Tolerance(tolerance), tolerance + float);
    tolerances.iter().map(case).collect()
}

#[test]
fn what_a_thread_computed_before_changes_no_bit() {
    let mut used = KernelCache::new();
    for scene in SCENES {
        for (form, optics) in forms() {
            let (radiance, range) = scene.sized(31, 8);
            let first = fast(
                &radiance,
                &range,
                &optics,
                Fidelity::Terms(5),
                &mut KernelCache::new(),
            );
            let (other_radiance, other_range) = scene.sized(13, 17);
            let other = fast(
                &other_radiance,
                &other_range,
                &optics,
                Fidelity::Terms(5),
                &mut used,
            );
            used.recycle(other);
            let again = fast(&radiance, &range, &optics, Fidelity::Terms(5), &mut used);
            assert_eq!(again, first, "{}, {form}", scene.name);
            used.recycle(again);
        }
    }
}

#[test]
fn the_kind_of_hole_changes_no_bit() {
    for (form, optics) in forms() {
        let (radiance, range) = scenes::HOLES.sized(31, 8);
        let kinds = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, -3.0, 5e-4];
        let results = kinds.map(|kind| {
            let range = range.map(|&z| if z.is_finite() { z } else { kind });
            fast(
                &radiance,
                &range,
                &optics,
                Fidelity::Terms(6),
                &mut KernelCache::new(),
            )
        });
        assert!(results[0].holes > 0);
        assert!(results.windows(2).all(|pair| pair[0] == pair[1]), "{form}");
        let all_finite = |layer: &Rgb<f32>| {
            layer
                .planes()
                .iter()
                .all(|p| p.data().iter().all(|v| v.is_finite()))
        };
        assert!(all_finite(&results[0].scattered), "{form}");
    }
}
