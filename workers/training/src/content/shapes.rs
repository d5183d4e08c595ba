//! Simple pictures: a cloudy ground with rectangles, discs and checkers in any colour.

use super::{Air, Chance, SIDE};
use crate::clouds::clouds;
use crate::tensor::Tensor;

/// Far end of the range, which falls towards the lower edge.
const GROUND_M: f32 = 12.0;

pub(super) fn draw(chance: &Chance) -> Air {
    let mut light = Tensor::zeros(3, SIDE, SIDE);
    let seed = chance.stream.bits(chance.index, 3);
    let ground = clouds(seed, "ground", (SIDE, SIDE), 3.0, 5);
    let colour = |name: &str, number: u64| {
        [0, 1, 2].map(|channel| chance.between(name, 3 * number + channel, 0.0, 1.0).powi(2) as f32)
    };
    let (dark, bright) = (colour("dark", 0), colour("bright", 0));
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
        let of = |name: &str, low: f64, high: f64| chance.between(name, shape, low, high);
        let side = SIDE as f64;
        let (x, y) = (of("x", 0.0, side), of("y", 0.0, side));
        let (half_width, half_height) = (of("width", 4.0, 0.3 * side), of("height", 4.0, 0.3 * side));
        let kind = of("kind", 0.0, 3.0) as u32;
        let cell = of("cell", 3.0, 16.0);
        let (one, other) = (colour("one", shape), colour("other", shape));
        let distance = (GROUND_M as f64 * (1.0 - (shape as f64 + 0.5) / (count as f64 + 1.0))) as f32;
        for v in (y - half_height).max(0.0) as usize..((y + half_height) as usize).min(SIDE) {
            for u in (x - half_width).max(0.0) as usize..((x + half_width) as usize).min(SIDE) {
                let (across, down) = ((u as f64 - x) / half_width, (v as f64 - y) / half_height);
                if kind == 1 && across * across + down * down > 1.0 {
                    continue;
                }
                let odd = ((u as f64 / cell) as usize + (v as f64 / cell) as usize) % 2 == 1;
                let paint = if kind == 2 && odd { other } else { one };
                // Round things are darker at their side.
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
