use imaging::{Plane, Rgb};

use super::world::RADII;
use super::*;
use crate::eye::Eye;

const SNOW: Snow = Snow {
    density_per_m3: 400.0,
    near_m: 0.2,
    far_m: 3.0,
    radius_m: 0.0014,
    albedo: [0.8; 3],
    ..Snow::with_density(0.0)
};
const WORLD: World = World { seed: 7, index: 0 };
const SIZE: (usize, usize) = (96, 64);

fn eye() -> Eye {
    Eye::at_origin(Intrinsics::centered(60.0, SIZE.0, SIZE.1))
}

/// A gray picture with a wall at this range under snow, and the mask.
fn fall(eye: &Eye, snow: &Snow, world: World, range: f32, attenuation: f64) -> (Rgb<f32>, Plane<f32>) {
    let range = Plane::filled(SIZE.0, SIZE.1, range);
    let mut image = Rgb::from_fn(SIZE.0, SIZE.1, |_, _| [0.05f32; 3]);
    let surround = Surround {
        range: &range,
        eye,
        attenuation: [attenuation; 3],
        path: &|_, range| range,
        light: &|places| vec![[1.0; 3]; places.len()],
    };
    let found = flakes(eye, snow, world, SIZE, &Seeing::STILL);
    let found = lit(&found, snow.albedo, &surround);
    let mask = super::snow(&mut image, &found, &range, 1e-6);
    (image, mask)
}

#[test]
fn the_number_of_particles_follows_the_density() {
    let eye = eye();
    let inside =
        |flake: &&Flake| (-0.5..95.5).contains(&flake.center[0]) && (-0.5..63.5).contains(&flake.center[1]);
    for density in [3.0, 400.0, 20_000.0] {
        let snow = Snow {
            density_per_m3: density,
            radius_m: 1e-4,
            ..SNOW
        };
        let frames = 8.0;
        let seen = (0..8).map(|index| {
            let all = flakes(&eye, &snow, World { seed: 7, index }, SIZE, &Seeing::STILL);
            all.iter().filter(inside).count() as f64
        });
        let mean = seen.sum::<f64>() / frames;
        let expected = expected(&snow, solid(&eye.camera, SIZE));
        // Poisson: four standard deviations.
        assert!(
            (mean - expected).abs() < 4.0 * (expected / frames).sqrt(),
            "{density}: {mean} for {expected}"
        );
    }
}

#[test]
fn radii_follow_junge_and_places_are_even() {
    let snow = Snow {
        density_per_m3: 20_000.0,
        radius_m: 1e-4,
        ..SNOW
    };
    let all = flakes(&eye(), &snow, WORLD, SIZE, &Seeing::STILL);
    let n = all.len() as f64;
    assert!(n > 50_000.0, "{n}");
    let share =
        |is_counted: &dyn Fn(&Flake) -> bool| all.iter().filter(|flake| is_counted(flake)).count() as f64 / n;
    // The share above twice the least radius is (2^-3 − 10^-3)/(1 − 10^-3).
    let large = share(&|flake| flake.radius_m > 2.0 * snow.radius_m);
    assert!(
        (large - 0.124).abs() < 4.0 * (0.125 * 0.875 / n).sqrt(),
        "{large}"
    );
    let within = share(&|flake| (0.999..RADII).contains(&(flake.radius_m / snow.radius_m)));
    assert_eq!(within, 1.0);
    // Half of a frustum's volume is beyond this depth.
    let half = (0.5 * (SNOW.far_m.powi(3) + SNOW.near_m.powi(3))).cbrt();
    let beyond = share(&|flake| flake.place[2] > half);
    assert!((beyond - 0.5).abs() < 0.02, "{beyond}");
}

