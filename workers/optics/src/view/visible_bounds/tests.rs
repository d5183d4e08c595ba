use super::*;
use crate::range::is_hole;

fn range(width: usize, height: usize) -> Plane<f32> {
    Plane::from_fn(width, height, |x, y| match (x * 7 + y * 13) % 11 {
        0 => f32::NAN,
        k => 0.3 + 0.4 * k as f32,
    })
}

#[test]
fn every_visible_place_is_in_a_region() {
    let camera = Intrinsics::centered(70.0, 100, 61);
    let range = range(100, 61);
    let bounds = VisibleBounds::measure_range(&range, &camera);
    let (surfaces, water): (Vec<_>, Vec<_>) = (bounds.surfaces().collect(), bounds.water().collect());
    for (x, y) in (0..61).flat_map(|y| (0..100).map(move |x| (x, y))) {
        let ray = camera.ray(x as f64, y as f64);
        let z = f64::from(range.pixel(x, y));
        let end = if z.is_nan() { 900.0 } else { z };
        let place = |meters: f64| <[f64; 3]>::from(ray * (meters / ray.length()));
        if !z.is_nan() {
            // A meter across the line of sight, outwards.
            let slope = ray.length();
            assert!(most_px_per_m(&surfaces, place(z)) >= 70.0 * slope * slope / z * (1.0 - 1e-6));
        }
        for share in [0.0, 0.1, 0.5, 1.0] {
            assert!(most_px_per_m(&water, place(share * end)) > 0.0, "{x} {y} {share}");
        }
    }
}

fn most_px_per_m(regions: &[Region], place: [f64; 3]) -> f64 {
    let holders = regions
        .iter()
        .filter(|region| region.places.distances(place)[0] < 1e-9);
    holders.map(|region| region.px_per_m).fold(0.0, f64::max)
}

#[test]
fn every_pixel_is_within_the_bounds_of_its_tile() {
    for (width, height) in [(1, 1), (31, 2), (32, 32), (33, 65), (100, 61)] {
        let (camera, range) = (Intrinsics::centered(70.0, width, height), range(width, height));
        let radiance = Rgb::from_fn(width, height, |x, y| {
            [x as f32, y as f32, ((x * y) % 17) as f32].map(|v| 0.1 * v)
        });
        let bounds = VisibleBounds::measure(&radiance, &range, &camera);
        assert_eq!(bounds.columns, width.div_ceil(TILE_PX));
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let tile = &bounds.tiles[y / TILE_PX * bounds.columns + x / TILE_PX];
            let z = range.pixel(x, y);
            if is_hole(z) {
                assert!(tile.has_holes);
            } else {
                let [nearest, farthest] = tile.range_m.unwrap();
                assert!(nearest <= f64::from(z) && f64::from(z) <= farthest);
            }
            for (channel, light) in radiance.pixel(x, y).into_iter().enumerate() {
                assert!(tile.darkest[channel] <= light && light <= tile.brightest[channel]);
            }
        }
    }
}
