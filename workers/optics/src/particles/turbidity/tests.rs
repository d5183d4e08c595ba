use imaging::geometry::Intrinsics;

use super::*;

const PATCHY: Turbidity = Turbidity {
    contrast: 0.8,
    scale_m: 0.7,
};

#[test]
fn the_field_has_mean_one_the_stated_spread_and_correlation_and_is_never_negative() {
    // Many worlds at one point and at points one scale apart.
    let (mut sum, mut square, mut product) = (0.0, 0.0, 0.0);
    let n = 40_000;
    for index in 0..n {
        let field = Field::new(&PATCHY, World { seed: 3, index });
        let (here, there) = (
            field.factor_at([1.0, -2.0, 5.0]),
            field.factor_at([1.0, -1.3, 5.0]),
        );
        assert!((1.0 - PATCHY.contrast..=1.0 + PATCHY.contrast * 4.0 + 1e-9).contains(&here));
        sum += here;
        square += (here - 1.0).powi(2);
        product += (here - 1.0) * (there - 1.0);
    }
    let n = n as f64;
    let variance = PATCHY.contrast.powi(2) * (1.0 - 1.0 / WAVES as f64);
    assert!((sum / n - 1.0).abs() < 0.015, "{}", sum / n);
    assert!(
        (square / n / variance - 1.0).abs() < 0.05,
        "{}",
        square / n / variance
    );
    let correlation = product / square;
    assert!((correlation - (-1.0f64).exp()).abs() < 0.03, "{correlation}");
}

#[test]
fn a_moving_camera_sees_the_same_field() {
    let field = Field::new(&PATCHY, World { seed: 3, index: 0 });
    let eye = Eye {
        camera: Intrinsics::centered(80.0, 32, 24),
        world_from_camera: [
            [0.0, -0.6, 0.8, 4.0],
            [1.0, 0.0, 0.0, -2.0],
            [0.0, 0.8, 0.6, 9.0],
            [0.0, 0.0, 0.0, 1.0],
        ],
    };
    let seen = field.seen_from(&eye);
    for point in [[0.0; 3], [0.3, -0.2, 2.0], [-4.0, 1.0, 30.0]] {
        assert!((seen.factor_at(point) - field.factor_at(eye.to_world(point))).abs() < 1e-12);
    }
    assert_ne!(field, Field::new(&PATCHY, World { seed: 3, index: 1 }));
    assert_ne!(field, Field::new(&PATCHY, World { seed: 4, index: 0 }));
}
