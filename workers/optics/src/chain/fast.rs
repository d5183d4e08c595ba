//! The chain in f32 with the fast forward scatter.

use imaging::{Plane, Rgb};

use super::{Band, farthest};
use crate::attenuation::{exp_negative, one_minus_exp_negative, scattered_share};
use crate::forward_scatter::{self, KernelCache, gamma_plane};
use crate::plan::{Plan, ScatterStep};
use crate::range::is_hole;
use crate::water::{Scatter, ScatterSource, Spread, Water};

pub(super) fn bands(
    radiance: &Rgb<f32>,
    range: &Plane<f32>,
    water: &Water,
    plan: &Plan,
    cache: &mut KernelCache,
) -> [Band; 3] {
    [0, 1, 2].map(|channel| {
        let (direct, veil) = attenuate(&radiance.planes()[channel], range, water, channel);
        let step = &plan.scatter[channel];
        match &water.scatter {
            Scatter::Jaffe { g, source, spread } => {
                let light = spread_light(
                    &radiance.planes()[channel],
                    range,
                    water,
                    (g[channel], *source),
                    channel,
                );
                let forward = jaffe(light, range, spread, step, channel, cache);
                let image = sum(&sum(&direct, &forward), &veil);
                Band {
                    direct,
                    forward,
                    veil,
                    image,
                }
            }
            Scatter::Simplified { spread } => {
                let attenuated = sum(&direct, &veil);
                let image = simplified(&attenuated, range, spread, step, channel, cache);
                Band {
                    forward: difference(&image, &attenuated),
                    direct,
                    veil,
                    image,
                }
            }
            Scatter::None => {
                let image = sum(&direct, &veil);
                Band {
                    forward: Plane::filled(image.width(), image.height(), 0.0),
                    direct,
                    veil,
                    image,
                }
            }
        }
    })
}

/// D and B of one channel.
fn attenuate(
    radiance: &Plane<f32>,
    range: &Plane<f32>,
    water: &Water,
    channel: usize,
) -> (Plane<f32>, Plane<f32>) {
    let gain = water.radiance_gain[channel] as f32;
    let c = water.direct_attenuation[channel] as f32;
    let c_back = water.backscatter_attenuation[channel] as f32;
    let veil = water.veiling_light[channel] as f32;
    // At a hole the path has no end: nothing arrives where the water attenuates, everything where it does not.
    let direct_at_hole = if c > 0.0 { 0.0 } else { 1.0 };
    let veil_at_hole = if c_back > 0.0 { veil } else { 0.0 };
    let (width, height) = range.size();
    let direct = radiance.data().iter().zip(range.data()).map(|(&j, &z)| {
        let arriving = exp_negative(c * z);
        j * gain * if is_hole(z) { direct_at_hole } else { arriving }
    });
    let backscatter = range.data().iter().map(|&z| {
        let share = one_minus_exp_negative(c_back * z);
        if is_hole(z) { veil_at_hole } else { veil * share }
    });
    let plane = |data: Vec<f32>| Plane::new(width, height, data).expect("the size of the frame");
    (plane(direct.collect()), plane(backscatter.collect()))
}

/// U = J w, or D w; nothing at holes.
fn spread_light(
    radiance: &Plane<f32>,
    range: &Plane<f32>,
    water: &Water,
    (g, source): (f64, ScatterSource),
    channel: usize,
) -> Plane<f32> {
    let gain = water.radiance_gain[channel] as f32;
    let c = water.direct_attenuation[channel];
    // G may exceed c by the rounding of a derived sum; then nothing is scattered forward.
    let excess = (c - g).max(0.0) as f32;
    let (c, g) = (c as f32, g.min(c) as f32);
    let light = radiance.data().iter().zip(range.data()).map(|(&j, &z)| {
        let share = scattered_share(g, excess, z);
        let arriving = if source == ScatterSource::Direct {
            exp_negative(c * z)
        } else {
            1.0
        };
        if is_hole(z) {
            0.0
        } else {
            j * gain * share * arriving
        }
    });
    Plane::new(range.width(), range.height(), light.collect()).expect("the size of the frame")
}

fn jaffe(
    light: Plane<f32>,
    range: &Plane<f32>,
    spread: &Spread,
    step: &ScatterStep,
    channel: usize,
    cache: &mut KernelCache,
) -> Plane<f32> {
    match (step, farthest(range)) {
        (ScatterStep::Pointwise, _) => light,
        (ScatterStep::Interpolated(nodes), Some(farthest)) => {
            let gamma = gamma_plane(range, spread.offset_px[channel], spread.per_m[channel], farthest);
            forward_scatter::scatter(&light, &gamma, nodes, cache)
        }
        _ => light.map(|_| 0.0),
    }
}

fn simplified(
    attenuated: &Plane<f32>,
    range: &Plane<f32>,
    spread: &Spread,
    step: &ScatterStep,
    channel: usize,
    cache: &mut KernelCache,
) -> Plane<f32> {
    match (step, farthest(range)) {
        (ScatterStep::Interpolated(nodes), Some(farthest)) => {
            let gamma = gamma_plane(range, spread.offset_px[channel], spread.per_m[channel], farthest);
            forward_scatter::gather(attenuated, &gamma, nodes, cache)
        }
        _ => attenuated.clone(),
    }
}

fn sum(a: &Plane<f32>, b: &Plane<f32>) -> Plane<f32> {
    zipped(a, b, |a, b| a + b)
}

fn difference(a: &Plane<f32>, b: &Plane<f32>) -> Plane<f32> {
    zipped(a, b, |a, b| a - b)
}

fn zipped(a: &Plane<f32>, b: &Plane<f32>, combine: impl Fn(f32, f32) -> f32) -> Plane<f32> {
    let data = a
        .data()
        .iter()
        .zip(b.data())
        .map(|(&a, &b)| combine(a, b))
        .collect();
    Plane::new(a.width(), a.height(), data).expect("the size of the frame")
}
