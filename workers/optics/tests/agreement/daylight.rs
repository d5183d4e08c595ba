//! Water whose veil depends on the direction, against its reference and the bounds of its plans.

use imaging::geometry::Intrinsics;
use optics::daylight::{DaylightModel, Gaze, Sun};
use optics::forward_scatter::KernelCache;
use optics::medium::Medium;
use optics::plan::{Plan, SceneBounds};
use optics::water::Water;
use spec::{Fidelity, Optics, ScatterModel};

use super::scenes::SCENES;
use super::{fast, largest_error, reference};

/// Up in the camera's axes: level, looking up into the window, down, and rolled.
const UPS: [[f64; 3]; 4] = [
    [0.0, -1.0, 0.0],
    [0.0, -0.6, 0.8],
    [0.1, -0.5, -0.9],
    [0.7, -0.7, 0.2],
];

/// The reference of forward scatter is slow.
const FEW_SIZES: [(usize, usize); 4] = [(1, 1), (1, 7), (13, 17), (31, 8)];

struct Place {
    backscatter_fraction: f64,
    depth_m: f64,
    sun_share: f64,
}

fn lit(model: ScatterModel, place: &Place) -> Water {
    let medium = Medium {
        depth_m: Some(place.depth_m),
        range_scale: 1.3,
        daylight: Some(DaylightModel {
            sun_share: place.sun_share,
            sun: Sun {
                elevation_deg: 50.0,
                azimuth_deg: 100.0,
                casts_shadows: false,
            },
            ..DaylightModel::default()
        }),
        ..Medium::from(Optics {
            absorption_per_m: Some([0.35, 0.08, 0.06]),
            scattering_per_m: Some([0.2, 0.22, 0.5]),
            backscatter_fraction: Some(place.backscatter_fraction),
            forward_scatter: Some(model.into()),
            ..Optics::default()
        })
    };
    Water::resolve(&medium, 30.0).unwrap()
}

fn seen(water: &Water, up: [f64; 3], (width, height): (usize, usize)) -> Water {
    let camera = Intrinsics::centered(0.7 * width.max(height) as f64, width, height);
    water.seen_by(Gaze::new(camera, (width, height), up))
}

/// Waters with and without sun; the last two have nearly the least and the largest backscatter, so the steepest and the flattest fields.
fn forms() -> Vec<Water> {
    [
        (ScatterModel::None, 0.0183, 6.0, 0.0),
        (ScatterModel::Jaffe, 0.0183, 2.0, 0.7),
        (ScatterModel::Simplified, 0.0183, 9.0, 0.9),
        (ScatterModel::Jaffe, 0.002, 0.0, 0.4),
        (ScatterModel::None, 0.5, 11_000.0, 0.6),
    ]
    .map(|(model, backscatter_fraction, depth_m, sun_share)| {
        let place = Place {
            backscatter_fraction,
            depth_m,
            sun_share,
        };
        lit(model, &place)
    })
    .into()
}

#[test]
fn a_veil_by_direction_is_the_reference_within_the_bound_of_every_plan() {
    let mut failures = Vec::new();
    let mut cache = KernelCache::new();
    for scene in SCENES {
        for size in FEW_SIZES {
            let (radiance, range) = scene.sized(size.0, size.1);
            for (form, up) in forms().iter().flat_map(|form| UPS.map(|up| (form, up))) {
                let optics = seen(form, up, size);
                let exact = reference(&radiance, &range, &optics);
                for tolerance in [1e-1, 3e-4] {
                    let fidelity = Fidelity::Tolerance(tolerance);
                    let plan = Plan::for_water(
                        &SceneBounds::measure(&radiance, &range, &optics),
                        &optics,
                        fidelity,
                    );
                    let layers = fast(&radiance, &range, &optics, fidelity, &mut cache);
                    let error = largest_error(&layers, &exact);
                    let brightest = exact.scattered.planes().iter().flat_map(|plane| plane.data());
                    let brightest = brightest.copied().fold(0.0, f64::max);
                    let bounds = plan.errors().map(|error| error.bound_sample(brightest));
                    let bound = bounds.into_iter().fold(0.0, f64::max);
                    let promise = plan.promise().unwrap();
                    let is_silent = promise.bound > tolerance && promise.exceeds.is_none();
                    if error.is_nan() || error > bound || is_silent {
                        failures.push(format!(
                            "{}, {size:?}, {up:?}, {tolerance}: {error:.2e} > {bound:.2e}",
                            scene.name
                        ));
                    }
                    cache.recycle(layers);
                }
            }
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

/// Each thread has a separate cache and frame, all at the same time.
#[test]
fn threads_change_no_bit_of_a_veil_by_direction() {
    let (radiance, range) = SCENES[4].sized(72, 41);
    let optics = seen(&forms()[1], UPS[1], (72, 41));
    let render = || {
        fast(
            &radiance,
            &range,
            &optics,
            Fidelity::Tolerance(3e-4),
            &mut KernelCache::new(),
        )
    };
    let alone = render();
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..4).map(|_| scope.spawn(render)).collect();
        for thread in threads {
            assert_eq!(thread.join().unwrap(), alone);
        }
    });
}
