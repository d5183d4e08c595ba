//! The definition: sorts each window.

use imaging::Plane;

pub(super) fn median(picture: &Plane<u8>, side: usize) -> Plane<u8> {
    let radius = side / 2;
    let (width, height) = picture.size();
    let mut window = Vec::new();
    Plane::from_fn(width, height, |x, y| {
        window.clear();
        for row in y..y + side {
            let row = row.saturating_sub(radius).min(height - 1);
            let columns = (x..x + side).map(|x| x.saturating_sub(radius).min(width - 1));
            window.extend(columns.map(|x| picture.pixel(x, row)));
        }
        let middle = window.len() / 2;
        *window.select_nth_unstable(middle).1
    })
}