#[test]
fn the_mask_is_where_the_picture_changed_and_a_wall_hides_what_is_behind() {
    let (image, mask) = fall(&eye(), &SNOW, WORLD, 10.0, 0.3);
    assert!(mask.data().iter().filter(|&&v| v > 0.1).count() > 30);
    for (opacity, value) in mask.data().iter().zip(image.planes()[1].data()) {
        // Every color is 0.8 and the wall 0.05.
        assert!((f64::from(*value) - 0.05 - 0.75 * f64::from(*opacity)).abs() < 1e-5);
    }
    let (image, mask) = fall(&eye(), &SNOW, WORLD, 0.1, 0.3);
    assert!(mask.data().iter().all(|&v| v == 0.0));
    assert_eq!(image.pixel(9, 9), [0.05; 3]);
    // A hole is infinite.
    assert!(
        fall(&eye(), &SNOW, WORLD, f32::NAN, 0.3)
            .1
            .data()
            .iter()
            .any(|&v| v > 0.1)
    );
}

#[test]
fn the_expected_cover_is_what_the_masks_have_on_average() {
    for attenuation in [0.0, 0.7] {
        let covered = (0..12).map(|index| {
            let (_, mask) = fall(&eye(), &SNOW, World { seed: 1, index }, 50.0, attenuation);
            mask.data().iter().map(|&v| f64::from(v)).sum::<f64>() / mask.data().len() as f64
        });
        let mean = covered.sum::<f64>() / 12.0;
        let expected = cover(&SNOW, attenuation);
        // Discs overlap, ranges exceed depths, and a few large ones make most of the cover.
        assert!((0.6..1.15).contains(&(mean / expected)), "{mean} for {expected}");
        let pixels = SIZE.0 * SIZE.1;
        let tolerance = expected * pixels as f64 * 0.75;
        assert!(is_needless(&SNOW, pixels, attenuation, 0.75, tolerance * 1.001));
        assert!(!is_needless(&SNOW, pixels, attenuation, 0.75, tolerance * 0.999));
    }
    assert!(is_needless(
        &Snow {
            density_per_m3: 0.0,
            ..SNOW
        },
        1,
        0.0,
        1.0,
        0.0
    ));
    assert!(
        flakes(
            &eye(),
            &Snow {
                density_per_m3: 0.0,
                ..SNOW
            },
            WORLD,
            SIZE,
            &Seeing::STILL
        )
        .is_empty()
    );
}

#[test]
fn a_moving_camera_meets_the_same_particles_and_another_world_has_others() {
    let of = |eye: &Eye, world| flakes(eye, &SNOW, world, SIZE, &Seeing::STILL);
    let here = of(&eye(), WORLD);
    assert_eq!(of(&eye(), WORLD), here);
    assert_ne!(of(&eye(), World { seed: 8, ..WORLD }), here);
    assert_ne!(of(&eye(), World { index: 1, ..WORLD }), here);
    // A quarter turn about the optical axis, and 5 cm ahead.
    let mut turned = eye();
    turned.world_from_camera = [
        [0.0, -1.0, 0.0, 0.02],
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.05],
        [0.0, 0.0, 0.0, 1.0],
    ];
    let there = of(&turned, WORLD);
    let met = |flake: &&Flake| {
        let world = eye().to_world(flake.place);
        there.iter().any(|other| {
            let place = turned.to_world(other.place);
            place.iter().zip(world).all(|(a, b)| (a - b).abs() < 1e-9) && other.radius_m == flake.radius_m
        })
    };
    let middle = |flake: &&Flake| {
        let [x, y, z] = flake.place;
        (0.4..2.9).contains(&z) && x.hypot(y) < 0.4 * z
    };
    let staying: Vec<_> = here.iter().filter(middle).collect();
    assert!(staying.len() > 200, "{}", staying.len());
    assert!(staying.iter().all(met));
}

