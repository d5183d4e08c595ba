//! The chain in f64 with the exact kernel of every pixel. It shares only the definitions with the fast variant.

use imaging::{Plane, Rgb};
use spec::ScatterSource;

use super::gated_reference::Gated;
use super::layers::{Band, Layers, layers};
use super::{ChainError, check};
use crate::daylight::veil_reference;
use crate::forward_scatter::{MAX_REFERENCE_PIXELS, gather_reference, scatter_reference, widest_px};
use crate::layering::Layering;
use crate::range::{filled, is_hole};
use crate::water::{Scatter, Spread, Water};

/// Renders a scene under water exactly: [`water`](super::water) in f64, without a plan.
///
/// # Errors
/// [`ChainError`]: sizes differ, the frame is empty or too large, holes under the rule `reject`.
pub fn water(radiance: &Rgb<f64>, range: &Plane<f64>, water: &Water) -> Result<Layers<f64>, ChainError> {
    check::sizes(radiance.size(), range.size())?;
    let pixels = range.data().len();
    if pixels > MAX_REFERENCE_PIXELS && water.scatter != Scatter::None {
        return Err(ChainError::ReferenceTooLarge { pixels });
    }
    let holes = check::holes(range, water.holes)?;
    let range = filled(range, water.holes);
    let layering = match water.scatter {
        Scatter::Jaffe {
            layers: Some(most), ..
        } => Layering::find(&range, most),
        _ => None,
    };
    Ok(layers(
        [0, 1, 2].map(|channel| {
            band(
                &radiance.planes()[channel],
                &range,
                water,
                channel,
                layering.as_ref(),
            )
        }),
        holes,
    ))
}

fn band(
    radiance: &Plane<f64>,
    range: &Plane<f64>,
    water: &Water,
    channel: usize,
    layering: Option<&Layering>,
) -> Band<f64> {
    let c = water.direct_attenuation[channel];
    let c_back = water.backscatter_attenuation[channel];
    let veil_light = water.veiling_light[channel];
    let lit = radiance.map(|j| j * water.radiance_gain[channel]);
    let at_end = |attenuation: f64| if attenuation > 0.0 { 0.0 } else { 1.0 };
    let direct = with_range(&lit, range, |j, z| j * z.map_or(at_end(c), |z| (-c * z).exp()));
    let veil = match (water.varied_veil(channel), water.daylight()) {
        (Some(varied), Some(daylight)) => veil_reference(range, &varied, &daylight.gaze),
        _ => with_range(&lit, range, |_, z| {
            veil_light * z.map_or(1.0 - at_end(c_back), |z| -(-c_back * z).exp_m1())
        }),
    };
    let attenuated = zipped(&direct, &veil, |d, b| d + b);
    match (&water.scatter, farthest(range), layering) {
        (Scatter::Jaffe { .. }, Some(_), Some(layering)) => {
            let gated = Gated {
                water,
                channel,
                layering,
                range,
                lit: &lit,
            };
            let forward = zipped(&gated.arriving(), &direct, |arriving, d| (arriving - d).max(0.0));
            let image = zipped(&attenuated, &forward, |i, f| i + f);
            Band {
                direct,
                forward,
                veil,
                image,
            }
        }
        (
            Scatter::Jaffe {
                g,
                source,
                spread,
                tail,
                ..
            },
            Some(farthest),
            _,
        ) => {
            let g = g[channel].min(c);
            let source = if *source == ScatterSource::Direct {
                &direct
            } else {
                &lit
            };
            let light = with_range(source, range, |l, z| {
                l * z.map_or(0.0, |z| (-g * z).exp() * -(-(c - g) * z).exp_m1())
            });
            let share =
                |z: Option<f64>| tail.map_or(0.0, |tail| tail.share_at(channel, z.unwrap_or(farthest)));
            let narrow = with_range(&light, range, |u, z| u * (1.0 - share(z)));
            let mut forward = scatter_reference(&narrow, &gamma(range, spread, channel, farthest));
            if let Some(tail) = tail {
                let wide = with_range(&light, range, |u, z| u * share(z));
                let wide = scatter_reference(&wide, &gamma(range, &tail.spread, channel, farthest));
                forward = zipped(&forward, &wide, |narrow, wide| narrow + wide);
            }
            let image = zipped(&attenuated, &forward, |i, f| i + f);
            Band {
                direct,
                forward,
                veil,
                image,
            }
        }
        (Scatter::Simplified { spread }, Some(farthest), _) => {
            let image = gather_reference(&attenuated, &gamma(range, spread, channel, farthest));
            let forward = zipped(&image, &attenuated, |i, a| i - a);
            Band {
                direct,
                forward,
                veil,
                image,
            }
        }
        _ => Band {
            forward: attenuated.map(|_| 0.0),
            direct,
            veil,
            image: attenuated,
        },
    }
}

/// The largest valid range in meters, which sets the kernel of holes; `None` without a valid range.
fn farthest(range: &Plane<f64>) -> Option<f64> {
    range
        .data()
        .iter()
        .copied()
        .filter(|&z| !is_hole(z))
        .reduce(f64::max)
}

/// Kernel scale of each pixel; a hole gets the scale of the farthest pixel.
fn gamma(range: &Plane<f64>, spread: &Spread, channel: usize, farthest: f64) -> Plane<f64> {
    let widest = widest_px(range.width(), range.height());
    range.map(|&z| spread.gamma(channel, if is_hole(z) { farthest } else { z }, widest))
}

/// Maps light together with the range in meters, which is `None` at a hole.
fn with_range(light: &Plane<f64>, range: &Plane<f64>, map: impl Fn(f64, Option<f64>) -> f64) -> Plane<f64> {
    zipped(light, range, |light, z| map(light, (!is_hole(z)).then_some(z)))
}

fn zipped(a: &Plane<f64>, b: &Plane<f64>, combine: impl Fn(f64, f64) -> f64) -> Plane<f64> {
    let data = a
        .data()
        .iter()
        .zip(b.data())
        .map(|(&a, &b)| combine(a, b))
        .collect();
    Plane::new(a.width(), a.height(), data).expect("the size of the frame")
}
