//! Contrast-limited adaptive histogram equalization (Zuiderveld 1994), in the variant of OpenCV.
//!
//! A grid of tiles covers the picture. Each tile's histogram is clipped at a multiple of its mean bin, the excess is
//! spread over all bins, and the cumulative histogram becomes the tile's table. A pixel blends the tables of the four
//! nearest tile centers bilinearly.

use imaging::{Plane, reflected, vectorized};

type TileTable = [u8; 256];

/// Partial histograms of a tile. In a single one, equal neighbors, frequent in smooth pictures, would wait for the previous
/// increment.
const LANES: usize = 4;

type Lanes = [[u32; 256]; LANES];

/// Equalizes a plane of at least one pixel. `[across, down]` is the number of tiles, at least one each;
/// `clip_limit` is in mean bins; 0 disables clipping.
///
/// If either side is not a multiple of its number of tiles, both are extended by reflection for the histograms: by
/// `tiles - side mod tiles`, which is a whole row of pixels per tile on a side that did divide.
#[must_use]
pub fn clahe(picture: &Plane<u8>, [across, down]: [usize; 2], clip_limit: f64) -> Plane<u8> {
    let tiles = TileGrid::new(picture.size(), across, down);
    let tables = tiles.tables(picture, clip_limit);
    let (width, height) = picture.size();
    let columns: Vec<Neighbors> = (0..width).map(|x| Neighbors::new(x, tiles.width_px)).collect();
    let weights: Vec<f32> = columns.iter().map(|column| column.weight).collect();
    let gaps: Vec<Gap> = columns
        .chunk_by(|a, b| a.gap == b.gap)
        .map(Gap::of_columns)
        .collect();
    let mut equalized = Plane::filled(width, height, 0u8);
    let mut blends = Vec::new();
    let mut blended_gap = None;
    for y in 0..height {
        let row = Neighbors::new(y, tiles.height_px);
        if blended_gap != Some(row.gap) {
            let [upper, lower] = [row.gap.saturating_sub(1), row.gap.min(down - 1)]
                .map(|row| &tables[row * across..][..across]);
            blends = blend_tables(upper, lower);
            blended_gap = Some(row.gap);
        }
        let (from, to) = (picture.row(y), equalized.row_mut(y));
        vectorized!(blend_row(from, &gaps, &weights, &blends, row.weight, to));
    }
    equalized
}

/// The grid over the extended picture.
struct TileGrid {
    across: usize,
    down: usize,
    width_px: usize,
    height_px: usize,
}

impl TileGrid {
    fn new((width, height): (usize, usize), across: usize, down: usize) -> Self {
        let (mut extended_width, mut extended_height) = (width, height);
        if !width.is_multiple_of(across) || !height.is_multiple_of(down) {
            extended_width += across - width % across;
            extended_height += down - height % down;
        }
        Self {
            across,
            down,
            width_px: extended_width / across,
            height_px: extended_height / down,
        }
    }

    /// One table per tile, row-major.
    fn tables(&self, picture: &Plane<u8>, clip_limit: f64) -> Vec<TileTable> {
        let (width, height) = picture.size();
        let extended_width = self.across * self.width_px;
        let columns: Vec<usize> = (0..extended_width)
            .map(|x| reflected(x as isize, width))
            .collect();
        let inside = width / self.width_px;
        let mut tables = Vec::with_capacity(self.across * self.down);
        for tile_row in 0..self.down {
            let mut histograms: Vec<Lanes> = vec![[[0; 256]; LANES]; self.across];
            for y in tile_row * self.height_px..(tile_row + 1) * self.height_px {
                let row = picture.row(reflected(y as isize, height));
                let (whole, partial) = histograms.split_at_mut(inside.min(self.across));
                for (lanes, codes) in whole.iter_mut().zip(row.chunks_exact(self.width_px)) {
                    count_codes(codes, lanes);
                }
                let rest = &columns[whole.len() * self.width_px..];
                for (lanes, columns) in partial.iter_mut().zip(rest.chunks_exact(self.width_px)) {
                    for &column in columns {
                        lanes[0][usize::from(row[column])] += 1;
                    }
                }
            }
            let histograms = histograms.iter().map(add_lanes);
            tables.extend(histograms.map(|histogram| self.table(histogram, clip_limit)));
        }
        tables
    }

    fn table(&self, mut histogram: [u32; 256], clip_limit: f64) -> TileTable {
        let area = self.width_px * self.height_px;
        if clip_limit > 0.0 {
            let limit = ((clip_limit * area as f64 / 256.0) as u32).max(1);
            clip(&mut histogram, limit);
        }
        let scale = 255.0 / area as f32;
        let mut cumulative = 0u32;
        histogram.map(|count| {
            cumulative += count;
            round_ties_even(cumulative as f32 * scale)
        })
    }
}

/// Counts consecutive codes in different partial histograms.
fn count_codes(codes: &[u8], lanes: &mut Lanes) {
    let quads = codes.chunks_exact(LANES);
    for &code in quads.remainder() {
        lanes[0][usize::from(code)] += 1;
    }
    for quad in quads {
        for (lane, &code) in lanes.iter_mut().zip(quad) {
            lane[usize::from(code)] += 1;
        }
    }
}

fn add_lanes(lanes: &Lanes) -> [u32; 256] {
    std::array::from_fn(|code| lanes.iter().map(|lane| lane[code]).sum())
}

