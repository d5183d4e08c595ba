//! Lamps placed against the bounds of rounding: all but touching a surface, grazing it, at the edge of their cone, far away, very
//! bright, seen by a camera that looks far off its axis.

use imaging::geometry::Intrinsics;
use imaging::random::Stream;
use imaging::{Plane, Rgb};
use optics::lamp::{
    self, Airlight, GlowPhase, LAMP_RADIUS_M, Lamp, Lighting, REFERENCE_NODES, backscatter_fraction,
};
use optics::plan::ErrorBound;
use optics::snow::World;
use optics::turbidity::Field;
use spec::Turbidity;

use crate::errors::{peak, worst};

const SIZE: (usize, usize) = (37, 9);
const FRAMES: u64 = 140;
/// For multiple scattering, whose reference is slow.
const MULTIPLE_FRAMES: u64 = 40;

/// Frames of several blocks of pixels, and how much of them is compared.
const WIDE: (usize, usize) = (101, 59);
const WIDE_FRAMES: u64 = 150;
const WIDE_PIXELS: u64 = 40;

pub(crate) struct Case {
    pub(crate) range: Plane<f32>,
    pub(crate) lighting: Lighting,
}

pub(crate) fn case(seed: u64, multiple: bool) -> Case {
    let stream = Stream::stage(seed, "lamps");
    let unit = |what: u64| stream.unit(0, what);
    let between = |what: u64, least: f64, most: f64| least + (most - least) * unit(what);
    let scaled = |what: u64, least: f64, most: f64| least * (most / least).powf(unit(what));
    let camera = Intrinsics {
        focal_px: scaled(0, 8.0, 4000.0),
        cx: if unit(1) < 0.5 {
            18.0
        } else {
            between(2, -900.0, 900.0)
        },
        cy: 4.0,
    };
    let (nearest, slope) = (scaled(3, 0.01, 300.0), between(4, 0.0, 0.2));
    let range = Plane::from_fn(SIZE.0, SIZE.1, |x, y| {
        let noise = 1.0 + 0.05 * unit(100 + (y * SIZE.0 + x) as u64);
        let step = if unit(5) < 0.5 && x > 20 { 3.0 } else { 1.0 };
        let hole = unit(6) < 0.3 && (x * y) % 11 == 3;
        if hole {
            f32::NAN
        } else {
            (nearest * step * noise * (1.0 + slope * x as f64)) as f32
        }
    });
    let lamps = (0..=u64::from(unit(7) < 0.3)).map(|lamp| {
        let draw = |what: u64| unit(20 + 20 * lamp + what);
        let pixel = (
            (draw(0) * SIZE.0 as f64) as usize,
            (draw(1) * SIZE.1 as f64) as usize,
        );
        let z = f64::from(range.pixel(pixel.0, pixel.1));
        let z = if z.is_nan() { nearest } else { z };
        let ray = [
            (pixel.0 as f64 - camera.cx) / camera.focal_px,
            (pixel.1 as f64 - camera.cy) / camera.focal_px,
            1.0,
        ];
        let length = ray.iter().map(|v| v * v).sum::<f64>().sqrt();
        let surface = ray.map(|v| v / length * z);
        let away = 1e-3 * 1e6f64.powf(draw(2));
        let offset = [3, 4, 5].map(|what| (2.0 * draw(what) - 1.0) * away);
        let place = [0, 1, 2].map(|i| (surface[i] + offset[i]).clamp(-999.0, 999.0));
        let intensity = [0.5, 1.0, 0.7].map(|tint| tint * 1e-3 * 1e9f64.powf(draw(6)));
        if draw(7) < 0.4 {
            return Lamp::point(place, intensity).unwrap();
        }
        let cone_deg = 0.5 * 180f64.powf(draw(8));
        // Turned from the surface by about the angle of the cone.
        let tilt = cone_deg.to_radians() * (0.8 + 0.4 * draw(9));
        let [dx, dy, dz] = [0, 1, 2].map(|i| surface[i] - place[i]);
        let (sin, cos) = tilt.sin_cos();
        let direction = [dx * cos - dz * sin, dy, dx * sin + dz * cos];
        let longest = direction.iter().fold(0.0f64, |most, v| most.max(v.abs()));
        if longest < 1e-6 {
            return Lamp::point(place, intensity).unwrap();
        }
        Lamp::spot(place, intensity, direction.map(|v| v / longest), cone_deg).unwrap()
    });
    let scattering = scaled(8, 0.01, 10.0);
    let patches = Turbidity {
        contrast: between(9, 0.1, 0.95),
        scale_m: scaled(10, 0.05, 20.0),
    };
    let world = World { seed, index: 0 };
    Case {
        lighting: Lighting {
            lamps: lamps.collect(),
            radius_m: LAMP_RADIUS_M,
            camera,
            attenuation: [1.5, 1.1, 1.2].map(|c| c * scattering),
            scattering: [scattering; 3],
            absorption: multiple.then(|| [0.5, 0.1, 0.2].map(|a| a * scattering)),
            phase: phase(between(11, -0.3, 0.98), unit(13)),
            patches: (unit(12) < 0.3).then(|| Field::new(&patches, world)),
        },
        range,
    }
}

