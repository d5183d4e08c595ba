//! Clouds on few rays: transmittance and added light up to each distance; pixels are interpolated between four rays and two
//! distances.

use imaging::{Plane, Rgb, cancel};

use super::{Clouds, Drift, Murk, end};
use crate::lit_point::LitPoint;

/// Pixels between rays.
const CELL_PX: usize = 6;
/// Distances of a ray.
const SLICES: usize = 48;

/// Transmittance and added light of clouds up to some distances on some rays.
#[derive(Debug, Clone)]
pub struct Layers {
    columns: usize,
    /// Length of a slice, m.
    step: f64,
    /// For each ray and distance, the nearest first: transmittance and added light, R, G, B.
    nodes: Vec<[f32; 6]>,
    /// Whether all rays are free of clouds.
    is_clear: bool,
    /// See [`Clouds::most_opacity`].
    most_opacity: f64,
}

const NOTHING: [f32; 6] = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0];

/// Follows the rays of a picture through the clouds, up to the farthest of its ranges.
#[must_use]
pub fn layers(range: &Plane<f32>, clouds: &Clouds, murk: &Murk<'_>) -> Layers {
    let most_opacity = clouds.most_opacity(range);
    if most_opacity == 0.0 {
        return Layers::clear();
    }
    let (width, height) = range.size();
    let ends = cell_ends(range);
    let step = ends.iter().copied().fold(0.0, f64::max).max(1e-3) / SLICES as f64;
    let (columns, rows) = (width.div_ceil(CELL_PX) + 1, height.div_ceil(CELL_PX) + 1);
    let mut nodes = Vec::with_capacity(columns * rows * (SLICES + 1));
    let mut is_clear = true;
    let mut drifts = Vec::new();
    for row in 0..rows {
        cancel::check();
        let at = |cell: usize, side: usize| (cell * CELL_PX).min(side - 1) as f64;
        let ray = |column: usize| clouds.eye.ray(at(column, width), at(row, height));
        drifts.clear();
        for column in 0..columns {
            let slices = (farthest_beside(&ends, columns, (column, row)) / step) as usize + 1;
            let along = Drift::along(clouds, ray(column), slices.min(SLICES), step);
            drifts.extend(along.map(|drift| Met::new(column, drift, murk)));
        }
        let points: Vec<LitPoint> = drifts.iter().map(Met::point).collect();
        let colors = clouds.colors(murk, &points);
        is_clear &= drifts.is_empty();
        let mut met = drifts.iter().zip(colors).peekable();
        for column in 0..columns {
            let mut node = NOTHING;
            nodes.push(node);
            for slice in 0..SLICES {
                let cloud = met.next_if(|(met, _)| (met.column, met.drift.slice) == (column, slice));
                if let Some((met, color)) = cloud {
                    for i in 0..3 {
                        let share = (met.drift.stopped * met.through[i]) as f32;
                        node[3 + i] += node[i] * share * color[i] as f32;
                        node[i] *= 1.0 - share;
                    }
                }
                nodes.push(node);
            }
        }
    }
    Layers {
        columns,
        step,
        nodes,
        is_clear,
        most_opacity,
    }
}

/// A cloud on a slice of a ray.
struct Met {
    column: usize,
    drift: Drift,
    /// Transmittance of the water before it.
    through: [f64; 3],
}

impl Met {
    fn new(column: usize, drift: Drift, murk: &Murk<'_>) -> Self {
        Self {
            column,
            through: drift.through(murk),
            drift,
        }
    }

    /// Its weight is that of a whole ray of such slices, so that their errors add to at most that of one.
    fn point(&self) -> LitPoint {
        let clearest = self.through.into_iter().fold(0.0, f64::max);
        self.drift
            .point((SLICES as f64 * self.drift.stopped * clearest).min(1.0))
    }
}

