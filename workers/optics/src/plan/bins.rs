//! The largest radiance by range, in one look at a scene.

use imaging::{Plane, Rgb, vectorized};

use crate::range::{SHORTEST_M, is_hole};

/// Bits of a float below its exponent and three more: eight bins for each factor of two.
const BIN_SHIFT: u32 = 20;
/// Bins of all positive floats.
const BINS: usize = (f32::INFINITY.to_bits() >> BIN_SHIFT) as usize;
/// Pixels in one step: most neighbors share a bin.
const RUN: usize = 16;

/// The lit bins, nearest first.
pub(super) fn binned(radiance: &Rgb<f32>, gains: Option<&TileGains>, range: &Plane<f32>) -> Vec<RangeBin> {
    // Brightness 0 marks an empty bin: a dark pixel spreads no light.
    let mut brightest = vec![[0.0f32; 3]; BINS];
    let planes = radiance.planes();
    match gains {
        None => {
            let light = planes.each_ref().map(Plane::data);
            vectorized!(fill(light, range.data(), [1.0; 3], &mut brightest));
        }
        Some(gains) => {
            for y in 0..range.height() {
                let rows = planes.each_ref().map(|plane| plane.row(y));
                for (tile, meters) in range.row(y).chunks(gains.side_px).enumerate() {
                    let x = tile * gains.side_px;
                    let light = rows.map(|row| &row[x..x + meters.len()]);
                    vectorized!(fill(light, meters, gains.tile_gain(x, y), &mut brightest));
                }
            }
        }
    }
    let edge = |bin: usize| f64::from(f32::from_bits((bin as u32) << BIN_SHIFT));
    let lit = brightest
        .into_iter()
        .enumerate()
        .filter(|(_, bin)| bin.iter().any(|&light| light > 0.0));
    lit.map(|(bin, brightest)| RangeBin {
        meters: (edge(bin), edge(bin + 1).min(f64::from(f32::MAX))),
        brightest,
    })
    .collect()
}

#[inline(always)]
fn fill(light: [&[f32]; 3], range: &[f32], gain: [f32; 3], brightest: &mut [[f32; 3]]) {
    let [r, g, b] = light;
    for (start, run) in range.chunks(RUN).enumerate().map(|(i, run)| (i * RUN, run)) {
        let [r, g, b] = [r, g, b].map(|plane| &plane[start..start + run.len()]);
        if let Some(bin) = common_bin(run) {
            let bin = &mut brightest[bin];
            for ((most, plane), gain) in bin.iter_mut().zip([r, g, b]).zip(gain) {
                *most = most.max(gain * largest(plane));
            }
            continue;
        }
        for (i, &z) in run.iter().enumerate().filter(|(_, z)| !is_hole(**z)) {
            let bin = &mut brightest[bin_of(z)];
            *bin = [
                bin[0].max(gain[0] * r[i]),
                bin[1].max(gain[1] * g[i]),
                bin[2].max(gain[2] * b[i]),
            ];
        }
    }
}

fn bin_of(z: f32) -> usize {
    (z.to_bits() >> BIN_SHIFT) as usize
}

/// The bin of a whole run without a hole, if there is one.
#[inline(always)]
fn common_bin(run: &[f32]) -> Option<usize> {
    let run: &[f32; RUN] = run.try_into().ok()?;
    let (mut least, mut most) = (u32::MAX, 0);
    for z in run {
        // Negative numbers have the sign bit, NaN and infinity the greatest exponent.
        least = least.min(z.to_bits());
        most = most.max(z.to_bits());
    }
    let no_hole = least >= (SHORTEST_M as f32).to_bits() && most < f32::INFINITY.to_bits();
    let bin = least >> BIN_SHIFT;
    (no_hole && bin == most >> BIN_SHIFT).then_some(bin as usize)
}

#[inline(always)]
fn largest(light: &[f32]) -> f32 {
    let mut most = 0.0f32;
    for &l in light {
        most = if l > most { l } else { most };
    }
    most
}

/// Pixels between two ranges that differ by less than an eighth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RangeBin {
    /// The two distances in meters.
    pub meters: (f64, f64),
    /// Largest radiance of each channel among them.
    pub brightest: [f32; 3],
}

/// Upper bounds of the light on surfaces, before any is computed: the largest factor of a scene's radiance in each tile.
#[derive(Debug, Clone, PartialEq)]
pub struct TileGains {
    /// Columns and rows of a tile, pixels.
    pub side_px: usize,
    /// Tiles in a row.
    pub columns: usize,
    /// Tile by tile, row by row.
    pub most: Vec<[f32; 3]>,
    /// Root mean square of the factor in each tile; less than the largest in a pattern of light.
    pub root_mean_square: Vec<[f32; 3]>,
    /// The least that the radiance is multiplied by anywhere.
    pub least: [f32; 3],
}

impl TileGains {
    /// The bound of a pixel's tile.
    pub(super) fn tile_gain(&self, x: usize, y: usize) -> [f32; 3] {
        self.most[y / self.side_px * self.columns + x / self.side_px]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_one_bin_count_like_their_pixels() {
        // Slopes, steps and holes, with a length that is not a multiple of a run.
        let range = Plane::from_fn(101, 7, |x, y| match (x, y) {
            (_, 0) => 1.0 + 0.001 * x as f32,
            (_, 1) => 0.01 * x as f32,
            (x, 2) if x % 17 == 3 => f32::NAN,
            (x, 3) if x % 5 == 0 => -3.0,
            (50, 4) => f32::INFINITY,
            (x, _) => 2.0 + (x / 30) as f32,
        });
        let radiance = Rgb::from_fn(101, 7, |x, y| [x as f32, y as f32, ((x * y) % 13) as f32]);
        let mut expected = vec![[0.0f32; 3]; BINS];
        for (i, &z) in range.data().iter().enumerate().filter(|(_, z)| !is_hole(**z)) {
            for (most, plane) in expected[bin_of(z)].iter_mut().zip(radiance.planes()) {
                *most = most.max(plane.data()[i]);
            }
        }
        expected.retain(|bin| bin.iter().any(|&light| light > 0.0));
        let bins = binned(&radiance, None, &range);
        assert_eq!(bins.iter().map(|bin| bin.brightest).collect::<Vec<_>>(), expected);
    }
}
