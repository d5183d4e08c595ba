//! What a plan needs to know of a scene.

use imaging::{Plane, Rgb};
use spec::{HoleRule, ScatterSource};

use super::bins;
use crate::attenuation::OPAQUE;
use crate::extremes::{brightest, greatest, least};
use crate::forward_scatter::widest_px;
use crate::layering::Layering;
use crate::range::{bounds, filled as filled_range, is_hole};
use crate::water::{Scatter, Water};

/// Distinct ranges are counted up to here: with more, interpolation takes fewer kernels than there are ranges.
const MOST_DISTINCT: usize = 32;

/// Pixels whose range lies between two distances less than an eighth apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RangeBin {
    /// The two distances in meters.
    pub meters: (f64, f64),
    /// Largest radiance of each channel among them.
    pub brightest: [f32; 3],
}

/// Bounds of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneStats {
    /// Nearest and farthest valid range in meters, holes by the water's rule; none if every pixel is a hole.
    pub range_m: Option<(f64, f64)>,
    /// The same of the pixels that spread light in a channel: their radiance is not 0, and it is not all lost on the way.
    pub lit_m: [Option<(f64, f64)>; 3],
    /// The distinct ranges, if there are few.
    pub distinct_m: Option<Vec<f32>>,
    /// Largest radiance of each channel.
    pub brightest: [f32; 3],
    /// Smallest radiance of each channel.
    pub darkest: [f32; 3],
    /// Pixels without a range that the rule does not fill.
    pub holes: bool,
    /// The lit ranges, nearest first, with the largest radiance of each channel there.
    pub bins: Vec<RangeBin>,
    /// What stands before what, where the water asks for gates and something does.
    pub layering: Option<Layering>,
    /// The widest kernel that the frame's size admits, pixels.
    pub widest_px: f64,
    /// Pixels.
    pub pixels: usize,
}

impl SceneStats {
    /// Measures a scene. `radiance` and `range` are of one size.
    #[must_use]
    pub fn measure(radiance: &Rgb<f32>, range: &Plane<f32>, water: &Water) -> Self {
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
        let channels = [0, 1, 2].map(|c| {
            let light = radiance.planes()[c].data();
            ChannelStats::measure(light, range.data(), opaque_m(water, c))
        });
        let brightest = channels.map(|channel| channel.brightest);
        let mut bins = bins::binned(radiance, range);
        if let Some(z) = stand_in {
            let meters = (f64::from(z), f64::from(z));
            bins.push(RangeBin { meters, brightest });
        }
        Self {
            holes: stand_in.is_none() && range.data().iter().any(|&z| is_hole(z)),
            bins,
            darkest: channels.map(|channel| channel.darkest),
            range_m: filled(bounds(range.data(), range.data(), f32::MAX)),
            lit_m: channels.map(|channel| filled(channel.lit_m)),
            distinct_m: distinct(range.data(), stand_in),
            brightest,
            layering: match water.scatter {
                Scatter::Jaffe {
                    layers: Some(most), ..
                } => Layering::find(&filled_range(range, water.holes), most),
                _ => None,
            },
            widest_px: widest_px(range.width(), range.height()),
            pixels: range.data().len(),
        }
    }

    /// Measures a scene without water.
    #[must_use]
    pub fn in_air(radiance: &Rgb<f32>) -> Self {
        let (width, height) = radiance.size();
        Self {
            range_m: None,
            lit_m: [None; 3],
            distinct_m: None,
            brightest: brightest(radiance),
            darkest: [0.0; 3],
            holes: false,
            bins: Vec::new(),
            layering: None,
            widest_px: widest_px(width, height),
            pixels: width * height,
        }
    }
}

/// The range from which on no spread light is left in f32.
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

/// What one look at a channel tells.
#[derive(Clone, Copy)]
struct ChannelStats {
    brightest: f32,
    darkest: f32,
    lit_m: Option<(f32, f32)>,
}

impl ChannelStats {
    fn measure(light: &[f32], range: &[f32], most_m: f32) -> Self {
        Self {
            brightest: greatest(light),
            darkest: least(light),
            lit_m: bounds(light, range, most_m),
        }
    }
}

/// The distinct valid ranges, none if there are more than [`MOST_DISTINCT`].
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
    use spec::Optics;

    use super::*;

    fn clear(holes: HoleRule) -> Water {
        let request = spec::Water {
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
        let stats = SceneStats::measure(&radiance, &range, &clear(HoleRule::Background));
        assert_eq!(stats.range_m, Some((2.0, 9.0)));
        assert_eq!(stats.lit_m, [Some((2.0, 3.0)), Some((2.0, 9.0)), None]);
        assert_eq!(stats.distinct_m, Some(vec![2.0, 9.0, 3.0]));
        assert_eq!(stats.brightest, [0.5, 1.0, 0.0]);
        let lit: Vec<_> = stats.bins.iter().map(|bin| (bin.meters, bin.brightest)).collect();
        assert_eq!(lit[0], ((2.0, 2.25), [0.5, 1.0, 0.0]));
        assert_eq!(lit[2], ((9.0, 10.0), [0.0, 1.0, 0.0]));
        assert!(lit.len() == 3 && stats.holes);
        let filled = SceneStats::measure(&radiance, &range, &clear(HoleRule::RangeM(20.0)));
        assert_eq!(
            (filled.range_m, filled.lit_m[0]),
            (Some((2.0, 20.0)), Some((2.0, 20.0)))
        );
    }

    #[test]
    fn a_frame_of_holes_has_no_range() {
        let range = Plane::filled(3, 3, f32::INFINITY);
        let radiance = Rgb::from_fn(3, 3, |_, _| [1.0; 3]);
        let stats = SceneStats::measure(&radiance, &range, &clear(HoleRule::Background));
        assert_eq!((stats.range_m, stats.lit_m), (None, [None; 3]));
    }
}
