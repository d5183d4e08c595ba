//! Pictures for fitting a table: soft clouds of color, like frames away from edges.

use imaging::Rgb;
use imaging::random::Stream;

const SIDE: usize = 96;
const PICTURES: u64 = 24;
/// Cells of the clouds across a picture, and their color amplitude.
const CLOUDS: [(usize, f64); 2] = [(3, 0.6), (12, 0.25)];

/// The pictures; deterministic.
pub(super) fn swatches() -> impl Iterator<Item = Rgb<f32>> {
    (0..PICTURES).map(|picture| {
        let stream = Stream::stage(picture, "colour table");
        let mean = [0, 1, 2].map(|channel| stream.unit(0, channel));
        let grids = CLOUDS.map(|(cells, reach)| {
            let columns = cells + 2;
            let node = |at: usize| {
                [0, 1, 2].map(|channel| reach * (stream.unit(cells as u64, (3 * at + channel) as u64) - 0.5))
            };
            (
                cells,
                columns,
                (0..columns * columns).map(node).collect::<Vec<_>>(),
            )
        });
        Rgb::from_fn(SIDE, SIDE, |x, y| {
            let mut color = mean;
            for (cells, columns, grid) in &grids {
                let place = |at: usize| {
                    let exact = at as f64 * *cells as f64 / SIDE as f64;
                    (exact as usize, exact.fract())
                };
                let ((column, u), (row, v)) = (place(x), place(y));
                for (channel, value) in color.iter_mut().enumerate() {
                    let node =
                        |right: usize, down: usize| grid[(row + down) * columns + column + right][channel];
                    let above = node(0, 0) + (node(1, 0) - node(0, 0)) * u;
                    let below = node(0, 1) + (node(1, 1) - node(0, 1)) * u;
                    *value += above + (below - above) * v;
                }
            }
            color.map(|value| value.clamp(0.0, 1.0) as f32)
        })
    })
}