/// Of some frames one that rises toward the back.
fn phase(asymmetry: f64, unit: f64) -> GlowPhase {
    if unit < 0.4 {
        GlowPhase::fournier_forand(backscatter_fraction(asymmetry))
    } else {
        GlowPhase::henyey_greenstein(asymmetry)
    }
}

pub(crate) fn exact(range: &Plane<f32>) -> Plane<f64> {
    range.map(|&z| f64::from(z))
}

/// The largest error of all frames as a share of its bound.
fn closest(bounds_and_errors: impl Iterator<Item = (u64, f64, f64)>) -> f64 {
    let mut closest = 0.0f64;
    for (seed, bound, error) in bounds_and_errors {
        assert!(error <= bound, "frame {seed}: {error:e} above {bound:e}");
        closest = closest.max(error / bound.max(f64::MIN_POSITIVE));
    }
    closest
}

#[test]
fn no_light_on_surfaces_errs_by_more_than_its_rounding() {
    for multiple in [false, true] {
        let frames = (0..FRAMES).map(|seed| {
            let Case { range, lighting } = case(seed, multiple);
            let normals = lamp::normals_of(&range, &lighting.camera);
            let fast = lamp::irradiance(&range, &normals, &lighting);
            let error = worst(
                &fast.light,
                &lamp::irradiance_reference(&exact(&range), &normals, &lighting),
            );
            (seed, fast.rounding, error)
        });
        let closest = closest(frames);
        assert!(closest > 0.03, "the lamps are no attack: {closest}");
    }
}

#[test]
fn no_glow_errs_by_more_than_its_nodes_and_its_rounding() {
    // With the smaller one the quadrature error is small compared with the rounding.
    for (tolerance, multiple) in [(7.5e-5, false), (1e-12, false), (7.5e-5, true), (1e-12, true)] {
        let frames = if multiple { MULTIPLE_FRAMES } else { FRAMES };
        let frames = (0..frames).map(|seed| {
            let Case { range, lighting } = case(seed, multiple);
            let reference = lamp::airlight_reference(&exact(&range), &lighting, REFERENCE_NODES);
            let fast = lamp::airlight(&range, &lighting, tolerance);
            let error = worst(&fast.light, &reference);
            (seed, fast.left + fast.rounding, error)
        });
        let closest = closest(frames.collect::<Vec<_>>().into_iter());
        // The bound of sums of more than one kind of light is at least three times their error.
        let least = if multiple { 0.1 } else { 0.3 };
        assert!(closest > least, "{closest}");
    }
}

/// Rounding of light up to this to f32, with a margin for the reference.
fn sample_rounding(light: f64) -> f64 {
    6.1e-8 * light + 2e-38
}

#[test]
fn airlight_stays_within_a_rounding_that_f32_would_exceed() {
    for seed in 0..FRAMES {
        let Case { range, lighting } = case(seed, false);
        let reference = lamp::airlight_reference(&exact(&range), &lighting, REFERENCE_NODES);
        let limit = 1e-3 * lamp::airlight(&range, &lighting, 1e-4).rounding;
        let fast = lamp::airlight_within(limit, &range, &lighting, ErrorBound::absolute(1e-4));
        let (error, most) = (
            worst(&fast.light, &reference),
            limit.max(sample_rounding(peak(&reference))),
        );
        assert!(
            error <= fast.left + fast.rounding && fast.rounding <= most,
            "frame {seed}: {error:e} {most:e}"
        );
    }
}

