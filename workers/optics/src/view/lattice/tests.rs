use super::*;

const SIZES: [(usize, usize); 6] = [(1, 1), (1, 9), (7, 2), (33, 21), (64, 48), (131, 77)];

/// The values of a picture, and the number of its traced pixels.
struct Found {
    values: Vec<f32>,
    traced: usize,
}

fn find(range: &Plane<f32>, is_wanted: impl Fn(usize) -> bool, exact: impl Fn(usize, usize) -> f32) -> Found {
    let width = range.width();
    let mut traced = 0;
    let values = trace_changes((range, 600.0), is_wanted, 9.0, |pixels, values| {
        traced += pixels.len();
        values.clear();
        values.extend(pixels.iter().map(|&at| exact(at % width, at / width)));
    });
    Found { values, traced }
}

fn count_wrong(found: &Found, width: usize, exact: impl Fn(usize, usize) -> f32) -> usize {
    let pixels = found.values.iter().enumerate();
    pixels
        .filter(|(at, value)| **value != exact(at % width, at / width))
        .count()
}

#[test]
fn the_edges_of_a_shadow_are_found_pixel_by_pixel_on_one_surface() {
    for (width, height) in SIZES {
        let range = Plane::filled(width, height, 2.0f32);
        let disc = |x: usize, y: usize| {
            let (x, y) = (x as f32 / width as f32 - 0.4, y as f32 / height as f32 - 0.5);
            f32::from(u8::from(x * x + y * y > 0.09))
        };
        let found = find(&range, |_| true, disc);
        assert_eq!(count_wrong(&found, width, disc), 0, "{width}x{height}");
        assert!(
            width < 100 || 3 * found.traced < width * height,
            "{}",
            found.traced
        );
    }
}

#[test]
fn lines_one_pixel_wide_are_followed_wherever_they_pass() {
    let (width, height) = (120, 90);
    let range = Plane::filled(width, height, 2.0f32);
    for slope in [0.0f32, 0.3, 0.77, 1.0, -0.5, -1.0] {
        for offset in 0..8 {
            let is_line = |along: usize, across: usize| {
                let middle = 40.0 + offset as f32 + slope * (along as f32 - 50.0);
                (across as f32 - middle).abs() <= 0.5
            };
            let flat = |x: usize, y: usize| f32::from(u8::from(!is_line(x, y)));
            let steep = |x: usize, y: usize| f32::from(u8::from(!is_line(y, x)));
            let wrong = [
                count_wrong(&find(&range, |_| true, flat), width, flat),
                count_wrong(&find(&range, |_| true, steep), width, steep),
            ];
            // One end, at the edge of the picture, may be between the last nodes.
            assert!(
                wrong.iter().all(|count| *count <= 2),
                "{slope} {offset}: {wrong:?}"
            );
        }
    }
}

#[test]
fn what_lies_between_the_nodes_is_missed_and_what_is_larger_is_not() {
    let (width, height) = (40, 40);
    let range = Plane::filled(width, height, 2.0f32);
    for side in 1..=STEP {
        for left in 12..12 + STEP {
            let spot = |x: usize, y: usize| {
                let inside = (left..left + side).contains(&x) && (17..17 + side).contains(&y);
                f32::from(u8::from(!inside))
            };
            let wrong = count_wrong(&find(&range, |_| true, spot), width, spot);
            assert!(
                wrong == 0 || (side < STEP && wrong == side * side),
                "{side} {left}: {wrong}"
            );
        }
    }
}

#[test]
fn nothing_is_read_across_an_edge_of_surfaces_and_unwanted_pixels_are_not_traced() {
    for (width, height) in SIZES {
        let range = Plane::from_fn(width, height, |x, _| if x % 11 < 5 { 2.0 } else { 4.0 });
        let near = |x: usize, _: usize| f32::from(u8::from(x % 11 < 5));
        let is_wanted = |at: usize| at % 7 != 3;
        let found = find(&range, is_wanted, near);
        for (at, value) in found.values.iter().enumerate() {
            let expected = if is_wanted(at) { near(at % width, 0) } else { 9.0 };
            assert_eq!(*value, expected, "{width}x{height} {at}");
        }
        assert!(found.traced <= (0..width * height).filter(|at| is_wanted(*at)).count());
    }
}

#[test]
fn a_ramp_is_interpolated_and_hardly_traced() {
    let (width, height) = (161, 121);
    let range = Plane::filled(width, height, 2.0f32);
    let ramp = |x: usize, y: usize| (0.5 * x as f32 + 0.3 * y as f32) / 161.0;
    let found = find(&range, |_| true, ramp);
    for (at, value) in found.values.iter().enumerate() {
        assert!((value - ramp(at % width, at / width)).abs() < 1e-5, "{at}");
    }
    assert!(7 * found.traced < width * height, "{}", found.traced);
}

#[test]
fn every_wanted_pixel_of_a_small_picture_is_traced() {
    let range = Plane::filled(60, 40, 2.0f32);
    let mut traced = Vec::new();
    trace_changes(
        (&range, 52.0),
        |at| at % 3 > 0,
        0.0,
        |pixels, values| {
            traced.extend_from_slice(pixels);
            values.clear();
            values.resize(pixels.len(), 1.0);
        },
    );
    traced.sort_unstable();
    assert_eq!(traced, (0..60 * 40).filter(|at| at % 3 > 0).collect::<Vec<_>>());
}
