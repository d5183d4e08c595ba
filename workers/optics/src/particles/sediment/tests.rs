use imaging::geometry::Intrinsics;
use imaging::{Plane, Rgb};

use super::*;

const LAW: Sediment = Sediment {
    extinction_per_m: 3.0,
    albedo: [0.4, 0.34, 0.25],
    cover: 0.5,
    height_m: 0.6,
    scale_m: 0.6,
    edge: 0.25,
    thrusters: 0,
    above_bottom_m: Some(1.0),
};
const SIZE: (usize, usize) = (150, 98);
const UP: [f64; 3] = [0.0, -1.0, 0.0];
/// Edges of clouds fall between the rays of the fast form: limits of the mean, of all but a hundredth of the pixels, and of the
/// worst, at the start of a plume next to the lens. The frame is small, so its rays are five times as far apart as those of a usual
/// one.
const MEAN_ERROR: f64 = 0.004;
const COMMON_ERROR: f64 = 0.1;
const WORST_ERROR: f64 = 0.45;

fn clouds(law: &Sediment) -> Clouds {
    let eye = Eye::at_origin(Intrinsics::centered(130.0, SIZE.0, SIZE.1));
    Clouds::new(law, World { seed: 4, index: 1 }, &eye, UP, false)
}

fn murk() -> Murk<'static> {
    Murk {
        attenuation: [0.5, 0.2, 0.25],
        path: &|_, range| range,
        light: &|points| {
            let light = |[x, y, z]: [f64; 3]| [0.3 + 0.2 / (0.2 + x * x + y * y + z * z); 3];
            points.iter().map(|point| light(point.place)).collect()
        },
    }
}

#[test]
fn the_noise_has_the_spread_that_covers_are_made_of() {
    let noise = Noise::new(9);
    let values: Vec<f64> = (0..40_000)
        .map(|i| {
            noise.at([
                0.37 * f64::from(i),
                0.11 * f64::from(i % 501),
                0.73 * f64::from(i % 77),
            ])
        })
        .collect();
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let spread = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt();
    assert!(
        mean.abs() < 0.02 && (spread / SPREAD - 1.0).abs() < 0.1,
        "{mean} {spread}"
    );
    assert!(values.iter().all(|v| v.abs() <= MOST));
}

#[test]
fn banks_cover_their_share_of_the_bottom_and_end_at_their_height() {
    for cover in [0.2, 0.5, 0.8] {
        let clouds = clouds(&Sediment { cover, ..LAW });
        let share = |height: f64| {
            let at = |i: usize| {
                let (x, z) = ((i % 200) as f64 * 0.31, (i / 200) as f64 * 0.29);
                clouds.density([x, 1.0 - height, z])
            };
            (0..40_000).filter(|&i| at(i) > 0.0).count() as f64 / 40_000.0
        };
        assert!((share(0.0) - cover).abs() < 0.06, "{cover}: {}", share(0.0));
        assert!(
            share(0.6) < 0.35 * cover && share(1.2) == 0.0,
            "{cover}: {}",
            share(0.6)
        );
    }
}

#[test]
fn plumes_begin_at_thrusters_and_end_at_their_length() {
    let law = Sediment {
        cover: 0.0,
        thrusters: 2,
        ..LAW
    };
    let clouds = clouds(&law);
    let on_axis = |meters: f64| {
        let Plume { from, axis } = clouds.plumes[0];
        clouds.density([0, 1, 2].map(|i| from[i] + axis[i] * meters))
    };
    assert!((1..9).any(|i| on_axis(0.1 * f64::from(i)) > 0.9));
    assert_eq!(on_axis(3.0), 0.0);
    assert_eq!(on_axis(-0.1), 0.0);
}

#[test]
fn few_rays_show_what_all_of_them_do() {
    let law = Sediment { thrusters: 3, ..LAW };
    let clouds = clouds(&law);
    let range = Plane::from_fn(SIZE.0, SIZE.1, |x, y| match (x, y) {
        (3, 3) => f32::NAN,
        _ if x > 80 => 1.6,
        _ => 2.0 + 0.02 * y as f32,
    });
    let image = Rgb::from_fn(SIZE.0, SIZE.1, |x, y| {
        [0.02 + 0.001 * x as f32, 0.3, 0.002 * y as f32]
    });
    let (exact, exact_mask) = veil_reference(&image.map(|&v| f64::from(v)), &range, &clouds, &murk());
    let mut fast = image.clone();
    let mask = layers(&range, &clouds, &murk()).veil(&mut fast, &range);
    let pictures = fast.planes().iter().zip(exact.planes());
    let pairs = pictures.flat_map(|(fast, exact)| fast.data().iter().zip(exact.data()));
    let mut errors: Vec<f64> = pairs
        .chain(mask.data().iter().zip(exact_mask.data()))
        .map(|(fast, exact)| (f64::from(*fast) - exact).abs())
        .collect();
    errors.sort_by(f64::total_cmp);
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    let (common, worst) = (errors[errors.len() * 99 / 100], errors[errors.len() - 1]);
    assert!(
        mean < MEAN_ERROR && common < COMMON_ERROR && worst < WORST_ERROR,
        "{mean} {common} {worst}"
    );
    let covered = exact_mask.data().iter().filter(|&&opacity| opacity > 0.2).count();
    // Errors mean something only behind clouds: 1356 of the 14 700 pixels.
    assert!(covered > 1_000, "{covered}");
}

#[test]
fn clear_water_stays_as_it_is() {
    let clouds = clouds(&Sediment { cover: 0.0, ..LAW });
    let range = Plane::filled(SIZE.0, SIZE.1, 2.0f32);
    let image = Rgb::from_fn(SIZE.0, SIZE.1, |_, _| [0.5f32; 3]);
    let mut veiled = image.clone();
    let mask = layers(&range, &clouds, &murk()).veil(&mut veiled, &range);
    assert_eq!(veiled, image);
    assert!(mask.data().iter().all(|&opacity| opacity == 0.0));
}
