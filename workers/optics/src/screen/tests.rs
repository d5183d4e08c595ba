use imaging::random::Stream;

use super::*;

const SIZE: usize = 65;

/// A slanted wall, and before it a square at 2 m.
fn screen() -> (Screen, Intrinsics) {
    let camera = Intrinsics::centered(60.0, SIZE, SIZE);
    let range = Plane::from_fn(SIZE, SIZE, |x, y| {
        let ray = camera.ray(x as f64, y as f64);
        let square = (24..=40).contains(&x) && (24..=40).contains(&y);
        let z = if square { 2.0 } else { 4.0 / (1.0 - 0.3 * ray.x) };
        (z * ray.length()) as f32
    });
    (Screen::new(&range, camera), camera)
}

#[test]
fn the_camera_meets_what_it_sees() {
    let (screen, camera) = screen();
    for (x, y) in [(5.0, 7.5), (50.3, 60.0), (12.2, 30.0)] {
        let ray = camera.ray(x, y).normalized();
        let hit = screen.hit([0.0; 3], ray.into(), 0.0, 100.0).unwrap();
        let expected = 4.0 / (ray.z - 0.3 * ray.x);
        assert!((hit.distance / expected - 1.0).abs() < 1e-5, "{hit:?}");
        assert!(DVec3::from(hit.normal).dot(ray) < 0.0);
    }
    let middle = screen.hit([0.0; 3], [0.0, 0.0, 1.0], 0.0, 100.0).unwrap();
    assert!((middle.distance - 2.0).abs() < 1e-6);
    assert_eq!(screen.hit([0.0; 3], [0.9, 0.0, 0.1], 0.0, 100.0), None);
}

#[test]
fn a_lamp_beside_the_camera_sees_the_wall_but_not_behind_the_square() {
    let (screen, camera) = screen();
    let lamp = DVec3::from([-1.0, 0.0, 0.1]);
    let lit = |x: f64, y: f64| {
        let ray = camera.ray(x, y).normalized();
        let place = ray * (4.0 / (ray.z - 0.3 * ray.x));
        let hit = screen.hit([0.0; 3], ray.into(), 0.0, 100.0).unwrap();
        let start = imaging::rays::leaving(place.into(), hit.normal);
        let away = lamp + -DVec3::from(start.origin);
        let toward = away.normalized();
        !screen.occluded(start.origin, toward.into(), start.from, away.length())
    };
    // Next to the square on the lamp's side, above it, and in its shadow on the other side.
    assert!(lit(10.0, 32.0) && lit(32.0, 4.0) && lit(60.0, 4.0));
    assert!(!lit(44.0, 32.0));
}

/// Range images that make it hard to skip: slopes, walls with posts before them, noise, and holes.
fn adversarial(kind: u64, (width, height): (usize, usize)) -> Plane<f32> {
    let stream = Stream::stage(kind, "screen");
    Plane::from_fn(width, height, |x, y| {
        let noise = stream.unit(0, (y * width + x) as u64) as f32;
        let (u, v) = (x as f32 / width as f32, y as f32 / height as f32);
        let post = (x / 3) % 4 == 1;
        let z = match kind % 6 {
            0 => 1.0 + 3.0 * u + 5.0 * v,
            1 if post => 1.5 + 0.02 * noise,
            1 => 4.0 + v,
            2 => 0.3 + 6.0 * noise,
            3 => 3.0 + 0.3 * (9.0 * u).sin() * (7.0 * v).cos(),
            4 => 1.0 / (0.05 + 0.9 * v),
            _ => 2.0 + 0.02 * noise,
        };
        let is_hole = kind % 2 == 1 && noise > 0.97 || kind % 5 == 2 && (3..9).contains(&y);
        if is_hole { f32::INFINITY } else { z }
    })
}

#[test]
fn rays_that_skip_meet_what_those_meet_that_do_not() {
    let sizes = [(1, 1), (2, 1), (1, 7), (2, 2), (5, 3), (33, 65), (64, 48)];
    let (mut met, mut all) = (0, 0);
    for (number, size) in sizes
        .into_iter()
        .flat_map(|size| (0..30).map(move |number| (number, size)))
    {
        let camera = Intrinsics::centered(0.8 * size.0.max(size.1) as f64, size.0, size.1);
        let range = adversarial(number, size);
        let (fast, slow) = (Screen::new(&range, camera), Screen::reference(&range, camera));
        let stream = Stream::stage(number, "rays");
        for ray in 0..400 {
            let random = |k: u64| 2.0 * stream.unit(ray, k) - 1.0;
            // From anywhere, also behind the camera; from surfaces; from the camera; and along the axes of the picture.
            let (x, y) = ((ray as usize * 7) % size.0, (ray as usize * 5) % size.1);
            let seen = camera.ray(x as f64, y as f64).normalized() * f64::from(range.pixel(x, y)).min(50.0);
            let origin = match ray % 4 {
                0 => [3.0 * random(0), 3.0 * random(1), 4.0 * random(2) + 2.0],
                3 => [0.0; 3],
                _ => seen.into(),
            };
            let way = match ray % 7 {
                0 => [random(3), 0.0, 0.0],
                1 => [0.0, random(4), 0.0],
                2 => [0.0, 0.0, random(5)],
                3 => [random(3), random(4), 1e-9 * random(5)],
                _ => [random(3), random(4), random(5)],
            };
            let toward: [f64; 3] = DVec3::from(way).normalized().into();
            let to = if ray % 3 == 0 {
                f64::INFINITY
            } else {
                10.0 * stream.unit(ray, 6)
            };
            let hits = [&fast, &slow].map(|screen| screen.hit(origin, toward, 1e-5, to));
            assert_eq!(
                hits[0], hits[1],
                "{number} {size:?} {ray}: {origin:?} {toward:?} {to}"
            );
            let hidden = [&fast, &slow].map(|screen| screen.occluded(origin, toward, 1e-5, to));
            assert_eq!(hidden[0], hidden[1], "{number} {size:?} {ray}");
            all += 1;
            met += usize::from(hits[0].is_some());
        }
    }
    assert!(met * 20 > all && met * 20 < 19 * all, "{met} of {all}");
}

#[test]
fn nothing_is_nearer_than_the_clearance() {
    let dice = Stream::stage(3, "clearance");
    let mut met = 0;
    for kind in 0..12 {
        let size = (41, 29);
        let camera = Intrinsics::centered(35.0, size.0, size.1);
        let range = adversarial(kind, size);
        let (screen, reference) = (Screen::new(&range, camera), Screen::reference(&range, camera));
        for number in 0..40 {
            let draw = |k: u64| dice.unit(100 * kind + number, k);
            let place = [draw(0) - 0.5, draw(1) - 0.5, 2.0 * draw(2)];
            let clearance = screen.clearance(place);
            assert_eq!(clearance, reference.clearance(place), "{kind} {number}");
            for k in 0..16 {
                let toward = DVec3::from([0, 1, 2].map(|i| 2.0 * draw(8 + 3 * k + i) - 1.0)).normalized();
                if let Some(hit) = screen.hit(place, toward.into(), 0.0, 100.0) {
                    met += 1;
                    assert!(hit.distance >= clearance, "{kind} {number}: {hit:?} {clearance}");
                }
            }
        }
    }
    assert!(met > 1000, "{met}");
    let (screen, _) = screen();
    assert!(screen.clearance([0.0; 3]) > 1.0);
}
