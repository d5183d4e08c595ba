//! Bounds of a scene that plans are made from.

use imaging::{Plane, Rgb, vectorized};
use spec::{HoleRule, ScatterSource};

use super::bins;
use super::bins::{RangeBin, TileGains};
use crate::attenuation::OPAQUE;
use crate::extremes::{greatest, least};
use crate::forward_scatter::widest_px;
use crate::layering::Layering;
use crate::range::{bounds, filled as filled_range, is_hole};
use crate::visible_bounds::VisibleBounds;
use crate::water::{Scatter, Water};

/// Counting of distinct ranges stops here: beyond it, interpolation needs fewer kernels than there are ranges.
const MOST_DISTINCT: usize = 32;

/// Bounds of a scene as it enters the water.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneBounds {
    /// Nearest and farthest valid range in meters, holes by the water's rule; `None` if every pixel is a hole.
    pub range_m: Option<(f64, f64)>,
    /// The same of the pixels that spread light in a channel: with nonzero radiance that is not lost entirely.
    pub lit_m: [Option<(f64, f64)>; 3],
    /// The distinct ranges, if there are few.
    pub distinct_m: Option<Vec<f32>>,
    /// Largest radiance of each channel.
    pub brightest: [f32; 3],
    /// Smallest radiance of each channel.
    pub darkest: [f32; 3],
    /// Mean square of the radiance of each channel.
    pub mean_square: [f64; 3],
    /// Pixels without a range that the rule does not fill.
    pub holes: bool,
    /// The lit ranges, nearest first, with the largest radiance of each channel there.
    pub bins: Vec<RangeBin>,
    /// The layers of the frame; `None` without occlusion-aware scatter, or without an edge in depth.
    pub layering: Option<Layering>,
    /// The widest kernel that the frame's size admits, pixels.
    pub widest_px: f64,
    /// Pixels.
    pub pixels: usize,
}

impl SceneBounds {
    /// Measures a scene as it is lit. `radiance` and `range` are of one size.
    #[must_use]
    pub fn measure(radiance: &Rgb<f32>, range: &Plane<f32>, water: &Water) -> Self {
        Self::new(radiance, Extremes::measure(radiance), None, range, water)
    }

    /// Bounds a scene whose radiance will be multiplied by light. `view` holds the bounds of that radiance.
    #[must_use]
    pub fn predict(
        radiance: &Rgb<f32>,
        view: &VisibleBounds,
        gains: &TileGains,
        range: &Plane<f32>,
        water: &Water,
    ) -> Self {
        Self::new(
            radiance,
            Extremes::predict(view, gains),
            Some(gains),
            range,
            water,
        )
    }

    fn new(
        radiance: &Rgb<f32>,
        extremes: Extremes,
        gains: Option<&TileGains>,
        range: &Plane<f32>,
        water: &Water,
    ) -> Self {
        let stand_in = match water.holes {
            HoleRule::RangeM(meters) if range.data().iter().any(|&z| is_hole(z)) => Some(meters as f32),
            _ => None,
        };
        // Which of the filled holes are lit is not worth a second look.
        let filled = |seen: Option<(f32, f32)>| {
            let seen = match (seen, stand_in) {
                (Some((nearest, farthest)), Some(z)) => Some((nearest.min(z), farthest.max(z))),
                (seen, stand_in) => seen.or(stand_in.map(|z| (z, z))),
            };
            seen.map(|(nearest, farthest)| (f64::from(nearest), f64::from(farthest)))
        };
        let lit = [0, 1, 2].map(|c| bounds(radiance.planes()[c].data(), range.data(), opaque_m(water, c)));
        let Extremes {
            brightest,
            darkest,
            mean_square,
        } = extremes;
        let mut bins = bins::binned(radiance, gains, range);
        if let Some(z) = stand_in {
            let meters = (f64::from(z), f64::from(z));
            bins.push(RangeBin { meters, brightest });
        }
        Self {
            holes: stand_in.is_none() && range.data().iter().any(|&z| is_hole(z)),
            bins,
            darkest,
            range_m: filled(bounds(range.data(), range.data(), f32::MAX)),
            lit_m: lit.map(filled),
            distinct_m: distinct(range.data(), stand_in),
            brightest,
            mean_square,
            layering: Self::find_layers(range, water),
            widest_px: widest_px(range.width(), range.height()),
            pixels: range.data().len(),
        }
    }

