use imaging::geometry::Intrinsics;
use optics::chain;
use optics::forward_scatter::KernelCache;
use optics::medium::Medium;
use optics::plan::{Plan, SceneBounds};
use optics::water::Water;
use spec::Fidelity;
use spec::Optics;

use super::*;

/// Large enough that the hybrid solves only a part at full size.
const SIZE: (usize, usize) = (547, 353);
const WATERS: [&str; 3] = ["jerlov-IB", "jerlov-1C", "jerlov-3C"];
const SEEDS: std::ops::Range<u64> = 0..12;
const OTHER_LIGHT: u64 = 21;

/// A scene of its family in one of the waters.
fn frame(seed: u64) -> Rgb8 {
    let focal_px = SIZE.0 as f64 / (2.0 * 40f64.to_radians().tan());
    let camera = Intrinsics::centered(focal_px, SIZE.0, SIZE.1);
    let family = scenes::FAMILIES[seed as usize % scenes::FAMILIES.len()];
    let scene = scenes::procedural(family, seed, SIZE.0, SIZE.1, camera).unwrap();
    let request = Medium::from(Optics {
        preset: Some(WATERS[seed as usize % WATERS.len()].to_owned()),
        ..Optics::default()
    });
    let water = Water::resolve(&request, focal_px).unwrap();
    let range = scene.range.unwrap();
    let stats = SceneBounds::measure(&scene.radiance, &range, &water);
    let plan = Plan::for_water(&stats, &water, Fidelity::Tolerance(3e-4));
    let layers = chain::water(&scene.radiance, &range, &water, &plan, &mut KernelCache::new());
    transfer::encode_rgb8(&layers.unwrap().scattered).0
}

/// Minimum share of the frames of [`SEEDS`] whose candidates the hybrid keeps: all but one. It keeps those of all frames, the guided
/// filter those of ten.
const KEPT: f64 = 0.9;

#[test]
fn the_hybrid_keeps_the_candidates_of_the_exact_form() {
    let away = |picture: &Rgb8, form| {
        let [got, exact] =
            [form, IblaRefinement::Matting].map(|form| candidates(picture, form, Variant::Fast));
        apart(&got, &exact)
    };
    let away: Vec<f64> = SEEDS
        .map(|seed| away(&frame(seed), IblaRefinement::Hybrid))
        .collect();
    let kept = away.iter().filter(|&&apart| apart <= SAME).count();
    assert!(kept as f64 >= KEPT * away.len() as f64, "{away:?}");
}

#[test]
fn a_form_that_finds_another_light_is_told_from_the_exact_one() {
    // The guided filter does not keep the candidates of this frame.
    let outcomes = compare(&frame(OTHER_LIGHT)).unwrap();
    let [exact, hybrid, guided] = outcomes;
    assert_eq!((exact.apart, exact.distance), (0.0, 0.0));
    assert!(hybrid.is_kept() && !guided.is_kept(), "{outcomes:?}");
    assert!(
        0.0 < hybrid.distance && hybrid.distance < guided.distance,
        "{outcomes:?}"
    );
    let table = markdown(&outcomes);
    assert!(
        table.contains("| ibla | 1 | 100.0 % | 0.0e0 |") && table.contains("| ibla_guided | 1 | 0.0 % |"),
        "{table}"
    );
}

#[test]
fn the_page_has_the_distances_that_methods_are_chosen_by() {
    let page = include_str!("../../../docs/science/enhancement.md");
    for form in [IblaRefinement::Hybrid, IblaRefinement::Guided] {
        let row = format!("| {} |", form.name());
        let of_form = page.lines().filter(|line| line.starts_with(&row));
        let distance = format!("| {:.1e} |", form.method().distance());
        assert!(
            of_form.clone().any(|line| line.contains(&distance)),
            "{distance} of {row}"
        );
    }
}

#[test]
fn the_share_counts_candidates_that_differ_by_a_hundredth_at_most() {
    let outcome = |form, apart| Outcome {
        form,
        apart,
        distance: 0.0,
        ms: 1.0,
    };
    let outcomes = [
        outcome(IblaRefinement::Hybrid, 0.01),
        outcome(IblaRefinement::Hybrid, 0.011),
        outcome(IblaRefinement::Guided, 0.5),
    ];
    assert_eq!(share_kept(&outcomes, IblaRefinement::Hybrid), Some(0.5));
    assert_eq!(share_kept(&outcomes, IblaRefinement::Guided), Some(0.0));
    assert_eq!(share_kept(&outcomes, IblaRefinement::Matting), None);
    let sorted: Vec<f64> = (1..=20).map(f64::from).collect();
    assert_eq!(
        [0.0, 0.5, 0.95, 1.0].map(|share| at(&sorted, share)),
        [1.0, 10.0, 19.0, 20.0]
    );
}
