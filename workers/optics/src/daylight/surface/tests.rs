use imaging::geometry::Intrinsics;

use spec::PhaseFunction;

use super::super::WideScattering;
use super::super::field::{Fields, Place};
use super::super::gaze::Gaze;
use super::super::limits::MostLight;
use super::super::model::{Sun, SurfaceLight};
use super::*;
use crate::error_bound::ErrorBound;
use crate::visible_bounds::{TILE_PX, Tile, VisibleBounds};

/// The largest share of sunlight that reaches a surface in these tests.
const PEAK: f64 = 2.8;

pub(in crate::daylight) fn daylight(size: (usize, usize), up: [f64; 3], share: f64, depth: f64) -> Daylight {
    let camera = Intrinsics::centered(0.8 * size.0.max(size.1) as f64, size.0, size.1);
    let sun = Sun {
        elevation_deg: 35.0,
        azimuth_deg: 110.0,
        casts_shadows: true,
    };
    let sun = (share > 0.0).then(|| SunLight::new(share, &sun));
    let place = Place {
        absorption: [0.35, 0.08, 0.07],
        scattering: [0.16, 0.18, 0.2],
        depth_m: depth,
        sun,
        scale: 1.0,
        bottom: None,
    };
    let fields = Fields::new(&place, WideScattering::new(PhaseFunction::Ff, 0.0183));
    Daylight {
        surfaces: SurfaceLight::Normal,
        sun,
        rays: 16,
        caustics: None,
        draws_caustics: false,
        occludes_veil: false,
        has_shafts: false,
        scale: 1.0,
        fields: fields.channels,
        wide: fields.wide,
        depth,
        below: f64::INFINITY,
        level: [0.2, 0.9, 1.0],
        gaze: Gaze::new(camera, size, up),
    }
}

#[test]
fn both_forms_agree_within_the_bound_in_every_view() {
    for size in [(1, 1), (7, 1), (33, 21), (80, 61)] {
        let (width, height) = size;
        let range = Plane::from_fn(width, height, |x, y| match (3 * x + y) % 7 {
            0 => f32::NAN,
            1 => 1e-3,
            k => 0.3 * (x + y + k) as f32 + 0.2,
        });
        let albedo = Rgb::from_fn(width, height, |x, y| {
            [0.02, 0.3 + 0.01 * (x % 40) as f32, (y % 3) as f32]
        });
        let normals = crate::lamp::normals_of(&range, &Intrinsics::centered(20.0, width, height));
        let sunlight = Plane::from_fn(width, height, |x, y| (x * y % 5) as f32 * 0.7);
        let access = Rgb::from_fn(width, height, |x, _| [1.0, 0.5, 0.1 * (x % 9) as f32]);
        for up in [[0.0, -1.0, 0.0], [0.1, -0.7, 0.7], [0.3, -0.2, -1.0]] {
            for (share, depth) in [(0.0, 6.0), (0.7, 6.0), (1.0, 0.0), (1e-6, 90.0)] {
                for (sun, around) in [(false, false), (true, false), (false, true), (true, true)] {
                    let daylight = daylight(size, up, share, depth);
                    {
                        let reaching = Reaching {
                            sunlight: sun.then_some(&sunlight),
                            access: around.then_some(&access),
                        };
                        let exact = surfaces_reference(
                            &albedo.map(|&v| f64::from(v)),
                            &range.map(|&z| f64::from(z)),
                            &normals.each_ref().map(|axis| axis.map(|&v| f64::from(v))),
                            &daylight,
                            reaching,
                        );
                        let fast = surfaces(&albedo, &range, &normals, &daylight, reaching);
                        let view = VisibleBounds::measure(&albedo, &range, &daylight.gaze.camera);
                        let limits = limit_tiles(&daylight, &view);
                        for (c, (fast, exact)) in fast.planes().iter().zip(exact.planes()).enumerate() {
                            for (at, (fast, exact)) in fast.data().iter().zip(exact.data()).enumerate() {
                                let (x, y) = (at % width, at / width);
                                let limit = limits[y / TILE_PX * view.columns + x / TILE_PX][c];
                                let error = (f64::from(*fast) - exact).abs();
                                assert!(
                                    *exact <= limit.most && error <= limit.rounding.bound_sample(*exact),
                                    "{size:?} {up:?} {share} {depth}: {exact}, {error:e} > {limit:?}"
                                );
                            }
                        }
                    }
                }
            }
        }
    }
}

/// The largest light of a channel in a tile, and the rounding of its samples.
#[derive(Debug, Clone, Copy)]
struct Limit {
    most: f64,
    rounding: ErrorBound,
}

fn limit_tiles(daylight: &Daylight, view: &VisibleBounds) -> Vec<[Limit; 3]> {
    let [_, farthest] = view.range_m().unwrap_or_default();
    let limit = |tile: &Tile, channel: usize| {
        let reflectance = f64::from(tile.brightest[channel]);
        let heights = daylight.tile_heights(tile, None);
        let light = heights.map_or(MostLight::default(), |heights| {
            daylight.most_light(channel, heights)
        });
        let cosines = daylight.cosine_rounding(channel, light, PEAK);
        Limit {
            most: reflectance * (light.sunlit * PEAK + light.around) * (1.0 + 1e-12),
            rounding: daylight
                .rounding(farthest)
                .plus(ErrorBound::absolute(reflectance * cosines)),
        }
    };
    let tiles = view.tiles.iter();
    tiles
        .map(|tile| [0, 1, 2].map(|channel| limit(tile, channel)))
        .collect()
}

#[test]
fn deeper_is_darker_and_a_white_horizontal_patch_at_the_camera_shows_the_level() {
    let daylight = daylight((1, 1), [0.0, -1.0, 0.0], 0.0, 6.0);
    let white = Rgb::from_fn(1, 1, |_, _| [1.0; 3]);
    let facing_up = [0.0, -1.0, 0.0].map(|v| Plane::filled(1, 1, v));
    let lit = |z: f64| {
        let range = Plane::filled(1, 1, z);
        surfaces_reference(&white, &range, &facing_up, &daylight, Reaching::default()).pixel(0, 0)
    };
    for (c, v) in lit(2.0).into_iter().enumerate() {
        assert!((v - daylight.level[c]).abs() < 1e-12, "{v}");
    }
    assert_eq!(lit(f64::NAN), [0.0; 3]);
}
