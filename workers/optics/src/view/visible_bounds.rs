//! Coarse bounds of a view: ranges, holes and radiance of square tiles of the picture.
//!
//! Stages are planned from these bounds, before any light is computed. Every pixel is within the bounds of its tile.

mod measure;

use imaging::geometry::Intrinsics;
use imaging::rays::Cuboid;
use imaging::vector::dot;
use imaging::{Plane, Rgb};
pub use measure::TILE_PX;

/// Depth limit for water without a surface behind it, m.
const FAR_M: f64 = 1e3;
/// First depth of a subdivision of the water, m, and the ratio of one depth to the previous one.
const FIRST_M: f64 = 0.25;
const GROWTH: f64 = 1.5;

/// Tiles of a view, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct VisibleBounds {
    /// Columns and rows of the picture.
    pub size: (usize, usize),
    /// Focal length, px.
    pub focal_px: f64,
    /// The tiles, `columns` to a row.
    pub tiles: Vec<Tile>,
    /// Tiles of a row.
    pub columns: usize,
}

/// Bounds of the pixels of one tile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tile {
    /// Least tangents x/z and y/z of the rays of its pixels.
    pub low: [f64; 2],
    /// Greatest tangents.
    pub high: [f64; 2],
    /// Least and greatest range of its surfaces, m; `None` if all its pixels are holes.
    pub range_m: Option<[f64; 2]>,
    /// Whether any of its pixels is a hole.
    pub has_holes: bool,
    /// Largest radiance in air of each channel.
    pub brightest: [f32; 3],
    /// Smallest radiance in air of each channel.
    pub darkest: [f32; 3],
}

/// A part of space that a tile shows.
pub(crate) struct Region {
    /// Its bounding box in camera axes.
    pub(crate) places: Cuboid,
    /// The most pixels that a meter across the line of sight spans.
    pub(crate) px_per_m: f64,
}

impl VisibleBounds {
    /// Bounds of a scene in air, which the camera sees at these ranges along the ray. One pass over the planes.
    ///
    /// # Panics
    /// If the planes differ in size.
    #[must_use]
    pub fn measure(radiance: &Rgb<f32>, range: &Plane<f32>, camera: &Intrinsics) -> Self {
        assert_eq!(radiance.size(), range.size(), "planes of one frame");
        let light = radiance.planes().each_ref().map(Plane::data);
        Self::from_extremes(range, camera, measure::extremes(range, Some(light)))
    }

    /// Bounds of the ranges alone, of a scene with a radiance of 1.
    #[must_use]
    pub fn measure_range(range: &Plane<f32>, camera: &Intrinsics) -> Self {
        Self::from_extremes(range, camera, measure::extremes(range, None))
    }

    fn from_extremes(range: &Plane<f32>, camera: &Intrinsics, extremes: Vec<measure::Extremes>) -> Self {
        let size = range.size();
        let columns = size.0.div_ceil(TILE_PX);
        let tiles = extremes.into_iter().enumerate().map(|(at, extremes)| {
            let (left, top) = (at % columns * TILE_PX, at / columns * TILE_PX);
            let (right, bottom) = ((left + TILE_PX).min(size.0), (top + TILE_PX).min(size.1));
            let [x, y, _] = <[f64; 3]>::from(camera.ray(left as f64, top as f64));
            let [x_end, y_end, _] = <[f64; 3]>::from(camera.ray((right - 1) as f64, (bottom - 1) as f64));
            Tile {
                low: [x, y],
                high: [x_end, y_end],
                range_m: extremes.range_m(),
                has_holes: extremes.has_holes,
                brightest: extremes.brightest,
                darkest: extremes.darkest,
            }
        });
        Self {
            size,
            focal_px: camera.focal_px,
            tiles: tiles.collect(),
            columns,
        }
    }

    /// Largest radiance in air of each channel.
    #[must_use]
    pub fn brightest(&self) -> [f32; 3] {
        let brightest = self.tiles.iter().map(|tile| tile.brightest);
        brightest.fold([0.0; 3], |most, tile| [0, 1, 2].map(|i| tile[i].max(most[i])))
    }

