//! The prototype behind gates.

use imaging::Plane;
use imaging::dct::Dct2;
use optics::forward_scatter::scatter_reference;
use optics::layering::Layering;

use super::{Prototype, is_seen, transfer, zip};

/// Least sum of the fill kernel over known pixels; below it the fill is 0.
const FILL_LEAST: f64 = 1e-6;

/// A layer with its occluded parts filled in. The light is multiplied by the mask.
struct Shown {
    mask: Plane<f64>,
    light: Plane<f64>,
    range: Plane<f64>,
}

impl Prototype<'_> {
    /// F behind gates.
    pub(super) fn gated(&self, radiance: &Plane<f64>, layering: &Layering) -> Plane<f64> {
        let (width, height) = radiance.size();
        let mut transform = Dct2::new(width, height);
        let mut spectrum = vec![0.0; width * height];
        for l in (0..layering.count()).rev() {
            let shown = self.shown(radiance, layering, l);
            if l + 1 < layering.count() {
                self.pass(&mut spectrum, layering.gates_m[l], &shown.mask, &mut transform);
            }
            let mut direct = zip(&shown.light, &shown.range, |light, z| {
                light * self.water.direct(z)
            })
            .data()
            .to_vec();
            transform.forward(&mut direct);
            // Each layer has nodes that span its ranges.
            let spread = Prototype::new(self.water, &shown.range).spread(&shown.light, &shown.range);
            for (sum, (direct, spread)) in spectrum.iter_mut().zip(direct.iter().zip(&spread)) {
                *sum += direct + spread;
            }
        }
        transform.inverse(&mut spectrum);
        let arriving = Plane::new(width, height, spectrum).expect("the size of the frame");
        let direct = zip(radiance, self.range, |light, z| {
            if is_seen(z) {
                light * self.water.direct(z)
            } else {
                0.0
            }
        });
        zip(&arriving, &direct, |arriving, direct| {
            (arriving.max(0.0) - direct).max(0.0)
        })
    }

    fn shown(&self, radiance: &Plane<f64>, layering: &Layering, l: usize) -> Shown {
        let layers = self.range.map(|&z| layering.layer_of(z));
        let own = layers.map(|&of| f64::from(u8::from(of == l)));
        let known = layers.map(|&of| f64::from(u8::from(of >= l)));
        let front = layers.map(|&of| f64::from(u8::from(of <= l)));
        let seen = self.range.map(|&z| if is_seen(z) { z } else { 0.0 });
        let mine = seen.data().iter().zip(own.data()).filter(|(_, own)| **own > 0.0);
        let (near, far) = mine.fold((f64::INFINITY, 0.0f64), |(near, far), (&z, _)| {
            (near.min(z), far.max(z))
        });
        let mask = zip(&fill(&own, &known), &front, |filled, front| filled * front);
        Shown {
            light: zip(&fill(radiance, &own), &mask, |light, mask| light.max(0.0) * mask),
            range: fill(&seen, &own).map(|z| z.clamp(near, far)),
            mask,
        }
    }

    fn pass(&self, spectrum: &mut [f64], gate_m: f64, mask: &Plane<f64>, transform: &mut Dct2) {
        let response = self.response(gate_m);
        spectrum.iter_mut().zip(&response).for_each(|(v, a)| *v /= a);
        transform.inverse(spectrum);
        for (light, mask) in spectrum.iter_mut().zip(mask.data()) {
            *light = light.max(0.0) * (1.0 - mask);
        }
        transform.forward(spectrum);
        spectrum.iter_mut().zip(&response).for_each(|(v, a)| *v *= a);
    }

    /// Response of the path from a gate to the camera.
    fn response(&self, gate_m: f64) -> Vec<f64> {
        let scales = self.water.scales(gate_m);
        let [narrow, wide] = scales.map(|gamma| transfer(gamma, self.range.size()));
        let (m, spread) = (self.water.wide_share(gate_m), self.water.spread(gate_m));
        let direct = self.water.direct(gate_m);
        let pairs = narrow.iter().zip(&wide);
        pairs
            .map(|(narrow, wide)| direct + spread * ((1.0 - m) * narrow + m * wide))
            .collect()
    }
}

/// Values where they are known, elsewhere their mean under a wide kernel.
fn fill(values: &Plane<f64>, known: &Plane<f64>) -> Plane<f64> {
    let (width, height) = values.size();
    let gamma = Plane::filled(width, height, (width as f64 / 40.0).max(1.0));
    let sums = scatter_reference(&zip(values, known, |v, known| v * known), &gamma);
    let weights = scatter_reference(known, &gamma);
    let mean = zip(&sums, &weights, |n, d| if d > FILL_LEAST { n / d } else { 0.0 });
    let data = values.data().iter().zip(known.data()).zip(mean.data());
    let data = data.map(|((&value, &known), &mean)| if known > 0.0 { value } else { mean });
    Plane::new(width, height, data.collect()).expect("the size of the frame")
}