    /// The layers of a range image; `None` without occlusion-aware scatter, or without an edge in depth.
    #[must_use]
    pub fn find_layers(range: &Plane<f32>, water: &Water) -> Option<Layering> {
        match water.scatter {
            Scatter::Jaffe {
                layers: Some(most), ..
            } => Layering::find(&filled_range(range, water.holes), most),
            _ => None,
        }
    }

    /// Bounds a scene without water.
    #[must_use]
    pub fn in_air(radiance: &Rgb<f32>) -> Self {
        let (width, height) = radiance.size();
        let extremes = Extremes::measure(radiance);
        Self {
            range_m: None,
            lit_m: [None; 3],
            distinct_m: None,
            brightest: extremes.brightest,
            darkest: [0.0; 3],
            mean_square: extremes.mean_square,
            holes: false,
            bins: Vec::new(),
            layering: None,
            widest_px: widest_px(width, height),
            pixels: width * height,
        }
    }
}

impl SceneBounds {
    /// The same in light of at most these gains.
    #[must_use]
    pub fn brightened(mut self, gains: Option<&TileGains>) -> Self {
        if let Some(gains) = gains {
            for c in 0..3 {
                let most = gains.most.iter().map(|gain| gain[c]).fold(0.0, f32::max);
                self.brightest[c] *= most;
                self.mean_square[c] *= f64::from(most * most);
            }
        }
        self
    }
}

/// The light of each channel, or its bounds.
struct Extremes {
    brightest: [f32; 3],
    darkest: [f32; 3],
    mean_square: [f64; 3],
}

impl Extremes {
    fn measure(radiance: &Rgb<f32>) -> Self {
        let planes = radiance.planes().each_ref().map(Plane::data);
        Self {
            brightest: planes.map(greatest),
            darkest: planes.map(least),
            mean_square: planes.map(|samples| f64::from(square_sum(samples)) / samples.len().max(1) as f64),
        }
    }

    /// Bounds from those of each tile.
    fn predict(view: &VisibleBounds, gains: &TileGains) -> Self {
        let mut found = Self {
            brightest: [0.0; 3],
            darkest: [f32::INFINITY; 3],
            mean_square: [0.0; 3],
        };
        let count = view.tiles.len().max(1) as f64;
        let factors = gains.most.iter().zip(&gains.root_mean_square);
        for (tile, (most, middle)) in view.tiles.iter().zip(factors) {
            for c in 0..3 {
                found.brightest[c] = found.brightest[c].max(most[c] * tile.brightest[c]);
                found.darkest[c] = found.darkest[c].min(gains.least[c] * tile.darkest[c]);
                found.mean_square[c] += f64::from(middle[c] * tile.brightest[c]).powi(2) / count;
            }
        }
        found
    }
}

fn square_sum(samples: &[f32]) -> f32 {
    vectorized!({
        let mut sums = [0.0f32; 16];
        let (blocks, rest) = samples.as_chunks::<16>();
        for block in blocks {
            for (sum, v) in sums.iter_mut().zip(block) {
                *sum += v * v;
            }
        }
        sums.iter().sum::<f32>() + rest.iter().map(|v| v * v).sum::<f32>()
    })
}

/// Beyond this range spread light vanishes in f32.
fn opaque_m(water: &Water, channel: usize) -> f32 {
    match water.scatter {
        Scatter::Jaffe {
            source: ScatterSource::Direct,
            ..
        } => OPAQUE / water.direct_attenuation[channel] as f32,
        Scatter::Jaffe { g, .. } => OPAQUE / g[channel] as f32,
        Scatter::Simplified { .. } | Scatter::None => f32::MAX,
    }
}

/// The distinct valid ranges; `None` if there are more than [`MOST_DISTINCT`].
fn distinct(range: &[f32], stand_in: Option<f32>) -> Option<Vec<f32>> {
    let mut seen: Vec<f32> = stand_in.into_iter().collect();
    let mut last = f32::NAN;
    for &z in range {
        if z == last || is_hole(z) {
            continue;
        }
        last = z;
        if !seen.contains(&z) {
            if seen.len() == MOST_DISTINCT {
                return None;
            }
            seen.push(z);
        }
    }
    Some(seen)
}

