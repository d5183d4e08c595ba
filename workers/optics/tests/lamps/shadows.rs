//! Shadows: the fast forms against the reference, before balls and a wall.

use imaging::random::Stream;
use imaging::rays::{Cuboid, Hit, Rays};
use imaging::{Plane, Rgb};
use optics::lamp::{self, Lamp, Lighting, REFERENCE_NODES, Shadow};
use optics::lit_point::LitPoint;
use optics::plan::Casting;
use optics::visible_bounds::VisibleBounds;

use crate::errors::peak;
use crate::{ABSORPTION, FORWARD, lighting};

/// Share of samples whose rays may graze an edge, and the relative difference of the sums of light.
const GRAZING: f64 = 0.03;
const SUMS: f64 = 0.01;
/// An edge in one of 32 angles, as a share of the brightest airlight.
const ANGLE: f64 = 0.02;
/// Tolerance of the airlight as a share of its peak.
const FINE: f64 = 1e-4;
const WALL_M: f64 = 4.0;

/// Balls, by center and radius, before a wall.
struct Balls(Vec<([f64; 3], f64)>);

impl Rays for Balls {
    fn hit(&self, origin: [f64; 3], direction: [f64; 3], from: f64, to: f64) -> Option<Hit> {
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let balls = self.0.iter().filter_map(|(center, radius)| {
            let way = [0, 1, 2].map(|i| origin[i] - center[i]);
            let (half, rest) = (dot(way, direction), dot(way, way) - radius * radius);
            let square = half * half - rest;
            (square >= 0.0 && rest > 0.0).then(|| -half - square.sqrt())
        });
        let wall = (WALL_M - origin[2]) / direction[2];
        let met = balls.chain([wall]).filter(|met| (from..=to).contains(met));
        met.min_by(f64::total_cmp).map(|distance| Hit {
            distance,
            normal: direction.map(|v| -v),
            object: 0,
        })
    }

    /// Bounding spheres of the cuboids, and of the rays between them.
    fn may_occlude(&self, from: &Cuboid, to: &Cuboid) -> bool {
        let about = |cuboid: &Cuboid| {
            let middle = [0, 1, 2].map(|i| 0.5 * (cuboid.low[i] + cuboid.high[i]));
            (middle, cuboid.distances(middle)[1])
        };
        let ((from, wide), (to, width)) = (about(from), about(to));
        let way = [0, 1, 2].map(|i| to[i] - from[i]);
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        self.0.iter().any(|(center, radius)| {
            let away = [0, 1, 2].map(|i| center[i] - from[i]);
            let share = (dot(away, way) / dot(way, way)).clamp(0.0, 1.0);
            let aside = [0, 1, 2].map(|i| away[i] - share * way[i]);
            dot(aside, aside).sqrt() <= radius + wide.max(width)
        })
    }

    fn clearance(&self, place: [f64; 3]) -> f64 {
        let far = |center: &[f64; 3]| (0..3).map(|i| (center[i] - place[i]).powi(2)).sum::<f64>().sqrt();
        let balls = self.0.iter().map(|(center, radius)| far(center) - radius);
        balls.fold(WALL_M - place[2], f64::min).max(0.0)
    }
}

fn balls() -> Balls {
    Balls(vec![
        ([0.3, 0.1, 2.0], 0.35),
        ([-0.8, -0.3, 2.5], 0.25),
        ([0.9, 0.6, 1.4], 0.12),
    ])
}

fn range_of(scene: &Balls, (width, height): (usize, usize)) -> Plane<f32> {
    let camera = lighting(Vec::new(), (width, height), FORWARD).camera;
    Plane::from_fn(width, height, |x, y| {
        let ray = camera.ray(x as f64, y as f64);
        let length = ray.length();
        let hit = scene.hit([0.0; 3], <[f64; 3]>::from(ray).map(|v| v / length), 0.0, 1e3);
        hit.map_or(f32::INFINITY, |hit| hit.distance as f32)
    })
}

