//! Tiles at some depths in f32. Two of them share a transform, one as the real and one as the imaginary part: M is real and the
//! same in both directions.

use imaging::fft::{self, Complex, Ffts};
use imaging::vectorized;

use super::Waves;
use super::reference::RAYS_PER_CELL;
use crate::daylight::conditions::Blur;
use crate::daylight::model::REFRACTIVE_INDEX;

/// Number of tile depths; the pattern is interpolated between them.
const SLICES: usize = 8;
/// Least depth of caustics, m.
const SHALLOWEST_M: f64 = 0.2;
/// Depths in f32 are this close to the exact ones, as a share of them.
const DEPTH_ROUNDING: f64 = 1e-5;
/// Depths of a smaller ratio are one.
const ALIKE: f64 = 1.0001;

/// Depths in meters of the tiles for surfaces between two depths, in equal ratios.
#[must_use]
pub fn slices(shallowest_m: f64, deepest_m: f64) -> Vec<f64> {
    let first = shallowest_m.max(SHALLOWEST_M);
    let last = deepest_m.max(first);
    if last / first < ALIKE {
        return vec![first];
    }
    let at = |k: usize| first * (last / first).powf(k as f64 / (SLICES - 1) as f64);
    (0..SLICES).map(at).collect()
}

/// The pattern at some depths.
#[derive(Debug, Clone, PartialEq)]
pub struct Tiles {
    pub(super) waves: Waves,
    blur: Blur,
    pub(super) depths_m: Vec<f64>,
    /// Row by row, all depths of a cell side by side.
    pub(super) values: Vec<f32>,
    /// Of each depth.
    strengths: Vec<Strength>,
}

/// How strongly a pattern varies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strength {
    /// The largest value.
    pub peak: f64,
    /// Root mean square.
    pub root_mean_square: f64,
}

impl Strength {
    /// Of the values of one depth.
    fn measure(values: impl Iterator<Item = f32>) -> Self {
        let (mut peak, mut squares, mut count) = (0.0f32, 0.0, 0);
        for value in values {
            peak = peak.max(value);
            squares += f64::from(value) * f64::from(value);
            count += 1;
        }
        Self {
            peak: f64::from(peak),
            root_mean_square: (squares / f64::from(count.max(1))).sqrt(),
        }
    }

    /// At least both.
    fn or(self, other: Self) -> Self {
        Self {
            peak: self.peak.max(other.peak),
            root_mean_square: self.root_mean_square.max(other.root_mean_square),
        }
    }
}

impl Tiles {
    /// Makes the tiles.
    #[must_use]
    pub fn new(waves: &Waves, blur: &Blur, depths_m: Vec<f64>) -> Self {
        let (cells, count) = (waves.cells, depths_m.len());
        let slopes = slopes(waves);
        let mut transform = Transform::new(cells);
        let mut values = vec![0.0f32; cells * cells * count];
        for (pair, depths) in depths_m.chunks(2).enumerate() {
            let mut light = vec![Complex::new(0.0f32, 0.0); cells * cells];
            for (part, &depth) in depths.iter().enumerate() {
                let collected = collect(&slopes, waves, depth);
                for (light, v) in light.iter_mut().zip(collected) {
                    let half = if part == 0 { &mut light.re } else { &mut light.im };
                    *half = v;
                }
            }
            let gains = [depths[0], depths[depths.len() - 1]].map(|depth| gains(waves, blur, depth));
            transform.blur(&mut light, &gains);
            for part in 0..depths.len() {
                let own: Vec<f32> = light
                    .iter()
                    .map(|v| if part == 0 { v.re } else { v.im })
                    .collect();
                write(&own, &mut values, (2 * pair + part, count));
            }
        }
        let slice = |k: usize| values.iter().skip(k).step_by(count).copied();
        let strengths = (0..count).map(|k| Strength::measure(slice(k))).collect();
        Self {
            waves: *waves,
            blur: *blur,
            depths_m,
            values,
            strengths,
        }
    }

    /// Whether these are the tiles of such waves at these depths.
    #[must_use]
    pub fn are(&self, waves: &Waves, blur: &Blur, depths_m: &[f64]) -> bool {
        self.waves == *waves && self.blur == *blur && self.depths_m == depths_m
    }

    /// Where they are, in meters.
    #[must_use]
    pub fn depths_m(&self) -> &[f64] {
        &self.depths_m
    }

    /// The maximum.
    #[must_use]
    pub fn peak(&self) -> f64 {
        self.strengths
            .iter()
            .map(|strength| strength.peak)
            .fold(0.0, f64::max)
    }