#[test]
fn surfaces_in_f64_err_by_no_more_than_a_sample_rounds() {
    let planes = |light: &Rgb<f64>| light.planes().each_ref().map(|plane| plane.data().to_vec());
    for (seed, multiple) in (0..FRAMES).flat_map(|seed| [(seed, false), (seed, true)]) {
        let Case { range, lighting } = case(seed, multiple);
        let normals = lamp::normals_of(&range, &lighting.camera);
        let reference = lamp::irradiance_reference(&exact(&range), &normals, &lighting);
        let in_f32 = lamp::irradiance(&range, &normals, &lighting).light;
        // The first of two tiles, which is 32 pixels wide.
        let fast = lamp::irradiance_in_tiles(&[true, false], &range, &normals, &lighting).light;
        for (channel, exact) in planes(&reference).iter().enumerate() {
            for (at, exact) in exact.iter().enumerate() {
                let (x, y) = (at % SIZE.0, at / SIZE.0);
                let sample = fast.planes()[channel].pixel(x, y);
                if x >= 32 {
                    assert_eq!(sample, in_f32.planes()[channel].pixel(x, y));
                    continue;
                }
                let error = (f64::from(sample) - exact).abs();
                assert!(
                    error <= sample_rounding(*exact),
                    "frame {seed} at {x}, {y}: {error:e} of {exact:e}"
                );
            }
        }
    }
}

/// Lamps in frames wide enough for interpolating their light between rays of every spacing: narrow cones, lamps in view, thin bars
/// between the rays.
pub(crate) fn wide_case(seed: u64) -> Case {
    let stream = Stream::stage(seed, "rays");
    let unit = |what: u64| stream.unit(0, what);
    let between = |what: u64, least: f64, most: f64| least + (most - least) * unit(what);
    let scaled = |what: u64, least: f64, most: f64| least * (most / least).powf(unit(what));
    let far = scaled(0, 0.5, 20.0);
    let bar = (between(1, 0.0, 90.0) as usize, 1 + (4.0 * unit(2)) as usize);
    let range = Plane::from_fn(WIDE.0, WIDE.1, |x, y| {
        let slope = 1.0 + 0.01 * (x as f64 - 0.7 * y as f64);
        let is_near = (bar.0..bar.0 + bar.1).contains(&x) || (bar.0 / 2..bar.0 / 2 + bar.1).contains(&y);
        let hole = unit(3) < 0.3 && (x + y) % 23 == 3;
        match (hole, is_near) {
            (true, _) => f32::NAN,
            (_, true) => (0.3 * far * slope) as f32,
            _ => (far * slope) as f32,
        }
    });
    let camera = Intrinsics::centered(scaled(4, 10.0, 1500.0), WIDE.0, WIDE.1);
    let lamps = (0..=u64::from(unit(5) < 0.3)).map(|lamp| {
        let draw = |what: u64| unit(20 + 20 * lamp + what);
        let aside = |what: u64| (2.0 * draw(what) - 1.0) * WIDE.0 as f64 / camera.focal_px;
        // In front of the camera, or next to it.
        let z = if draw(0) < 0.5 { far * draw(1) } else { 0.0 };
        let place = [aside(2), aside(3), 0.0]
            .map(|v| v * z.max(0.3 * far))
            .map(|v| v.clamp(-50.0, 50.0));
        let place = [place[0], place[1], z];
        let cone_deg = 0.5 * 120f64.powf(draw(4));
        let target = [aside(5) * far, aside(6) * far, far];
        let way = [0, 1, 2].map(|i| target[i] - place[i]);
        let longest = way.iter().fold(1e-6f64, |most, v| most.max(v.abs()));
        let intensity = [0.5, 1.0, 0.7].map(|tint| tint * 0.03 * 1e4f64.powf(draw(7)) * far);
        if draw(8) < 0.25 {
            Lamp::point(place, intensity).unwrap()
        } else {
            Lamp::spot(place, intensity, way.map(|v| v / longest), cone_deg).unwrap()
        }
    });
    let scattering = scaled(8, 0.1, 3.0) / far;
    let patches = Turbidity {
        contrast: between(9, 0.1, 0.95),
        scale_m: scaled(10, 0.1, 5.0),
    };
    Case {
        lighting: Lighting {
            lamps: lamps.collect(),
            radius_m: LAMP_RADIUS_M,
            camera,
            attenuation: [1.5, 1.1, 1.2].map(|c| c * scattering),
            scattering: [1.0, 0.9, 0.95].map(|b| b * scattering),
            absorption: Some([0.5, 0.2, 0.25].map(|a| a * scattering)),
            phase: phase(between(11, 0.5, 0.97), unit(13)),
            patches: (unit(12) < 0.2).then(|| Field::new(&patches, World { seed, index: 0 })),
        },
        range,
    }
}

