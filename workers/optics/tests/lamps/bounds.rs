//! The bounds that a plan is made of, against the light: that of the fast form and that of the reference.

use imaging::{Plane, Rgb};
use optics::lamp::{self, REFERENCE_NODES};
use optics::plan::ErrorBound;
use optics::visible_bounds::{TILE_PX, VisibleBounds};

use crate::attack::{Case, case, exact};

const FRAMES: u64 = 100;
const MULTIPLE_FRAMES: u64 = 30;

/// Shares of their bounds that the largest error and the largest light of a frame have.
#[derive(Clone, Copy)]
struct Shares {
    light: f64,
    rounding: f64,
}

/// The median and the largest of some shares.
fn spread_of(mut shares: Vec<f64>) -> (f64, f64) {
    shares.retain(|share| *share > 0.0);
    shares.sort_by(f64::total_cmp);
    let most = shares.last().copied().unwrap_or(0.0);
    (shares.get(shares.len() / 2).copied().unwrap_or(0.0), most)
}

fn report(name: &str, shares: Vec<Shares>) {
    let (light, rounding) = shares.iter().map(|share| (share.light, share.rounding)).unzip();
    let (light, rounding) = (spread_of(light), spread_of(rounding));
    println!("{name}: light by its bound {light:.3?}, error by its bound {rounding:.3?}");
    assert!(light.1 <= 1.0 && rounding.1 <= 1.0, "{name}");
}

fn tile_of(view: &VisibleBounds, at: usize) -> usize {
    let (x, y) = (at % view.size.0, at / view.size.0);
    y / TILE_PX * view.columns + x / TILE_PX
}

/// The shares of the light on surfaces, tile by tile.
fn surface_shares(range: &Plane<f32>, lighting: &lamp::Lighting) -> Shares {
    let view = VisibleBounds::measure_range(range, &lighting.camera);
    let bounds = lamp::bound_irradiance(lighting, &view);
    let normals = lamp::normals_of(range, &lighting.camera);
    let fast = lamp::irradiance(range, &normals, lighting);
    let reference = lamp::irradiance_reference(&exact(range), &normals, lighting);
    let mut shares = Shares {
        light: 0.0,
        rounding: 0.0,
    };
    for channel in 0..3 {
        let samples = fast.light.planes()[channel].data().iter();
        for (at, (&fast, &exact)) in samples.zip(reference.planes()[channel].data()).enumerate() {
            let tile = tile_of(&view, at);
            let (light, fast) = (bounds.irradiance[tile][channel], f64::from(fast));
            let error = (fast - exact).abs();
            assert!(
                fast <= light && exact <= light,
                "{fast:e} and {exact:e} above {light:e}"
            );
            assert!(
                error <= bounds.rounding[tile],
                "{error:e} above {:e}",
                bounds.rounding[tile]
            );
            shares.light = shares.light.max(exact / light.max(1e-300));
            shares.rounding = shares.rounding.max(error / bounds.rounding[tile].max(1e-300));
        }
    }
    shares
}

/// The largest error of a sample over its bound.
fn largest_ratio(fast: &Rgb<f32>, exact: &Rgb<f64>, bound: ErrorBound) -> f64 {
    let planes = fast.planes().iter().zip(exact.planes());
    let samples = planes.flat_map(|(fast, exact)| fast.data().iter().zip(exact.data()));
    let ratios = samples
        .map(|(&fast, &exact)| ((f64::from(fast) - exact).abs(), bound.bound_sample(exact)))
        .filter(|(error, _)| *error != 0.0)
        .map(|(error, bound)| error / bound);
    ratios.fold(0.0, |most, ratio| if ratio <= most { most } else { ratio })
}

#[test]
fn light_on_surfaces_is_within_its_planned_bounds() {
    for multiple in [false, true] {
        let shares = (0..FRAMES).map(|seed| {
            let Case { range, lighting } = case(seed, multiple);
            surface_shares(&range, &lighting)
        });
        report("surfaces", shares.collect());
    }
}

#[test]
fn airlight_is_within_its_planned_bounds() {
    for (tolerance, multiple) in [(1e-4, false), (1e-12, false), (1e-4, true), (1e-12, true)] {
        let frames = if multiple { MULTIPLE_FRAMES } else { FRAMES };
        let shares = (0..frames).map(|seed| {
            let Case { range, lighting } = case(seed, multiple);
            let view = VisibleBounds::measure_range(&range, &lighting.camera);
            let bounds = lamp::bound_airlight(&lighting, &view);
            let fast = lamp::airlight(&range, &lighting, tolerance);
            let reference = lamp::airlight_reference(&exact(&range), &lighting, REFERENCE_NODES);
            let most = |i: usize| reference.planes()[i].data().iter().copied().fold(0.0, f64::max);
            let light = [0, 1, 2].map(|i| most(i) / bounds.peak[i].max(1e-300));
            let allowed = bounds.rounding.plus(ErrorBound::absolute(fast.left));
            let ratio = largest_ratio(&fast.light, &reference, allowed);
            assert!(ratio <= 1.0, "frame {seed}: {ratio} of {allowed:?}");
            assert!(light.iter().all(|share| *share <= 1.0), "frame {seed}: {light:?}");
            Shares {
                light: light.into_iter().fold(0.0, f64::max),
                rounding: ratio,
            }
        });
        report("airlight", shares.collect());
    }
}
