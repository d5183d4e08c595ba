use imaging::geometry::Intrinsics;
use optics::chain;
use optics::forward_scatter::KernelCache;
use optics::medium::Medium;
use optics::plan::{Plan, SceneBounds};
use optics::water::Water;
use spec::Fidelity;
use spec::Optics;

use super::*;

const SIZE: (usize, usize) = (547, 353);
const WATERS: [&str; 3] = ["jerlov-IB", "jerlov-1C", "jerlov-3C"];
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

#[test]
fn a_variant_that_finds_another_light_is_told_from_the_exact_one() {
    // The guided filter does not keep the candidates of this frame.
    let compared = compare(&frame(OTHER_LIGHT)).unwrap();
    assert!(!compared.is_kept && compared.distance > 0.0, "{compared:?}");
}

#[test]
fn the_page_has_the_distances_that_methods_are_chosen_by() {
    let page = include_str!("../../../docs/science/enhancement.md");
    let row = "| guided |";
    let mut rows = page.lines().filter(|line| line.starts_with(row));
    let distance = format!("| {:.1e} |", enhance::IBLA_GUIDED_DISTANCE);
    assert!(rows.any(|line| line.contains(&distance)), "{distance} of {row}");
}

#[test]
fn candidates_that_differ_by_a_hundredth_are_the_same() {
    let candidate = [[0.5; 3]; 3];
    let moved = |by: f64| [candidate[0], candidate[1], [0.5, 0.5, 0.5 + by]];
    assert!(is_same(&candidate, &moved(0.0099)) && !is_same(&candidate, &moved(0.011)));
}