#[test]
fn everything_wrong_is_said_at_once() {
    let snow = Snow {
        density_per_m3: -1.0,
        near_m: 0.0,
        far_m: 1e9,
        radius_m: f64::NAN,
        spectrum: 7.0,
        albedo: [1.5, 0.5, -0.1],
        ..Snow::with_density(0.0)
    };
    let errors = validate(&snow);
    let fields: Vec<_> = errors.iter().map(|error| error.field).collect();
    assert_eq!(
        fields,
        [
            "density_per_m3",
            "radius_m",
            "spectrum",
            "near_m",
            "far_m",
            "albedo",
            "albedo"
        ]
    );
    let thick = Snow {
        density_per_m3: 1e6,
        near_m: 5.0,
        ..SNOW
    };
    let errors = validate(&thick);
    let texts: Vec<_> = errors.iter().map(ToString::to_string).collect();
    assert_eq!(texts, ["near_m is 5; must be below `far_m`, 3"]);
    let dense = Snow {
        density_per_m3: 1e5,
        ..SNOW
    };
    assert!(validate(&dense)[0].to_string().contains("cover the whole frame"));
    assert!(validate(&SNOW).is_empty() && check_count(&SNOW, 2.0).is_ok());
    let error = check_count(&SNOW, 1e3).unwrap_err();
    assert_eq!(
        error.to_string(),
        "density_per_m3 is 400; must be at most 4.446e1 in this view, which then holds 400000 particles"
    );
}

/// Particles of a lens that sees 2 m sharply.
fn blurred(snow: &Snow, time_s: f64) -> Vec<Flake> {
    let seeing = Seeing {
        blur_px: &|range| (3.0 * (1.0 / range - 0.5)).abs(),
        exposure_s: 0.02,
        time_s,
    };
    flakes(&eye(), snow, WORLD, SIZE, &seeing)
}

#[test]
fn near_particles_are_wide_and_faint_and_those_in_focus_small() {
    let snow = Snow {
        radius_m: 2e-4,
        ..SNOW
    };
    let all = blurred(&snow, 0.0);
    let mean = |near: f64, far: f64| {
        let found = all.iter().filter(|flake| (near..far).contains(&flake.range_m));
        let spots = found.map(|flake| (flake.spot.radius, flake.opacity));
        let (count, sum) = spots.fold((0.0, (0.0, 0.0)), |(count, sum), (radius, opacity)| {
            (count + 1.0, (sum.0 + radius, sum.1 + opacity))
        });
        (sum.0 / count, sum.1 / count)
    };
    let (near, focused) = (mean(0.2, 0.6), mean(1.7, 2.3));
    assert!(near.0 > 8.0 * focused.0, "{near:?} {focused:?}");
    assert!(near.1 < focused.1, "{near:?} {focused:?}");
}

#[test]
fn aggregates_have_the_area_of_their_particles() {
    let whole = flakes(&eye(), &SNOW, WORLD, SIZE, &Seeing::STILL);
    let snow = Snow {
        aggregates: 1.0,
        ..SNOW
    };
    let parts = flakes(&eye(), &snow, WORLD, SIZE, &Seeing::STILL);
    let area = |flakes: &[Flake]| flakes.iter().map(|flake| flake.radius_m.powi(2)).sum::<f64>();
    assert!(parts.len() > 3 * whole.len(), "{} {}", parts.len(), whole.len());
    // Parts at the border fall out of the view or into it.
    assert!((area(&parts) / area(&whole) - 1.0).abs() < 0.05);
}

#[test]
fn the_current_carries_particles_and_draws_them_out() {
    let snow = Snow {
        drift_m_per_s: Some([0.5, 0.0, 0.0]),
        ..SNOW
    };
    let (now, later) = (blurred(&snow, 0.0), blurred(&snow, 0.1));
    let met = now.iter().filter(|flake| {
        let moved = |other: &&Flake| {
            let [x, y, z] = [0, 1, 2].map(|i| other.place[i] - flake.place[i]);
            (x - 0.05).abs() < 1e-9 && y.abs() < 1e-9 && z.abs() < 1e-9
        };
        later.iter().any(|other| moved(&other))
    });
    assert!(met.count() > now.len() / 2);
    for flake in &now {
        let streak = flake.spot.streak;
        // f v t / z.
        let wanted = 60.0 * 0.5 * 0.02 / flake.place[2];
        assert!((streak[0] - wanted).abs() < 1e-9 && streak[1] == 0.0);
    }
}
