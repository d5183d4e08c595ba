//! Simple pictures: a cloudy ground with rectangles, discs and checkers in any color.

use imaging::random::Stream;

use crate::tensor::Tensor;

/// Far end of the range, which falls towards the lower edge.
const GROUND_M: f32 = 12.0;

pub(super) fn draw(chance: &ContentChance) -> Air {
    let mut light = Tensor::zeros(3, SIDE, SIDE);
    let seed = chance.stream.bits(chance.index, 3);
    let ground = clouds(seed);
    let (dark, bright) = (draw_color(chance, "dark", 0), draw_color(chance, "bright", 0));
    for channel in 0..3 {
        for (value, cloud) in light.plane_mut(channel).iter_mut().zip(&ground) {
            let share = (0.5 + 0.25 * cloud).clamp(0.0, 1.0);
            *value = dark[channel] + (bright[channel] - dark[channel]) * share;
        }
    }
    let mut range: Vec<f32> = (0..SIDE * SIDE)
        .map(|at| GROUND_M * (1.1 - (at / SIDE) as f32 / SIDE as f32))
        .collect();
    let count = 2 + (chance.unit("count") * 9.0) as u64;
    for shape in 0..count {
        let side = SIDE as f64;
        let [x, y] = ["x", "y"].map(|name| chance.uniform(name, shape, 0.0, side));
        let [half_width, half_height] =
            ["width", "height"].map(|name| chance.uniform(name, shape, 4.0, 0.3 * side));
        let kind = chance.uniform("kind", shape, 0.0, 3.0) as u32;
        let cell = chance.uniform("cell", shape, 3.0, 16.0);
        let [first, second] = ["one", "other"].map(|name| draw_color(chance, name, shape));
        let distance = (GROUND_M as f64 * (1.0 - (shape as f64 + 0.5) / (count as f64 + 1.0))) as f32;
        for v in (y - half_height).max(0.0) as usize..((y + half_height) as usize).min(SIDE) {
            for u in (x - half_width).max(0.0) as usize..((x + half_width) as usize).min(SIDE) {
                let (across, down) = ((u as f64 - x) / half_width, (v as f64 - y) / half_height);
                if kind == 1 && across * across + down * down > 1.0 {
                    continue;
                }
                let odd = ((u as f64 / cell) as usize + (v as f64 / cell) as usize) % 2 == 1;
                let paint = if kind == 2 && odd { second } else { first };
                // Round shapes darken towards their sides.
                let shade = if kind == 0 {
                    1.0
                } else {
                    (1.0 - 0.5 * across * across) as f32
                };
                for channel in 0..3 {
                    light.row_mut(channel, v)[u] = paint[channel] * shade;
                }
                range[v * SIDE + u] = distance;
            }
        }
    }
    Air { light, range }
}

/// Cloudy noise of mean 0 and variance 1, row-major: random values on grids of increasing resolution, smoothly
/// interpolated.
fn clouds(seed: u64) -> Vec<f32> {
    const COARSEST_CELLS: usize = 3;
    const OCTAVES: u64 = 5;
    let stream = Stream::stage(seed, "ground");
    let mut sums = vec![0.0f64; SIDE * SIDE];
    for octave in 0..OCTAVES {
        let cells = COARSEST_CELLS << octave;
        let columns = cells + 2;
        let amplitude = libm::exp2(-1.2 * octave as f64);
        let grid: Vec<f64> = (0..(columns * columns) as u64)
            .map(|node| stream.unit(octave, node) - 0.5)
            .collect();
        // Cell and smoothed position inside it.
        for (pixel, sum) in sums.iter_mut().enumerate() {
            let [(column, u), (row, v)] = [pixel % SIDE, pixel / SIDE].map(|place| {
                let place = place as f64 * cells as f64 / SIDE as f64;
                let inside = place.fract();
                (place as usize, inside * inside * (3.0 - 2.0 * inside))
            });
            let (upper, lower) = (
                &grid[row * columns + column..],
                &grid[(row + 1) * columns + column..],
            );
            let above = upper[0] + (upper[1] - upper[0]) * u;
            let below = lower[0] + (lower[1] - lower[0]) * u;
            *sum += amplitude * (above + (below - above) * v);
        }
    }
    let count = sums.len() as f64;
    let mean = sums.iter().sum::<f64>() / count;
    let variance = sums.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / count;
    let scale = 1.0 / variance.sqrt();
    sums.into_iter().map(|v| ((v - mean) * scale) as f32).collect()
}

fn draw_color(chance: &ContentChance, name: &str, number: u64) -> [f32; 3] {
    [0, 1, 2].map(|channel| chance.uniform(name, 3 * number + channel, 0.0, 1.0).powi(2) as f32)
}

/// Side of a content picture in pixels; training uses smaller crops of it.
pub const SIDE: usize = 192;

/// A picture in air: linear light, and the range of each pixel in meters.
pub(super) struct Air {
    pub(super) light: Tensor<f32>,
    pub(super) range: Vec<f32>,
}

/// Random values of one picture, by name.
pub(super) struct ContentChance {
    pub(super) stream: Stream,
    pub(super) index: u64,
}

impl ContentChance {
    pub(super) fn unit(&self, name: &str) -> f64 {
        self.numbered(name, 0)
    }

    /// The address is the FNV-1a hash of the name with a number.
    pub(super) fn numbered(&self, name: &str, number: u64) -> f64 {
        let hash = name.bytes().fold(0xcbf2_9ce4_8422_2325u64, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3)
        });
        self.stream.unit(self.index, hash.wrapping_add(number))
    }

    pub(super) fn uniform(&self, name: &str, number: u64, low: f64, high: f64) -> f64 {
        low + (high - low) * self.numbered(name, number)
    }
}