/// Clips every bin at `limit` and spreads the excess: equally, then singly at equal steps.
fn clip(histogram: &mut [u32; 256], limit: u32) {
    let excess: u32 = histogram.iter().map(|count| count.saturating_sub(limit)).sum();
    for count in histogram.iter_mut() {
        *count = (*count).min(limit) + excess / 256;
    }
    let residual = (excess % 256) as usize;
    if let Some(step) = 256usize.checked_div(residual) {
        for count in histogram.iter_mut().step_by(step).take(residual) {
            *count += 1;
        }
    }
}

/// Position of a pixel between tile centers along one axis.
#[derive(Clone, Copy)]
struct Neighbors {
    /// The gap between centers, equal to the number of the following tile; 0 before the first center.
    gap: usize,
    /// Weight of the following tile.
    weight: f32,
}

impl Neighbors {
    fn new(position: usize, tile_px: usize) -> Self {
        let centered = position as f64 / tile_px as f64 - 0.5;
        let floor = centered.floor();
        Self {
            gap: (floor + 1.0) as usize,
            weight: (centered - floor) as f32,
        }
    }
}

/// For each gap between tile centers and each code: the four table entries in one word, low byte first in the order
/// upper left, upper right, lower left, lower right. One look-up per pixel instead of four.
fn blend_tables(upper: &[TileTable], lower: &[TileTable]) -> Vec<[u32; 256]> {
    let last = upper.len() - 1;
    let gaps = (0..=upper.len()).map(|gap| {
        let (left, right) = (gap.saturating_sub(1), gap.min(last));
        let tables = [&upper[left], &upper[right], &lower[left], &lower[right]];
        std::array::from_fn(|code| u32::from_le_bytes(tables.map(|table| table[code])))
    });
    gaps.collect()
}

/// Consecutive columns between the same tile centers.
struct Gap {
    number: usize,
    columns: usize,
}

impl Gap {
    fn of_columns(columns: &[Neighbors]) -> Self {
        Self {
            number: columns[0].gap,
            columns: columns.len(),
        }
    }
}

#[inline(always)]
fn blend_row(from: &[u8], gaps: &[Gap], weights: &[f32], blends: &[[u32; 256]], b: f32, to: &mut [u8]) {
    const BLOCK: usize = 64;
    let mut start = 0;
    for gap in gaps {
        let (table, columns) = (&blends[gap.number], start..start + gap.columns);
        start = columns.end;
        let blocks = from[columns.clone()]
            .chunks(BLOCK)
            .zip(to[columns.clone()].chunks_mut(BLOCK));
        for ((from, to), weights) in blocks.zip(weights[columns].chunks(BLOCK)) {
            let mut entries = [0u32; BLOCK];
            for (entry, &code) in entries.iter_mut().zip(from) {
                *entry = table[usize::from(code)];
            }
            for ((to, &entry), &a) in to.iter_mut().zip(&entries).zip(weights) {
                let [left, right] = [extract_byte(entry, 0), extract_byte(entry, 1)];
                let upper = left + a * (right - left);
                let [left, right] = [extract_byte(entry, 2), extract_byte(entry, 3)];
                let lower = left + a * (right - left);
                *to = round_ties_even(upper + b * (lower - upper));
            }
        }
    }
}

#[inline(always)]
fn extract_byte(word: u32, byte: u32) -> f32 {
    ((word >> (8 * byte)) & 255) as i32 as f32
}

/// Rounds a value within 0..=255: adding 2^23 leaves no bit for the fraction.
#[inline(always)]
fn round_ties_even(value: f32) -> u8 {
    (value + 8_388_608.0).to_bits() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn excess_is_spread_equally_and_its_rest_at_equal_steps() {
        let mut histogram = [0u32; 256];
        histogram[7] = 256 + 3 + 10;
        clip(&mut histogram, 10);
        // 259 over the limit: one for every bin, and the remaining three in bins 0, 85 and 170.
        assert_eq!(histogram[7], 11);
        assert_eq!(
            (histogram[0], histogram[85], histogram[170], histogram[255]),
            (2, 2, 2, 1)
        );
        assert_eq!(histogram.iter().sum::<u32>(), 269);
    }

    #[test]
    fn a_divisible_side_is_extended_when_the_other_is_not() {
        let both = TileGrid::new((80, 60), 8, 8);
        assert_eq!((both.width_px, both.height_px), (11, 8));
        let neither = TileGrid::new((80, 64), 8, 8);
        assert_eq!((neither.width_px, neither.height_px), (10, 8));
    }

    #[test]
    fn one_tile_without_clipping_is_plain_equalization() {
        let picture = Plane::new(4, 1, vec![10u8, 20, 30, 40]).unwrap();
        // Cumulative counts 1..4 of 4, in steps of 63.75.
        assert_eq!(clahe(&picture, [1, 1], 0.0).data(), &[64, 128, 191, 255]);
    }

    #[test]
    fn a_picture_of_one_pixel_goes_through_a_grid_of_any_size() {
        for tiles in [[1, 1], [8, 8], [256, 3]] {
            assert_eq!(clahe(&Plane::filled(1, 1, 9u8), tiles, 2.0).size(), (1, 1));
        }
    }

    #[test]
    fn values_are_rounded_half_to_even() {
        assert_eq!(
            [0.5, 1.5, 2.5, 254.5, 255.0].map(round_ties_even),
            [0, 2, 2, 254, 255]
        );
    }
}