fn lamps() -> [Lamp; 2] {
    [
        Lamp::point([1.2, -0.4, 0.2], [2.0, 1.5, 1.0]).unwrap(),
        Lamp::spot([-0.9, 0.2, 0.1], [6.0, 6.0, 6.0], [0.25, 0.0, 1.0], 40.0).unwrap(),
    ]
}

fn lit_by(lamp: Lamp, size: (usize, usize), multiple: bool) -> Lighting {
    Lighting {
        absorption: multiple.then_some(ABSORPTION),
        ..lighting(vec![lamp], size, FORWARD)
    }
}

/// The share of samples that differ by more than `limit`, and the relative difference of their sum.
fn differences(fast: &Rgb<f32>, exact: &Rgb<f64>, limit: f64) -> (f64, f64) {
    let (mut wrong, mut count, mut sums) = (0.0, 0.0, [0.0f64; 2]);
    for (fast, exact) in fast.planes().iter().zip(exact.planes()) {
        for (fast, exact) in fast.data().iter().zip(exact.data()) {
            count += 1.0;
            wrong += f64::from(u8::from((f64::from(*fast) - exact).abs() > limit));
            sums[0] += f64::from(*fast);
            sums[1] += exact;
        }
    }
    (wrong / count, (sums[0] - sums[1]).abs() / sums[1].max(1e-12))
}

#[test]
fn shadows_on_surfaces_are_those_of_the_reference_but_at_their_edges() {
    let scene = balls();
    let forms = [
        (Shadow::Hard, 2e-4),
        (
            Shadow::Soft {
                radius_m: 0.08,
                samples: 16,
            },
            1.0 / 16.0,
        ),
    ];
    for size in [(1, 1), (17, 13), (96, 64)] {
        let range = range_of(&scene, size);
        for (lamp, multiple, (shadow, limit)) in lamps()
            .into_iter()
            .flat_map(|lamp| [(lamp, false), (lamp, true)])
            .flat_map(|(lamp, multiple)| forms.map(|form| (lamp, multiple, form)))
        {
            let lighting = lit_by(lamp.with_shadow(shadow, false), size, multiple);
            let normals = lamp::normals_of(&range, &lighting.camera);
            let exact_range = range.map(|&z| f64::from(z));
            let exact = lamp::shaded_irradiance_reference(&exact_range, &normals, &lighting, &scene);
            let fast = lamp::shaded_irradiance(&range, &normals, &lighting, (&scene, 0.0));
            // Discs of spread light are interpolated between points.
            let limit = if multiple { f64::max(limit, 0.01) } else { limit } * peak(&exact);
            let (wrong, sums) = differences(&fast.light, &exact, limit);
            assert!(
                wrong <= GRAZING,
                "{size:?} {lamp:?} {shadow:?} {multiple}: {wrong}"
            );
            assert!(sums <= SUMS, "{size:?} {lamp:?} {shadow:?} {multiple}: {sums}");
            if size.0 > 64 {
                let open = lamp::irradiance_reference(&exact_range, &normals, &lighting);
                let (_, cut_off) = differences(&fast.light, &open, limit);
                assert!(cut_off > 0.005, "nothing is in shadow: {cut_off}");
            }
        }
    }
}

#[test]
fn shadows_in_the_glow_are_those_of_the_reference_but_for_an_angle() {
    let scene = balls();
    for size in [(1, 1), (9, 7), (48, 32)] {
        let range = range_of(&scene, size);
        let exact_range = range.map(|&z| f64::from(z));
        for (lamp, multiple) in lamps().into_iter().flat_map(|lamp| [(lamp, false), (lamp, true)]) {
            let lighting = lit_by(lamp.with_shadow(Shadow::Hard, true), size, multiple);
            let exact = lamp::shaded_airlight_reference(&exact_range, &lighting, REFERENCE_NODES, &scene);
            let top = peak(&exact);
            let fast = lamp::shaded_airlight(&range, &lighting, FINE * top, &scene);
            let (wrong, sums) = differences(&fast.light, &exact, ANGLE * top);
            assert!(
                wrong <= GRAZING && sums <= SUMS,
                "{size:?} {lamp:?} {multiple}: {wrong} {sums}"
            );
        }
    }
}