    /// Least and greatest range, m; `None` in a frame of holes.
    #[must_use]
    pub fn range_m(&self) -> Option<[f64; 2]> {
        let ranges = self.tiles.iter().filter_map(|tile| tile.range_m);
        ranges.reduce(|[least, most], [near, far]| [least.min(near), most.max(far)])
    }

    /// Bounds of squares of `side` tiles a side.
    pub(crate) fn merged(&self, side: usize) -> Vec<Tile> {
        let columns = self.columns.div_ceil(side).max(1);
        let rows = (self.tiles.len() / self.columns.max(1)).div_ceil(side);
        let mut all: Vec<Option<Tile>> = vec![None; columns * rows];
        for (at, tile) in self.tiles.iter().enumerate() {
            let (column, row) = (at % self.columns, at / self.columns);
            let square = &mut all[row / side * columns + column / side];
            *square = Some(square.map_or(*tile, |square| square.joined(tile)));
        }
        all.into_iter().flatten().collect()
    }

    /// Regions that hold the visible surfaces.
    pub(crate) fn surfaces(&self) -> impl Iterator<Item = Region> {
        self.tiles.iter().filter_map(|tile| {
            let [nearest, farthest] = tile.range_m?;
            let [least, most] = tile.stretch();
            Some(Region {
                places: tile.between([nearest / most, farthest / least]),
                px_per_m: self.focal_px * most * most / nearest,
            })
        })
    }

    /// Regions that hold the water in front of them, and the water of holes up to [`FAR_M`].
    pub(crate) fn water(&self) -> impl Iterator<Item = Region> {
        self.water_beyond(0.0)
    }

    /// The same from this range on.
    pub(crate) fn water_beyond(&self, near_m: f64) -> impl Iterator<Item = Region> {
        self.tiles.iter().flat_map(move |tile| {
            let first = near_m / tile.stretch()[1];
            let end = match tile.range_m {
                Some([_, farthest]) if !tile.has_holes => farthest / tile.stretch()[0],
                _ => FAR_M,
            };
            let depths = std::iter::successors(Some(FIRST_M), |depth| Some(GROWTH * depth));
            let begins = std::iter::once(0.0)
                .chain(depths)
                .take_while(move |depth| *depth < end);
            begins.filter_map(move |begin| {
                let last = (GROWTH * begin).max(FIRST_M).min(end);
                (last >= first).then(|| Region {
                    places: tile.between([begin.max(first), last]),
                    px_per_m: f64::INFINITY,
                })
            })
        })
    }
}

impl Tile {
    /// Least and greatest ratio of range to depth.
    pub(crate) fn stretch(&self) -> [f64; 2] {
        let near = [0, 1].map(|i| 0.0f64.clamp(self.low[i], self.high[i]));
        let far = [0, 1].map(|i| self.low[i].abs().max(self.high[i].abs()));
        [near, far].map(|[x, y]| dot([x, y, 1.0], [x, y, 1.0]).sqrt())
    }

    /// Bounds of the pixels of both tiles.
    fn joined(&self, other: &Self) -> Self {
        let range_m = match (self.range_m, other.range_m) {
            (Some([near, far]), Some([least, most])) => Some([near.min(least), far.max(most)]),
            (range, other) => range.or(other),
        };
        Self {
            low: [0, 1].map(|i| self.low[i].min(other.low[i])),
            high: [0, 1].map(|i| self.high[i].max(other.high[i])),
            range_m,
            has_holes: self.has_holes || other.has_holes,
            brightest: [0, 1, 2].map(|i| self.brightest[i].max(other.brightest[i])),
            darkest: [0, 1, 2].map(|i| self.darkest[i].min(other.darkest[i])),
        }
    }

    /// Bounding box of its rays between two depths.
    fn between(&self, [near, far]: [f64; 2]) -> Cuboid {
        let least = self.low.map(|slope| (slope * near).min(slope * far));
        let most = self.high.map(|slope| (slope * near).max(slope * far));
        Cuboid {
            low: [least[0], least[1], near],
            high: [most[0], most[1], far],
        }
    }
}

#[cfg(test)]
mod tests;
