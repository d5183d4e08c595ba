//! Occlusion-aware forward scatter in f64, layer by layer with the exact kernel of every pixel.

use imaging::Plane;
use imaging::dct::Dct2;

use crate::forward_scatter::{
    FILL_LEAST, OPAQUE_GATE, fill_gamma_px, scatter_behind_gates, scatter_reference, widest_px,
};
use crate::kernel::Transfer;
use crate::layering::Layering;
use crate::range::is_hole;
use crate::water::{Arrival, Water};

/// A layer as if no other occluded it.
struct Shown {
    /// How much of it is at each pixel, 0..=1.
    mask: Plane<f64>,
    /// Light emitted by the layer.
    light: Plane<f64>,
    /// Its range, meters.
    range: Plane<f64>,
}

/// One channel of a frame in layers.
pub(super) struct Gated<'a> {
    pub(super) water: &'a Water,
    pub(super) channel: usize,
    pub(super) layering: &'a Layering,
    pub(super) range: &'a Plane<f64>,
    /// Light of the scene before the water.
    pub(super) lit: &'a Plane<f64>,
}

impl Gated<'_> {
    /// D + F.
    pub(super) fn arriving(&self) -> Plane<f64> {
        let (width, height) = self.range.size();
        let layers = self.range.map(|&z| self.layering.layer_of(z));
        let mut arriving = Plane::filled(width, height, 0.0);
        for layer in (0..self.layering.count()).rev() {
            let shown = self.shown(&layers, layer);
            if layer + 1 < self.layering.count() {
                arriving = self.pass(&arriving, self.layering.gates_m[layer], &shown.mask);
            }
            let own = self.spread(&shown);
            arriving = zip(&arriving, &own, |sum, own| sum + own);
        }
        arriving.map(|v| v.max(0.0))
    }

    fn shown(&self, layers: &Plane<usize>, layer: usize) -> Shown {
        let own = layers.map(|&of| f64::from(u8::from(of == layer)));
        let known = layers.map(|&of| f64::from(u8::from(of >= layer)));
        let filled = fill(&own, &own, &known);
        let mask = zip(
            &filled,
            &known,
            |filled, known| if known == 0.0 { filled } else { 0.0 },
        );
        let range = self.range.map(|&z| if is_hole(z) { 0.0 } else { z });
        let mine = range.data().iter().zip(own.data()).filter(|(_, own)| **own > 0.0);
        let (near, far) = mine.fold((f64::INFINITY, 0.0f64), |(near, far), (&z, _)| {
            (near.min(z), far.max(z))
        });
        Shown {
            mask: zip(&mask, &own, |hidden, own| hidden + own),
            light: fill(self.lit, &own, &own).map(|v| v.max(0.0)),
            // An empty layer has neither range nor mask.
            range: fill(&range, &own, &own).map(|z| z.max(near).min(far.max(near))),
        }
    }

    /// Arriving light of a layer without occlusion.
    fn spread(&self, shown: &Shown) -> Plane<f64> {
        let lit = zip(&shown.mask, &shown.light, |mask, light| mask * light);
        let arrivals = shown
            .range
            .map(|&z| self.arrival(if z.is_finite() { z } else { 0.0 }));
        let part = |of: fn(&Arrival) -> f64| zip(&lit, &arrivals.map(of), |light, share| light * share);
        let narrow = scatter_behind_gates(
            &part(|a| a.spread * (1.0 - a.wide)),
            &arrivals.map(|a| a.gammas[0]),
        );
        let wide = scatter_behind_gates(&part(|a| a.spread * a.wide), &arrivals.map(|a| a.gammas[1]));
        let spread = zip(&narrow, &wide, |narrow, wide| narrow + wide);
        zip(&part(|a| a.direct), &spread, |direct, spread| direct + spread)
    }

    /// Light that passes a gate: it is propagated back to the gate and continues where the mask is open.
    fn pass(&self, arriving: &Plane<f64>, gate_m: f64, mask: &Plane<f64>) -> Plane<f64> {
        let (width, height) = arriving.size();
        if self.water.direct_attenuation[self.channel] * gate_m > OPAQUE_GATE {
            return Plane::filled(width, height, 0.0);
        }
        let at = self.arrival(gate_m);
        let [narrow, wide] = at
            .gammas
            .map(|gamma| Transfer::behind_gates(gamma).grid(width, height));
        let response = |i: usize| at.direct + at.spread * ((1.0 - at.wide) * narrow[i] + at.wide * wide[i]);
        let mut transform = Dct2::new(width, height);
        let mut light = arriving.data().to_vec();
        transform.forward(&mut light);
        light.iter_mut().enumerate().for_each(|(i, v)| *v /= response(i));
        transform.inverse(&mut light);
        for (light, mask) in light.iter_mut().zip(mask.data()) {
            *light = light.max(0.0) * (1.0 - mask);
        }
        transform.forward(&mut light);
        light.iter_mut().enumerate().for_each(|(i, v)| *v *= response(i));
        transform.inverse(&mut light);
        Plane::new(width, height, light).expect("the size of the frame")
    }

    fn arrival(&self, range_m: f64) -> Arrival {
        let (width, height) = self.range.size();
        let arrival = self
            .water
            .arrival(self.channel, range_m, widest_px(width, height));
        arrival.expect("only the Jaffe–McGlamery form is gated")
    }
}

/// Known values, and elsewhere their mean under a wide kernel, 0 without known values nearby.
fn fill(values: &Plane<f64>, own: &Plane<f64>, known: &Plane<f64>) -> Plane<f64> {
    let (width, height) = values.size();
    let gamma = Plane::filled(width, height, fill_gamma_px(width));
    // Known values of other layers are 0 in all calls.
    let sums = scatter_reference(&zip(values, own, |v, own| v * own), &gamma);
    let weights = scatter_reference(known, &gamma);
    let mean = zip(&sums, &weights, |n, d| if d > FILL_LEAST { n / d } else { 0.0 });
    let data = values.data().iter().zip(own.data()).zip(mean.data());
    let data = data.map(|((&value, &own), &mean)| if own > 0.0 { value } else { mean });
    Plane::new(width, height, data.collect()).expect("the size of the frame")
}

fn zip(a: &Plane<f64>, b: &Plane<f64>, join: impl Fn(f64, f64) -> f64) -> Plane<f64> {
    let data = a.data().iter().zip(b.data()).map(|(&a, &b)| join(a, b));
    Plane::new(a.width(), a.height(), data.collect()).expect("the size of the frame")
}