#[test]
fn what_lights_less_than_is_seen_casts_no_shadow() {
    let scene = balls();
    let (size, shadow) = ((96, 64), Shadow::Hard);
    let range = range_of(&scene, size);
    let lighting = lit_by(lamps()[0].with_shadow(shadow, false), size, false);
    let normals = lamp::normals_of(&range, &lighting.camera);
    let all = lamp::shaded_irradiance(&range, &normals, &lighting, (&scene, 0.0));
    let open = lamp::irradiance(&range, &normals, &lighting);
    for unseen in [0.01, 0.05, 1e3] {
        let some = lamp::shaded_irradiance(&range, &normals, &lighting, (&scene, unseen));
        let exact = all.light.map(|&v| f64::from(v));
        let (wrong, _) = differences(&some.light, &exact, unseen);
        assert_eq!(wrong, 0.0, "{unseen}");
        assert!(some.light != all.light || unseen < 0.05);
    }
    let none = lamp::shaded_irradiance(&range, &normals, &lighting, (&scene, 1e3));
    assert_eq!(none.light, open.light);
}

#[test]
fn particles_behind_things_are_as_dark_as_in_the_reference() {
    let scene = balls();
    let soft = Shadow::Soft {
        radius_m: 0.08,
        samples: 16,
    };
    let dice = Stream::stage(11, "particles");
    let places: Vec<[f64; 3]> = (0..4000)
        .map(|number| {
            let depth = 0.2 + 3.6 * dice.unit(number, 0);
            let [x, y] = [1, 2].map(|k| (dice.unit(number, k) - 0.5) * 1.2 * depth);
            [x, y, depth]
        })
        .collect();
    for (lamp, shadow, multiple) in [
        (lamps()[0], Shadow::Hard, false),
        (lamps()[1], Shadow::Hard, true),
        (lamps()[0], soft, true),
        (lamps()[1], Shadow::None, true),
    ] {
        let lighting = lit_by(lamp.with_shadow(shadow, false), (64, 48), multiple);
        let points = places.iter().map(|&place| LitPoint { place, weight: 1.0 });
        let points: Vec<LitPoint> = points.collect();
        let fast = lamp::white_at_each(&points, &lighting, (&scene, 0.0));
        let faint: Vec<LitPoint> = places
            .iter()
            .map(|&place| LitPoint { place, weight: 0.0 })
            .collect();
        let faint = lamp::white_at_each(&faint, &lighting, (&scene, 0.0));
        let (mut wrong, mut darker, mut sums) = (0, 0, [0.0; 3]);
        for ((place, fast), unweighted) in places.iter().zip(&fast).zip(&faint) {
            let exact = lamp::white_at(*place, &lighting, Some(&scene));
            let open = lamp::white_at(*place, &lighting, None);
            assert_eq!(*unweighted, open, "light that does not matter is not occluded");
            let differs = (0..3).any(|i| (fast[i] - exact[i]).abs() > 1e-4 * open[i]);
            wrong += usize::from(differs);
            darker += usize::from(exact[1] < 0.9 * open[1]);
            for (sum, light) in sums.iter_mut().zip([fast, &exact, &open]) {
                *sum += light[1];
            }
        }
        let [fast, exact, open] = sums;
        assert!(
            (fast / exact - 1.0).abs() < SUMS,
            "{shadow:?} {multiple}: {sums:?}"
        );
        if shadow == Shadow::None {
            assert_eq!((wrong, darker), (0, 0));
            continue;
        }
        // Rims of discs decide for the whole of them.
        let most = if multiple || shadow == soft { 0.15 } else { GRAZING };
        assert!(
            (wrong as f64) < most * places.len() as f64,
            "{shadow:?} {multiple}: {wrong}"
        );
        assert!(
            darker > places.len() / 100 && exact < open,
            "{shadow:?} {multiple}: {darker} {sums:?}"
        );
    }
}

