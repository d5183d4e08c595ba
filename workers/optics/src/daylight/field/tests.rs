use spec::PhaseFunction;

use super::super::model::{REFRACTIVE_INDEX, Sun};
use super::*;

/// The closed form stays within this share of the radiative transfer in every direction.
const FIT: f64 = 0.08;

fn place(a: f64, b: f64, depth_m: f64, share: f64) -> Place {
    let sun = Sun {
        elevation_deg: 45.0,
        ..Sun::default()
    };
    Place {
        absorption: [a; 3],
        scattering: [b; 3],
        depth_m,
        sun: (share > 0.0).then(|| SunLight::new(share, &sun)),
        scale: 1.0,
        bottom: None,
    }
}

fn wide() -> WideScattering {
    WideScattering::new(PhaseFunction::Ff, 0.0183)
}

#[test]
fn the_critical_cosine_is_that_of_the_index() {
    let exact = (1.0 - 1.0 / REFRACTIVE_INDEX.powi(2)).sqrt();
    assert!((CRITICAL_COSINE - exact).abs() < 1e-15, "{exact:.17}");
    assert_eq!(fresnel(CRITICAL_COSINE - 1e-9), 1.0);
    assert!((fresnel(1.0) - (0.34f64 / 2.34).powi(2)).abs() < 1e-12);
}

#[test]
fn the_closed_form_is_the_radiance_of_the_transfer_along_whole_rays() {
    let exchange = Exchange::new(wide());
    for (a, b) in [
        (0.04, 0.13),
        (0.35, 0.12),
        (0.06, 0.2),
        (0.18, 0.22),
        (0.37, 1.8),
        (0.05, 1.0),
    ] {
        for depth in [1.0, 5.0, 20.0] {
            for (share, below) in [(0.0, None), (0.65, None), (0.0, Some(2.0)), (0.65, Some(6.0))] {
                let bottom = below.map(|below_m| Bottom {
                    below_m,
                    reflectance: [0.3; 3],
                });
                let place = Place {
                    bottom,
                    ..place(a, b, depth, share)
                };
                let radiance = exchange.solve(a, b, place.above(0));
                let field = Field::new(&radiance, &exchange, &place, b);
                let twice = SecondSunlight::new(&radiance, &exchange, &place, b);
                let [_, path] = twice.remove_from(&radiance);
                for (j, node) in exchange.directions.iter().enumerate() {
                    let end = if node.rise > 0.0 {
                        depth / node.rise
                    } else {
                        below.unwrap_or(1e4) / -node.rise
                    };
                    let found = field.scattered(node.rise, end) * radiance.irradiance;
                    let exact = path[j];
                    assert!(
                        (found - exact).abs() <= FIT * exact,
                        "a {a} b {b} depth {depth} sun {share} bottom {below:?} at {:.3}: {found:e} for {exact:e}",
                        node.rise
                    );
                }
            }
        }
    }
}

#[test]
fn a_white_bottom_brightens_the_water_above_it() {
    let dark = place(0.05, 0.1, 5.0, 0.5);
    let bright = Place {
        bottom: Some(Bottom {
            below_m: 2.0,
            reflectance: [0.9; 3],
        }),
        ..dark
    };
    let level = |place: &Place| Fields::new(place, wide()).channels[0].scattered(0.0, 4.0);
    assert!(level(&bright) > 1.3 * level(&dark));
}

#[test]
fn irradiance_falls_as_monte_carlo_found() {
    // K of an overcast sky for b_b/b 0.0183: sqrt(a² + 0.19 a b)/0.83, itself within 8 % of the truth.
    for (a, b) in [(0.179, 0.219), (0.1, 0.3)] {
        let fields = Fields::new(&place(a, b, 4.0 / a, 0.0), wide());
        let expected = f64::sqrt(a * a + 0.19 * a * b) / 0.83;
        let found = fields.channels[0].decay;
        assert!((found / expected - 1.0).abs() < 0.1, "{found} {expected}");
    }
}

#[test]
fn the_horizon_is_brighter_than_what_is_below_and_darker_than_the_window() {
    let fields = Fields::new(&place(0.179, 0.219, 7.0, 0.0), wide());
    let field = &fields.channels[0];
    let open = |rise: f64| {
        let end = if rise > 0.0 { 7.0 / rise } else { 1e3 };
        field.scattered(rise, end) + field.surface(rise, 7.0)
    };
    assert!(open(-0.9) < open(0.0) && open(1.0) > 20.0 * open(0.0));
    // Radiance is continuous at the edge of the window.
    let radiances: Vec<f64> = (0..400).map(|i| open(0.5 + 1e-3 * f64::from(i))).collect();
    let most = radiances
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .fold(0.0, f64::max);
    assert!(most < 0.06 * radiances[399], "{most}");
}

#[test]
fn just_below_the_surface_light_decays_and_the_horizon_shines() {
    let [mut least, mut most] = [f64::INFINITY, 0.0f64];
    for step in 0..60 {
        let depth = 1e-7 * 1.4f64.powi(step);
        let fields = Fields::new(&place(0.12, 0.19, depth, 0.4), wide());
        let Field { decay, horizon, .. } = fields.channels[0];
        assert!((0.119..0.5).contains(&decay), "{depth} m: {decay}");
        (least, most) = (least.min(horizon), most.max(horizon));
    }
    assert!(least > 0.0 && most < 10.0 * least, "{least} to {most}");
}

#[test]
fn water_that_scatters_or_absorbs_nothing_and_any_depth_have_a_field() {
    for (a, b) in [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (30.0, 100.0)] {
        for depth in [0.0, 1e-3, 50.0, 11_000.0] {
            let fields = Fields::new(&place(a, b, depth, 0.5), wide());
            let field = &fields.channels[0];
            for rise in [-1.0, -0.01, 0.0, 0.01, 0.7, 1.0] {
                let light = field.scattered(rise, 3.0) + field.surface(rise, depth);
                assert!(
                    light.is_finite() && light >= 0.0,
                    "{a} {b} {depth} {rise}: {light}"
                );
            }
            assert!(
                field.decay.is_finite() && fields.irradiance[0] >= 0.0,
                "{a} {b} {depth}: {}",
                field.decay
            );
        }
    }
}
