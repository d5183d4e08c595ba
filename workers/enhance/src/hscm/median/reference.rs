//! The definition: collect the window, find its middle.

use imaging::Plane;

pub(super) fn median(picture: &Plane<u8>, window_px: usize) -> Plane<u8> {
    let (width, height) = picture.size();
    let radius = window_px / 2;
    let mut window = Vec::with_capacity(window_px * window_px);
    Plane::from_fn(width, height, |x, y| {
        window.clear();
        for row in y..=y + 2 * radius {
            let row = row.saturating_sub(radius).min(height - 1);
            let column = |x: usize| x.saturating_sub(radius).min(width - 1);
            window.extend((x..=x + 2 * radius).map(|x| picture.at(column(x), row)));
        }
        let middle = window.len() / 2;
        *window.select_nth_unstable(middle).1
    })
}
