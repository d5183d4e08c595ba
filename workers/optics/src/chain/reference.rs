//! The chain in f64 with every pixel's own kernel. It shares nothing with the fast form but the definitions.

use imaging::{Plane, Rgb};

use super::{Band, farthest};
use crate::forward_scatter::{gamma_plane, gather_reference, scatter_reference};
use crate::plan::{Plan, ScatterStep};
use crate::range::is_hole;
use crate::water::{Scatter, ScatterSource, Water};

pub(super) fn bands(radiance: &Rgb<f32>, range: &Plane<f32>, water: &Water, plan: &Plan) -> [Band; 3] {
    [0, 1, 2].map(|channel| {
        let radiance = radiance.planes()[channel].map(|&j| f64::from(j));
        let parts = parts(
            &radiance,
            range,
            water,
            channel,
            plan.scatter[channel] == ScatterStep::Reference,
        );
        let [direct, forward, veil, image] = parts.map(|plane| plane.map(|&v| v as f32));
        Band {
            direct,
            forward,
            veil,
            image,
        }
    })
}

/// D, F, B and their image of one channel, in f64.
fn parts(
    radiance: &Plane<f64>,
    range: &Plane<f32>,
    water: &Water,
    channel: usize,
    scatters: bool,
) -> [Plane<f64>; 4] {
    let (c, c_back) = (
        water.direct_attenuation[channel],
        water.backscatter_attenuation[channel],
    );
    let veil_light = water.veiling_light[channel];
    let lit = radiance.map(|j| j * water.radiance_gain[channel]);
    let end = |attenuation: f64| if attenuation > 0.0 { 0.0 } else { 1.0 };
    let direct = with_range(&lit, range, |j, z| j * z.map_or(end(c), |z| (-c * z).exp()));
    let veil = with_range(&lit, range, |_, z| {
        veil_light * z.map_or(1.0 - end(c_back), |z| -(-c_back * z).exp_m1())
    });
    let attenuated = added(&direct, &veil);
    let none = direct.map(|_| 0.0);
    let Some(farthest) = farthest(range).filter(|_| scatters) else {
        return [direct, none, veil, attenuated];
    };
    match &water.scatter {
        Scatter::None => [direct, none, veil, attenuated],
        Scatter::Jaffe { g, source, spread } => {
            let g = g[channel].min(c);
            let light = with_range(&lit, range, |j, z| {
                let share = z.map_or(0.0, |z| (-g * z).exp() * -(-(c - g) * z).exp_m1());
                let arriving = if *source == ScatterSource::Direct {
                    z.map_or(0.0, |z| (-c * z).exp())
                } else {
                    1.0
                };
                j * share * arriving
            });
            let gamma = gamma_plane(range, spread.offset_px[channel], spread.per_m[channel], farthest);
            let forward = scatter_reference(&light, &gamma);
            let image = added(&attenuated, &forward);
            [direct, forward, veil, image]
        }
        Scatter::Simplified { spread } => {
            let gamma = gamma_plane(range, spread.offset_px[channel], spread.per_m[channel], farthest);
            let image = gather_reference(&attenuated, &gamma);
            let change = added(&image, &attenuated.map(|v| -v));
            [direct, change, veil, image]
        }
    }
}

/// Maps light together with the range in metres, which is none at a hole.
fn with_range(light: &Plane<f64>, range: &Plane<f32>, map: impl Fn(f64, Option<f64>) -> f64) -> Plane<f64> {
    let metres = |z: f32| (!is_hole(z)).then_some(f64::from(z));
    let data = light
        .data()
        .iter()
        .zip(range.data())
        .map(|(&j, &z)| map(j, metres(z)))
        .collect();
    Plane::new(light.width(), light.height(), data).expect("the size of the frame")
}

fn added(a: &Plane<f64>, b: &Plane<f64>) -> Plane<f64> {
    let data = a.data().iter().zip(b.data()).map(|(a, b)| a + b).collect();
    Plane::new(a.width(), a.height(), data).expect("the size of the frame")
}
