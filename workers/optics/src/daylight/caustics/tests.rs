use super::*;

fn waves() -> Waves {
    Waves {
        tile_m: 3.0,
        cells: 64,
        slope: 0.12,
        wind: 0.3,
        time_s: 0.4,
        seed: 7,
    }
}

/// a 0.08, b 0.2.
fn clear() -> Blur {
    Blur {
        attenuation: 0.28,
        spread_attenuation: 0.09,
        angles: [[0.0015, 0.0007 * 0.2], [0.035, 0.010 * 0.2]],
        wide: [0.63, 0.065 * 0.2],
    }
}

fn contrast(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let square = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>();
    (square / values.len() as f64).sqrt()
}

#[test]
fn tiles_are_the_reference_and_keep_the_light() {
    for (cells, tile_m, slope) in [(64, 3.0, 0.12), (32, 0.5, 0.3), (128, 12.0, 0.055)] {
        let waves = Waves {
            tile_m,
            cells,
            slope,
            ..waves()
        };
        for depths in [vec![0.2], vec![0.5, 1.3, 30.0], slices(0.0, 9.0)] {
            let tiles = Tiles::new(&waves, &clear(), depths.clone());
            for (slice, &depth) in depths.iter().enumerate() {
                let exact = tile_reference(&waves, &clear(), depth, RAYS_PER_CELL, Refraction::Small);
                let peak = exact.data().iter().copied().fold(0.0, f64::max);
                let mut sum = 0.0;
                for y in 0..cells {
                    for x in 0..cells {
                        let (fast, exact) = (f64::from(tiles.cell(slice, x, y)), exact.pixel(x, y));
                        // A ray near the border of two cells may fall to either side.
                        assert!(
                            (fast - exact).abs() <= 2e-3 * peak,
                            "{cells} {depth}: {fast} {exact}"
                        );
                        assert!(fast >= 0.0 && fast <= tiles.peak());
                        sum += fast;
                    }
                }
                assert!((sum / (cells * cells) as f64 - 1.0).abs() < 1e-6, "{sum}");
            }
        }
    }
}

#[test]
fn few_rays_that_bend_a_little_draw_what_many_draw_by_the_law_of_refraction() {
    for depth in [1.0, 2.0, 4.0] {
        let cheap = tile_reference(&waves(), &clear(), depth, RAYS_PER_CELL, Refraction::Small);
        let exact = tile_reference(&waves(), &clear(), depth, 8, Refraction::Exact);
        let apart: f64 = cheap
            .data()
            .iter()
            .zip(exact.data())
            .map(|(a, b)| (a - b) * (a - b))
            .sum();
        let rms = (apart / (64.0 * 64.0)).sqrt();
        let of_both = [contrast(cheap.data()), contrast(exact.data())];
        assert!(
            rms < 0.05 && (of_both[0] - of_both[1]).abs() < 0.01 && of_both[0] > 0.3,
            "{depth} m: {rms} {of_both:?}"
        );
    }
}

#[test]
fn slices_span_the_depths_in_equal_ratios() {
    assert_eq!(slices(0.0, 0.1), vec![0.2]);
    assert_eq!(slices(3.0, 3.0), vec![3.0]);
    let many = slices(1.0, 8.0);
    assert!(many.len() == 8 && many[0] == 1.0 && (many[7] - 8.0).abs() < 1e-12);
    let ratio = many[1] / many[0];
    assert!(
        many.windows(2)
            .all(|pair| (pair[1] / pair[0] - ratio).abs() < 1e-12)
    );
}

#[test]
fn waves_run_with_time_and_are_those_of_their_seed() {
    let described = Caustics {
        tile_m: 3.0,
        cells: 32,
        slope: 0.12,
        wind_deg: 0.0,
        fps: Some(10.0),
    };
    let tile = |seed, frame| {
        let waves = Waves::new(&described, seed, frame);
        Tiles::new(&waves, &clear(), vec![2.0])
    };
    assert_eq!(tile(1, 5), tile(1, 5));
    assert!(tile(1, 5) != tile(1, 6) && tile(1, 5) != tile(2, 5));
    let still = Caustics {
        fps: None,
        ..described
    };
    assert_eq!(Waves::new(&still, 1, 3), Waves::new(&still, 1, 9));
}
