//! The definition: sorts each window.

use imaging::Plane;

const RADIUS_PX: usize = 2;

pub(super) fn median(picture: &Plane<u8>) -> Plane<u8> {
    let (width, height) = picture.size();
    let mut window = Vec::new();
    Plane::from_fn(width, height, |x, y| {
        window.clear();
        for row in y..=y + 2 * RADIUS_PX {
            let row = row.saturating_sub(RADIUS_PX).min(height - 1);
            let columns = (x..=x + 2 * RADIUS_PX).map(|x| x.saturating_sub(RADIUS_PX).min(width - 1));
            window.extend(columns.map(|x| picture.pixel(x, row)));
        }
        let middle = window.len() / 2;
        *window.select_nth_unstable(middle).1
    })
}
