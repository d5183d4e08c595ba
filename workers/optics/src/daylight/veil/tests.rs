use imaging::geometry::Intrinsics;

use super::super::field::Shape;
use super::*;

fn coastal() -> VeilOf {
    VeilOf {
        field: Field {
            shape: Shape::of_water(0.179, 0.004),
            decay: 0.25,
            window: 0.2,
            scattering: 0.219,
        },
        attenuation: 0.398,
        light: 0.2,
        depth: 7.0,
    }
}

#[test]
fn a_level_ray_has_the_veil_of_constant_water() {
    let of = coastal();
    for z in [0.01, 1.0, 20.0] {
        let constant = 0.2 * (1.0 - f64::exp(-0.398 * z));
        assert!((of.at(0.0, Some(z)) - constant).abs() < 1e-15);
    }
    assert_eq!(of.at(0.0, None), 0.2);
    assert!(of.at(0.5, Some(30.0)) > 2.0 * of.at(0.0, Some(30.0)));
    assert!(of.at(-0.5, Some(30.0)) < 0.6 * of.at(0.0, Some(30.0)));
}

#[test]
fn water_that_attenuates_nothing_has_no_veil() {
    let of = VeilOf {
        attenuation: 0.0,
        ..coastal()
    };
    assert_eq!((of.at(0.3, None), of.at(-0.3, Some(9.0))), (0.0, 0.0));
    let gaze = Gaze::unknown(9.0);
    let mut to = [1.0; 4];
    veil(&Plane::filled(2, 2, f32::NAN), &of, &gaze, &mut to);
    assert_eq!(to, [0.0; 4]);
}

#[test]
fn both_forms_agree_within_the_bound_at_every_place_of_a_wide_picture() {
    let camera = Intrinsics::centered(40.0, 97, 83);
    for up in [
        [0.0, -1.0, 0.0],
        [0.1, -0.7, 0.7],
        [0.0, 0.2, 1.0],
        [0.3, -0.2, -1.0],
    ] {
        let gaze = Gaze::new(camera, (97, 83), up);
        let range = Plane::from_fn(97, 83, |x, y| match (x + 3 * y) % 5 {
            0 => f32::NAN,
            1 => 1e-3,
            _ => 0.05 * (x * y) as f32 + 0.3,
        });
        for (decay, depth) in [(0.0, 0.0), (0.25, 7.0), (0.378, 40.0), (0.3, 12_000.0)] {
            let mut of = coastal();
            (of.field.decay, of.depth) = (decay, depth);
            let mut fast = vec![0.0; 97 * 83];
            veil(&range, &of, &gaze, &mut fast);
            let exact = veil_reference(&range.map(|&z| f64::from(z)), &of, &gaze);
            let limit = of.rounding(gaze.rises, true);
            let brightest = of.brightest(gaze.rises, true);
            for (fast, exact) in fast.iter().zip(exact.data()) {
                assert!(
                    (f64::from(*fast) - exact).abs() <= limit,
                    "{up:?} {depth}: {fast} {exact}"
                );
                assert!(*exact <= brightest * (1.0 + 1e-12), "{exact} above {brightest}");
            }
        }
    }
}

#[test]
fn no_pixel_is_farther_from_constant_water_than_the_bound_says() {
    let of = coastal();
    for rises in [(-0.4, 0.3), (-0.01, 0.02), (0.1, 0.2), (-0.9, -0.8)] {
        for span in [(0.1, 0.2), (0.5, 40.0), (3.0, 3.0)] {
            let bound = of.change(rises, span, false);
            for i in 0..=50 {
                for j in 0..=50 {
                    let at = |(low, high): (f64, f64), k: i32| low + (high - low) * f64::from(k) / 50.0;
                    let (rise, z) = (at(rises, i), at(span, j));
                    let constant = of.light * -(-of.attenuation * z).exp_m1();
                    let change = (of.at(rise, Some(z)) - constant).abs();
                    assert!(change <= bound * (1.0 + 1e-9), "{rise} {z}: {change} > {bound}");
                }
            }
        }
    }
    assert_eq!(of.change((0.0, 0.9), (1.0, 2.0), true), f64::INFINITY);
}
