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
            let nodes = (0..columns * columns).map(|node| {
                [0, 1, 2]
                    .map(|channel| reach * (stream.unit(cells as u64, (3 * node + channel) as u64) - 0.5))
            });
            (cells, columns, nodes.collect::<Vec<_>>())
        });
        Rgb::from_fn(SIDE, SIDE, |x, y| {
            let mut color = mean;
            for (cells, columns, grid) in &grids {
                let [(column, u), (row, v)] = [x, y].map(|position| {
                    let exact = position as f64 * *cells as f64 / SIDE as f64;
                    (exact as usize, exact.fract())
                });
                for (channel, value) in color.iter_mut().enumerate() {
                    let [above, below] = [row, row + 1].map(|row| {
                        let [left, right] = [0, 1].map(|step| grid[row * columns + column + step][channel]);
                        left + (right - left) * u
                    });
                    *value += above + (below - above) * v;
                }
            }
            color.map(|value| value.clamp(0.0, 1.0) as f32)
        })
    })
}
