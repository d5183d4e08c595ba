//! The order of traced pixels: tile by tile, so that the rays of a packet are close together in space.

/// Columns and rows of a tile.
pub(crate) const TILE: usize = 8;

/// Columns and rows of a picture, tile by tile.
pub(crate) fn in_tiles(width: usize, height: usize) -> impl Iterator<Item = (usize, usize)> {
    let tops = (0..height).step_by(TILE);
    let corners = tops.flat_map(move |top| (0..width).step_by(TILE).map(move |left| (left, top)));
    corners.flat_map(move |(left, top)| {
        let rows = top..(top + TILE).min(height);
        rows.flat_map(move |y| (left..(left + TILE).min(width)).map(move |x| (x, y)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pixel_comes_once_and_tiles_are_whole() {
        for (width, height) in [(1, 1), (8, 8), (19, 21)] {
            let all: Vec<_> = in_tiles(width, height).collect();
            let mut sorted = all.clone();
            sorted.sort_unstable();
            sorted.dedup();
            assert_eq!((all.len(), sorted.len()), (width * height, width * height));
        }
        let first: Vec<_> = in_tiles(19, 21).take(TILE * TILE).collect();
        assert!(first.iter().all(|&(x, y)| x < TILE && y < TILE));
    }
}