    /// Upper bound of the pattern between two depths in meters: a value between two tiles is at most the greater of both.
    #[must_use]
    pub fn strength_between(&self, (shallowest, deepest): (f64, f64)) -> Strength {
        let last = self.depths_m.len() - 1;
        let (above, below) = (
            shallowest * (1.0 - DEPTH_ROUNDING),
            deepest * (1.0 + DEPTH_ROUNDING),
        );
        let first = self.depths_m[1..]
            .iter()
            .take_while(|&&depth| depth <= above)
            .count();
        let end = self.depths_m.iter().take_while(|&&depth| depth < below).count();
        let within = &self.strengths[first..=end.clamp(first, last)];
        within[1..].iter().fold(within[0], |most, &own| most.or(own))
    }

    /// The value of a cell at one of the depths.
    #[must_use]
    pub fn cell(&self, slice: usize, column: usize, row: usize) -> f32 {
        self.values[(row * self.waves.cells + column) * self.depths_m.len() + slice]
    }
}

/// Slopes of the surface where rays begin, times `(1 − 1/n)`, row by row.
fn slopes(waves: &Waves) -> [Vec<f32>; 2] {
    let side = RAYS_PER_CELL * waves.cells;
    let all = waves.all();
    let bend = 1.0 - 1.0 / REFRACTIVE_INDEX;
    let phases = |count: i32, phase: f64| -> Vec<[f32; 2]> {
        let step = std::f64::consts::TAU * f64::from(count) / side as f64;
        let at = |i: usize| (step * (i as f64 + 0.5) + phase).sin_cos();
        (0..side)
            .map(|i| {
                let (sine, cosine) = at(i);
                [sine as f32, cosine as f32]
            })
            .collect()
    };
    let columns: Vec<[Vec<f32>; 2]> = all
        .iter()
        .map(|wave| {
            let phases = phases(wave.counts[0], 0.0);
            [0, 1].map(|part| phases.iter().map(|phase| phase[part]).collect())
        })
        .collect();
    let rows: Vec<_> = all
        .iter()
        .map(|wave| phases(wave.counts[1], wave.phase))
        .collect();
    let mut slopes = [(); 2].map(|()| vec![0.0f32; side * side]);
    for j in 0..side {
        let [across, down] = slopes
            .each_mut()
            .map(|plane| &mut plane[j * side..(j + 1) * side]);
        for (wave, (columns, rows)) in all.iter().zip(columns.iter().zip(&rows)) {
            let size = wave.vector.map(|k| (-bend * wave.amplitude * k) as f32);
            let [sines, cosines] = columns;
            vectorized!(add_wave(across, down, (sines, cosines), rows[j], size));
        }
    }
    slopes
}

/// Adds a wave: the sine of a sum from those of its parts.
#[inline(always)]
fn add_wave(
    across: &mut [f32],
    down: &mut [f32],
    (sines, cosines): (&[f32], &[f32]),
    [sine, cosine]: [f32; 2],
    [x, y]: [f32; 2],
) {
    for (((across, down), s), c) in across.iter_mut().zip(down).zip(sines).zip(cosines) {
        let wave = s * cosine + c * sine;
        *across += x * wave;
        *down += y * wave;
    }
}

/// Light of the rays at a depth, cell by cell.
fn collect(slopes: &[Vec<f32>; 2], waves: &Waves, depth_m: f64) -> Vec<f32> {
    let (cells, side) = (waves.cells, RAYS_PER_CELL * waves.cells);
    let reach = (depth_m * cells as f64 / waves.tile_m) as f32;
    // Kept positive, so that cutting off is rounding down.
    let far = (cells * (1 + (depth_m / waves.tile_m) as usize)) as f32;
    let mut tile = vec![0.0f32; cells * cells];
    let mut ends = [(); 2].map(|()| vec![0.0f32; side]);
    let mask = cells - 1;
    for j in 0..side {
        let [xs, ys] = &mut ends;
        let of_row = |plane: &[f32]| j * side..(j + 1) * side.min(plane.len());
        let (across, down) = (&slopes[0][of_row(&slopes[0])], &slopes[1][of_row(&slopes[1])]);
        let row = (j as f32 + 0.5) / RAYS_PER_CELL as f32 - 0.5 + far;
        vectorized!(find_ends(xs, ys, (across, down), reach, (far, row)));
        for (&x, &y) in xs.iter().zip(ys.iter()) {
            let (left, top) = (x as usize, y as usize);
            let (u, v) = (x - left as f32, y - top as f32);
            let (left, top) = (left & mask, top & mask);
            let (right, bottom) = ((left + 1) & mask, (top + 1) & mask);
            let (above, below) = (0.25 * (1.0 - v), 0.25 * v);
            tile[top * cells + left] += above * (1.0 - u);
            tile[top * cells + right] += above * u;
            tile[bottom * cells + left] += below * (1.0 - u);
            tile[bottom * cells + right] += below * u;
        }
    }
    tile
}

