//! The sensor pixel by pixel, by definition.

use imaging::{Plane, Rgb};

use super::model::{Chance, HOT, MOST_COUNTED, POISSON_SWITCH, Raw, SensorModel, color_of};
use super::noise::{Streams, normal};

/// The codes of exposed light, white = 1.
#[must_use]
pub fn read_reference(light: &Rgb<f64>, sensor: &SensorModel, chance: Chance) -> Raw {
    let streams = Streams::new(chance);
    let (width, height) = light.size();
    let code = |x: usize, y: usize, channel: usize, element: u64| {
        let light = light.planes()[channel].pixel(x, y);
        let electrons = collected(light, sensor, &streams, chance.frame, element);
        let value = electrons
            + sensor.dsnu_e * normal(&streams.dsnu, 0, element)
            + sensor.read_noise_e * normal(&streams.read, chance.frame, element)
            + sensor.row_noise_e * normal(&streams.row, chance.frame, y as u64);
        let code = (value * sensor.dn_per_e() + f64::from(sensor.black_dn) + 0.5).floor();
        code.clamp(0.0, sensor.most_dn()) as u16
    };
    let element = |x: usize, y: usize| 4 * (y * width + x) as u64;
    match color_of(sensor.cfa, 0, 0) {
        Some(_) => Raw::Mosaic(Plane::from_fn(width, height, |x, y| {
            let channel = color_of(sensor.cfa, x, y).unwrap_or_default();
            code(x, y, channel, element(x, y))
        })),
        None => Raw::Planes([0, 1, 2].map(|channel| {
            Plane::from_fn(width, height, |x, y| {
                code(x, y, channel, element(x, y) + channel as u64)
            })
        })),
    }
}

/// The electrons collected by a pixel.
fn collected(light: f64, sensor: &SensorModel, streams: &Streams, frame: u64, element: u64) -> f64 {
    let sensitivity = 1.0 + sensor.prnu * normal(&streams.prnu, 0, element);
    let is_hot = sensor.hot_share > 0.0 && streams.hot.unit(0, element) < sensor.hot_share;
    let hot = if is_hot { HOT } else { 1.0 };
    let dark = sensor.dark_e_per_s * hot * sensor.exposure_s;
    let dark = (dark * (1.0 + sensor.dcnu * normal(&streams.dcnu, 0, element))).max(0.0);
    let mean = (light.max(0.0) * sensor.white_e() * sensitivity).max(0.0) + dark;
    let electrons = if sensor.shot {
        poisson(mean, streams, frame, element)
    } else {
        mean
    };
    electrons.min(sensor.full_well_e)
}

fn poisson(mean: f64, streams: &Streams, frame: u64, element: u64) -> f64 {
    if mean < POISSON_SWITCH {
        return counted(mean, streams.shot.unit(frame, 2 * element));
    }
    let n = normal(&streams.shot_normal, frame, element);
    (mean + mean.sqrt() * n + (n * n - 1.0) / 6.0 + 0.5)
        .floor()
        .max(0.0)
}

/// The smallest k whose cumulative probability exceeds a uniform number u.
pub(super) fn counted(mean: f64, u: f64) -> f64 {
    let (mut probability, mut sum, mut k) = (libm::exp(-mean), 0.0, 0);
    loop {
        sum += probability;
        if u < sum || k == MOST_COUNTED {
            return k as f64;
        }
        k += 1;
        probability *= mean / k as f64;
    }
}