#[cfg(test)]
mod tests {
    use imaging::geometry::Intrinsics;
    use spec::Optics;

    use super::*;
    use crate::medium::Medium;
    use crate::visible_bounds::TILE_PX;

    fn clear(holes: HoleRule) -> Water {
        let request = Medium {
            holes,
            ..Optics {
                beam_attenuation_per_m: Some([0.1; 3]),
                veiling_light: Some([0.2; 3]),
                ..Optics::default()
            }
            .into()
        };
        Water::resolve(&request, 500.0).unwrap()
    }

    #[test]
    fn holes_have_no_range_and_dark_pixels_spread_no_light() {
        let range = Plane::new(5, 1, vec![2.0, f32::NAN, 9.0, 0.0, 3.0]).unwrap();
        let radiance = Rgb::from_fn(5, 1, |x, _| [if x == 2 { 0.0 } else { 0.5 }, 1.0, 0.0]);
        let bounds = SceneBounds::measure(&radiance, &range, &clear(HoleRule::Background));
        assert_eq!(bounds.range_m, Some((2.0, 9.0)));
        assert_eq!(bounds.lit_m, [Some((2.0, 3.0)), Some((2.0, 9.0)), None]);
        assert_eq!(bounds.distinct_m, Some(vec![2.0, 9.0, 3.0]));
        assert_eq!(bounds.brightest, [0.5, 1.0, 0.0]);
        let lit: Vec<_> = bounds
            .bins
            .iter()
            .map(|bin| (bin.meters, bin.brightest))
            .collect();
        assert_eq!(lit[0], ((2.0, 2.25), [0.5, 1.0, 0.0]));
        assert_eq!(lit[2], ((9.0, 10.0), [0.0, 1.0, 0.0]));
        assert!(lit.len() == 3 && bounds.holes);
        let filled = SceneBounds::measure(&radiance, &range, &clear(HoleRule::RangeM(20.0)));
        assert_eq!(
            (filled.range_m, filled.lit_m[0]),
            (Some((2.0, 20.0)), Some((2.0, 20.0)))
        );
    }

    #[test]
    fn light_that_is_still_to_come_is_bounded_tile_by_tile() {
        let range = Plane::from_fn(40, 20, |x, _| if x < 20 { 2.0 } else { 9.0 });
        let radiance = Rgb::from_fn(40, 20, |x, y| [0.1 + 0.01 * x as f32, 0.02 * y as f32, 0.5]);
        let most: Vec<_> = (0..2).map(|tile| [1.0 + tile as f32, 2.0, 0.5]).collect();
        let gains = TileGains {
            side_px: TILE_PX,
            columns: 2,
            root_mean_square: most.clone(),
            most,
            least: [0.5; 3],
        };
        let lit = Rgb::from_fn(40, 20, |x, y| {
            let gain = gains.tile_gain(x, y);
            [0, 1, 2].map(|c| radiance.pixel(x, y)[c] * gain[c])
        });
        let water = clear(HoleRule::Background);
        let camera = Intrinsics::centered(30.0, 40, 20);
        let view = VisibleBounds::measure(&radiance, &range, &camera);
        let predicted = SceneBounds::predict(&radiance, &view, &gains, &range, &water);
        let measured = SceneBounds::measure(&lit, &range, &water);
        assert_eq!(predicted.brightest, measured.brightest);
        assert_eq!(predicted.bins, measured.bins);
        for (predicted, measured) in predicted.mean_square.iter().zip(measured.mean_square) {
            assert!(predicted >= &(measured * (1.0 - 1e-6)), "{predicted} {measured}");
        }
        assert_eq!(predicted.darkest, [0.05, 0.0, 0.25]);
    }

    #[test]
    fn a_frame_of_holes_has_no_range() {
        let range = Plane::filled(3, 3, f32::INFINITY);
        let radiance = Rgb::from_fn(3, 3, |_, _| [1.0; 3]);
        let bounds = SceneBounds::measure(&radiance, &range, &clear(HoleRule::Background));
        assert_eq!((bounds.range_m, bounds.lit_m), (None, [None; 3]));
    }
}
