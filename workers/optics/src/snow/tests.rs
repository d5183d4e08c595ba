use imaging::{Plane, Rgb};

use super::*;

const SNOW: Snow = Snow {
    density_per_m3: 400.0,
    near_m: 0.2,
    far_m: 3.0,
    radius_m: 0.002,
    radius_spread: 0.4,
    albedo: [0.8; 3],
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
        light: &|_| [1.0; 3],
    };
    let found = flakes(eye, snow, world, SIZE);
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
            let all = flakes(&eye, &snow, World { seed: 7, index }, SIZE);
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
fn radii_are_log_normal_and_places_even() {
    let all = flakes(
        &eye(),
        &Snow {
            density_per_m3: 20_000.0,
            radius_m: 1e-4,
            ..SNOW
        },
        WORLD,
        SIZE,
    );
    let logs: Vec<f64> = all
        .iter()
        .map(|flake| (flake.radius_m / 1e-4).ln() / 0.4)
        .collect();
    let (n, mean) = (logs.len() as f64, logs.iter().sum::<f64>() / logs.len() as f64);
    let square = logs.iter().map(|v| v * v).sum::<f64>() / n;
    assert!(
        n > 50_000.0 && mean.abs() < 4.0 / n.sqrt() && (square - 1.0).abs() < 0.05,
        "{mean} {square}"
    );
    assert!(logs.iter().all(|v| v.abs() <= TAIL + 1e-9));
    // Half of a frustum's volume lies beyond this depth.
    let half = (0.5 * (SNOW.far_m.powi(3) + SNOW.near_m.powi(3))).cbrt();
    let beyond = all.iter().filter(|flake| flake.place[2] > half).count() as f64;
    assert!((beyond / n - 0.5).abs() < 0.02, "{}", beyond / n);
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
    // A hole has no end.
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
            SIZE
        )
        .is_empty()
    );
}

#[test]
fn a_moving_camera_meets_the_same_particles_and_another_world_has_others() {
    let of = |eye: &Eye, world| flakes(eye, &SNOW, world, SIZE);
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
        radius_spread: 2.0,
        albedo: [1.5, 0.5, -0.1],
    };
    let errors = validate(&snow);
    let fields: Vec<_> = errors.iter().map(|error| error.field).collect();
    assert_eq!(
        fields,
        [
            "density_per_m3",
            "radius_m",
            "radius_spread",
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
    assert_eq!(texts, ["near_m is 5, the limit is below `far_m`, 3"]);
    let dense = Snow {
        density_per_m3: 1e5,
        ..SNOW
    };
    assert!(validate(&dense)[0].to_string().contains("cover the whole frame"));
    assert!(validate(&SNOW).is_empty() && check_count(&SNOW, 2.0).is_ok());
    let error = check_count(&SNOW, 1e3).unwrap_err();
    assert_eq!(
        error.to_string(),
        "density_per_m3 is 400, the limit is at most 4.446e1 in this view, which then holds 400000 particles"
    );
}