/// The farthest end of the pixels of each cell, m, by rows.
fn cell_ends(range: &Plane<f32>) -> Vec<f64> {
    let (width, height) = range.size();
    let (columns, rows) = (width.div_ceil(CELL_PX), height.div_ceil(CELL_PX));
    let mut ends = vec![0.0f64; columns * rows];
    for y in 0..height {
        for (x, &z) in range.row(y).iter().enumerate() {
            let cell = &mut ends[y / CELL_PX * columns + x / CELL_PX];
            *cell = cell.max(end(z));
        }
    }
    ends
}

/// The farthest end among the cells around a ray, m: no pixel and no particle there reads clouds beyond it. `columns` is the number of
/// rays in a row.
fn farthest_beside(ends: &[f64], columns: usize, (column, row): (usize, usize)) -> f64 {
    let wide = columns - 1;
    let high = ends.len() / wide;
    let near = |at: usize, count: usize| at.saturating_sub(1)..(at + 1).min(count);
    let cells = near(row, high).flat_map(|y| near(column, wide).map(move |x| ends[y * wide + x]));
    cells.fold(0.0, f64::max)
}

impl Layers {
    /// Those of a picture without clouds.
    fn clear() -> Self {
        Self {
            columns: 0,
            step: 1.0,
            nodes: Vec::new(),
            is_clear: true,
            most_opacity: 0.0,
        }
    }

    /// Upper bound of the opacity of a pixel, even between the rays.
    #[must_use]
    pub fn most_opacity(&self) -> f64 {
        self.most_opacity
    }

    /// Composites the clouds over a picture in linear light, in place; returns their opacity in green.
    #[must_use]
    pub fn veil(&self, image: &mut Rgb<f32>, range: &Plane<f32>) -> Plane<f32> {
        let (width, height) = range.size();
        let mut mask = Plane::filled(width, height, 0.0f32);
        if self.is_clear {
            return mask;
        }
        let planes = image.planes_mut();
        for y in 0..height {
            cancel::check();
            for x in 0..width {
                let at = y * width + x;
                let node = self.at([x as f64, y as f64], end(range.data()[at]), (width, height));
                for i in 0..3 {
                    planes[i][at] = planes[i][at] * node[i] + node[3 + i];
                }
                mask.data_mut()[at] = 1.0 - node[1];
            }
        }
        mask
    }

    /// Transmittance in green up to a point of the picture at this range.
    #[must_use]
    pub fn clear_to(&self, [x, y]: [f64; 2], range_m: f64, size: (usize, usize)) -> f64 {
        if self.is_clear {
            return 1.0;
        }
        let inside = |v: f64, side: usize| v.clamp(0.0, side as f64 - 1.0);
        let place = [inside(x, size.0), inside(y, size.1)];
        f64::from(self.at(place, range_m.min(SLICES as f64 * self.step), size)[1])
    }

    fn at(&self, [x, y]: [f64; 2], range_m: f64, (width, height): (usize, usize)) -> [f32; 6] {
        // The last cell of a row may be narrower.
        let cell = |v: f64, side: usize| {
            let first = (v as usize / CELL_PX) * CELL_PX;
            let wide = CELL_PX.min(side - 1 - first.min(side - 1)).max(1);
            (
                first / CELL_PX,
                ((v - first as f64) / wide as f64).min(1.0) as f32,
            )
        };
        let ((column, across), (row, down)) = (cell(x, width), cell(y, height));
        let deep = (range_m / self.step).min(SLICES as f64 - 1e-9).max(0.0);
        let (slice, along) = (deep as usize, deep.fract() as f32);
        let mut sum = [0.0f32; 6];
        for (dy, share_y) in [(0, 1.0 - down), (1, down)] {
            for (dx, share_x) in [(0, 1.0 - across), (1, across)] {
                let ray = ((row + dy) * self.columns + column + dx) * (SLICES + 1) + slice;
                let (near, far) = (&self.nodes[ray], &self.nodes[ray + 1]);
                let share = share_x * share_y;
                for i in 0..6 {
                    sum[i] += share * (near[i] + (far[i] - near[i]) * along);
                }
            }
        }
        sum
    }
}