/// The largest error of some pixels of a frame over `left + rounding` and this share of their light. The reference is slow: each
/// pixel is compared as a separate frame.
fn largest_ratio(seed: u64, Case { range, lighting }: &Case, fast: &Airlight, share: f64) -> f64 {
    let stream = Stream::stage(seed, "pixels");
    let ratios = (0..WIDE_PIXELS).flat_map(|pixel| {
        let at = |what: u64, count: usize| (stream.unit(pixel, what) * count as f64) as usize;
        let (x, y) = (at(0, WIDE.0), at(1, WIDE.1));
        let mut single = lighting.clone();
        single.camera.cx -= x as f64;
        single.camera.cy -= y as f64;
        let own = Plane::filled(1, 1, f64::from(range.pixel(x, y)));
        let exact = lamp::airlight_reference(&own, &single, REFERENCE_NODES).pixel(0, 0);
        let channels = fast.light.pixel(x, y).into_iter().zip(exact);
        channels
            .map(|(got, exact)| (f64::from(got) - exact).abs() / (fast.left + fast.rounding + share * exact))
    });
    ratios.fold(0.0, f64::max)
}

#[test]
fn no_spread_light_between_rays_errs_by_more_than_it_says() {
    let ratios = (0..WIDE_FRAMES).map(|seed| {
        let case = wide_case(seed);
        let fast = lamp::airlight(&case.range, &case.lighting, 1e-4);
        largest_ratio(seed, &case, &fast, 0.0)
    });
    let closest = ratios.fold(0.0, f64::max);
    assert!(0.2 < closest && closest <= 1.0, "{closest}");
}

/// With next to no absolute tolerance the share decides which rays suffice.
#[test]
fn no_spread_light_errs_by_more_than_its_tolerated_share() {
    for (absolute, relative) in [(1e-7, 2e-3), (1e-9, 0.05)] {
        let (mut closest, mut without) = (0.0f64, 0.0f64);
        for seed in 0..WIDE_FRAMES / 2 {
            let case = wide_case(seed);
            let tolerance = ErrorBound { absolute, relative };
            let fast = lamp::airlight_within(f64::INFINITY, &case.range, &case.lighting, tolerance);
            closest = closest.max(largest_ratio(seed, &case, &fast, relative));
            without = without.max(largest_ratio(seed, &case, &fast, 0.0));
        }
        assert!(0.1 < closest && closest <= 1.0, "{relative}: {closest}");
        assert!(without > 1.0, "no frame uses the share: {without}");
    }
}

/// Four lamps next to the camera before a slope: the rounding of f32 is thousands of times below the light, and so is the bound.
#[test]
fn the_rounding_of_an_ordinary_frame_is_a_millionth_of_its_light() {
    let range = Plane::from_fn(64, 48, |x, y| 2.0 + 0.02 * x as f32 + 0.03 * y as f32);
    let lamps = [[-0.4, 0.2], [0.4, 0.2], [-0.4, -0.2], [0.4, -0.2]];
    let lighting = Lighting {
        lamps: lamps
            .map(|[x, y]| Lamp::point([x, y, 0.0], [2.0; 3]).unwrap())
            .into(),
        radius_m: LAMP_RADIUS_M,
        camera: Intrinsics::centered(60.0, 64, 48),
        attenuation: [0.5, 0.3, 0.3],
        scattering: [0.2; 3],
        absorption: None,
        phase: GlowPhase::henyey_greenstein(0.9),
        patches: None,
    };
    let normals = lamp::normals_of(&range, &lighting.camera);
    let fast = lamp::irradiance(&range, &normals, &lighting);
    let radiance = Rgb::from_fn(64, 48, |_, _| [0.5f32; 3]);
    let lit = lamp::lit(&radiance, [1.0; 3], &fast.light);
    let rounding = lamp::lit_rounding(&radiance, &lit, fast.rounding);
    assert!(rounding < 2e-6, "{rounding:e}");
}