/// Light in air that makes every sample as bright as the light that falls on it.
fn white((width, height): (usize, usize)) -> Rgb<f32> {
    Rgb::from_fn(width, height, |_, _| [1.0f32; 3])
}

#[test]
fn lamps_cast_no_more_shadows_than_can_be_seen() {
    let size = (96, 64);
    let asked = |radius_m: f64| Shadow::Soft {
        radius_m,
        samples: 16,
    };
    let needed = |scene: &Balls, lamp: Lamp, shadow: Shadow, tolerance: f64, multiple: bool| {
        let lighting = lit_by(lamp.with_shadow(shadow, true), size, multiple);
        let range = range_of(scene, size);
        let all = Casting::needed(
            tolerance,
            &lighting,
            &VisibleBounds::measure(&white(size), &range, &lighting.camera),
            scene,
        );
        [all.on_surfaces, all.in_glow].map(|lighting| lighting.lamps[0].shadow())
    };
    let (many, wall) = (balls(), Balls(Vec::new()));
    let beside = Balls(vec![([9.0, 0.0, 2.0], 0.4), ([0.0, 0.0, -3.0], 1.0)]);
    let lamp = lamps()[0];
    for multiple in [false, true] {
        assert_eq!(needed(&wall, lamp, asked(0.1), 3e-4, multiple), [Shadow::None; 2]);
        assert_eq!(
            needed(&many, lamp, Shadow::Hard, 3e-4, multiple),
            [Shadow::Hard; 2]
        );
        assert_eq!(needed(&many, lamp, asked(0.1), 3e-4, multiple), [asked(0.1); 2]);
    }
    assert_eq!(
        needed(&beside, lamp, Shadow::Hard, 3e-4, false),
        [Shadow::None; 2]
    );
    // Penumbras of a lamp of a fifth of a millimeter are narrower than a pixel.
    assert_eq!(
        needed(&many, lamp, asked(2e-4), 3e-4, true),
        [Shadow::Hard, asked(2e-4)]
    );
    // Few samples suffice for much less than the light of a lamp.
    let [on_surfaces, _] = needed(&many, lamp, asked(0.1), 0.5, false);
    let Shadow::Soft { samples, .. } = on_surfaces else {
        panic!("{on_surfaces:?}")
    };
    assert!((1..16).contains(&samples), "{samples}");
}

#[test]
fn shadows_as_needed_differ_within_the_tolerance_from_those_that_were_asked_for() {
    let size = (120, 80);
    let scene = Balls(vec![([0.3, 0.1, 2.0], 0.35), ([-0.8, -0.3, 2.5], 0.25)]);
    let range = range_of(&scene, size);
    let normals = lamp::normals_of(&range, &lit_by(lamps()[0], size, false).camera);
    let wide = range.map(|&z| f64::from(z));
    let mut fewer = 0;
    for lamp in lamps() {
        for (radius_m, tolerance) in [(0.1, 0.3), (0.1, 0.1), (0.05, 0.03), (3e-4, 0.01)] {
            let shadow = Shadow::Soft {
                radius_m,
                samples: 64,
            };
            let lighting = lit_by(lamp.with_shadow(shadow, false), size, false);
            let casting = Casting::needed(
                tolerance,
                &lighting,
                &VisibleBounds::measure(&white(size), &range, &lighting.camera),
                &scene,
            );
            fewer += usize::from(casting.on_surfaces.lamps[0].shadow() != shadow);
            let [asked, needed] = [&lighting, &casting.on_surfaces]
                .map(|lighting| lamp::shaded_irradiance_reference(&wide, &normals, lighting, &scene));
            // White surfaces send back E/π. A penumbra within a pixel may fall on its other side.
            let limit = tolerance * std::f64::consts::PI;
            let (wrong, _) = differences(&needed.map(|&v| v as f32), &asked, limit);
            let most = if radius_m < 1e-3 { GRAZING } else { 0.0 };
            assert!(wrong <= most, "{radius_m} {tolerance}: {wrong}");
        }
    }
    assert!(fewer >= 4, "{fewer}");
}