#[inline(always)]
fn find_ends(
    xs: &mut [f32],
    ys: &mut [f32],
    (across, down): (&[f32], &[f32]),
    reach: f32,
    (far, row): (f32, f32),
) {
    let ends = xs.iter_mut().zip(ys).zip(across.iter().zip(down));
    for (i, ((x, y), (across, down))) in ends.enumerate() {
        let column = (i as i32 as f32 + 0.5) / RAYS_PER_CELL as f32 - 0.5 + far;
        *x = column + reach * across;
        *y = row + reach * down;
    }
}

/// M over the number of cells, for frequencies up to half of the cells along both sides.
fn gains(waves: &Waves, blur: &Blur, depth_m: f64) -> Vec<f32> {
    let half = waves.cells / 2 + 1;
    let transfer = blur.at(depth_m);
    let count = (waves.cells * waves.cells) as f64;
    let mut gains = vec![0.0f32; half * half];
    for a in 0..half {
        for b in a..half {
            let gain = (transfer((a as f64).hypot(b as f64) / waves.tile_m) / count) as f32;
            (gains[a * half + b], gains[b * half + a]) = (gain, gain);
        }
    }
    gains
}

/// Clamps a tile, scales its mean to 1 and writes it into its slice.
fn write(own: &[f32], values: &mut [f32], (slice, count): (usize, usize)) {
    let sum: f64 = own.iter().map(|&v| f64::from(v.max(0.0))).sum();
    let scale = (own.len() as f64 / sum) as f32;
    for (to, v) in values.chunks_exact_mut(count).zip(own) {
        to[slice] = v.max(0.0) * scale;
    }
}

/// Transforms of one size.
struct Transform {
    cells: usize,
    ffts: Ffts<f32>,
    other: Vec<Complex<f32>>,
    scratch: Vec<Complex<f32>>,
}

impl Transform {
    fn new(cells: usize) -> Self {
        let ffts = fft::single(cells);
        Self {
            cells,
            other: vec![Complex::new(0.0, 0.0); cells * cells],
            scratch: vec![Complex::default(); ffts.scratch],
            ffts,
        }
    }

    /// Blurs the real part by the first of the gains and the imaginary one by the second.
    fn blur(&mut self, light: &mut Vec<Complex<f32>>, gains: &[Vec<f32>; 2]) {
        self.ffts.forward.process_with_scratch(light, &mut self.scratch);
        self.transpose(light);
        self.ffts.forward.process_with_scratch(light, &mut self.scratch);
        self.scale(light, gains);
        self.ffts.inverse.process_with_scratch(light, &mut self.scratch);
        self.transpose(light);
        self.ffts.inverse.process_with_scratch(light, &mut self.scratch);
    }

    /// With the spectra A and B of two real tiles, that of A + i B at k and its conjugate at −k give both: `A = (S + S̄₋)/2` and
    /// `i B = (S − S̄₋)/2`.
    fn scale(&mut self, spectrum: &mut Vec<Complex<f32>>, gains: &[Vec<f32>; 2]) {
        let (cells, half) = (self.cells, self.cells / 2 + 1);
        let folded = |k: usize| k.min(cells - k);
        for a in 0..cells {
            let gains = gains
                .each_ref()
                .map(|gains| &gains[folded(a) * half..(folded(a) + 1) * half]);
            let opposite = (cells - a) % cells;
            for b in 0..cells {
                let s = spectrum[a * cells + b];
                let t = spectrum[opposite * cells + (cells - b) % cells].conj();
                let [mean, apart] = [
                    gains[0][folded(b)] + gains[1][folded(b)],
                    gains[0][folded(b)] - gains[1][folded(b)],
                ];
                self.other[a * cells + b] = s * (0.5 * mean) + t * (0.5 * apart);
            }
        }
        std::mem::swap(spectrum, &mut self.other);
    }

    fn transpose(&mut self, light: &mut Vec<Complex<f32>>) {
        let cells = self.cells;
        for (i, row) in self.other.chunks_exact_mut(cells).enumerate() {
            for (j, to) in row.iter_mut().enumerate() {
                *to = light[j * cells + i];
            }
        }
        std::mem::swap(light, &mut self.other);
    }
}
