//! Fixed-pattern noise of the camera: the sensitivity, dark current and offset of every pixel.

use imaging::cancel;

use super::model::{Chance, HOT, SensorModel};
use super::noise::{BLOCK, Elements, Streams, fill_normals};

/// Limit on the samples of a stored pattern: 48 MB.
const MOST_KEPT: usize = 4 << 20;

/// The fixed pattern of a sensor; the same in every frame.
#[derive(Debug, Clone, PartialEq)]
pub struct FixedPattern {
    sensor: SensorModel,
    seed: u64,
    samples: usize,
    /// All samples, if they fit the limit.
    kept: Option<Fixed>,
}

/// Relative sensitivity, dark electrons and offset in electrons of each sample.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Fixed {
    pub(super) sensitivity: Vec<f32>,
    pub(super) dark: Vec<f32>,
    pub(super) offset: Vec<f32>,
}

pub(super) struct FixedBlock<'a> {
    pub(super) sensitivity: &'a [f32],
    pub(super) dark: &'a [f32],
    pub(super) offset: &'a [f32],
}

impl FixedPattern {
    /// The pattern of a picture: `samples` is the number of pixels for a mosaic, three times that for three sensors.
    #[must_use]
    pub fn new(sensor: &SensorModel, seed: u64, samples: usize) -> Self {
        let mut pattern = Self {
            sensor: *sensor,
            seed,
            samples,
            kept: None,
        };
        if samples <= MOST_KEPT {
            let streams = Streams::new(Chance { seed, frame: 0 });
            let mut fixed = Fixed::default();
            let per_sensor = if sensor.cfa == spec::Cfa::None {
                samples / 3
            } else {
                samples
            };
            for plane in 0..samples / per_sensor.max(1) {
                for start in (0..per_sensor).step_by(BLOCK) {
                    let length = BLOCK.min(per_sensor - start);
                    draw(sensor, &streams, elements(plane, start), length, &mut fixed);
                }
            }
            pattern.kept = Some(fixed);
        }
        pattern
    }

    /// Whether it is the pattern of this sensor.
    #[must_use]
    pub fn is_of(&self, sensor: &SensorModel, seed: u64, samples: usize) -> bool {
        // Gain and frame do not matter, but a sensor rarely varies in one number only.
        (&self.sensor, self.seed, self.samples) == (sensor, seed, samples)
    }

    /// A block of the pattern: the samples from `start` on of plane `plane`, at index `at` overall.
    pub(super) fn block<'a>(
        &'a self,
        streams: &Streams,
        (plane, start, at): (usize, usize, usize),
        length: usize,
        drawn: &'a mut Fixed,
    ) -> FixedBlock<'a> {
        let (fixed, from) = match &self.kept {
            Some(fixed) => (fixed, at),
            None => {
                *drawn = Fixed::default();
                draw(&self.sensor, streams, elements(plane, start), length, drawn);
                (&*drawn, 0)
            }
        };
        let range = from..from + length;
        FixedBlock {
            sensitivity: fixed.sensitivity.get(range.clone()).unwrap_or_default(),
            dark: fixed.dark.get(range.clone()).unwrap_or_default(),
            offset: fixed.offset.get(range).unwrap_or_default(),
        }
    }
}

/// The elements of a plane's samples from `start` on: `4 P + plane`.
pub(super) fn elements(plane: usize, start: usize) -> Elements {
    Elements {
        first: 4 * start as u64 + plane as u64,
        step: 4,
    }
}

fn draw(sensor: &SensorModel, streams: &Streams, elements: Elements, length: usize, fixed: &mut Fixed) {
    cancel::check();
    let mut normals = [0.0; BLOCK];
    let normals = &mut normals[..length];
    let dark = sensor.dark_e_per_s * sensor.exposure_s;
    let mut scaled = |stream, spread: f64, target: &mut Vec<f32>, change: &dyn Fn(f64) -> f64| {
        if spread == 0.0 {
            target.resize(target.len() + length, change(0.0) as f32);
            return;
        }
        fill_normals(stream, 0, elements, normals);
        target.extend(normals.iter().map(|&normal| change(spread * normal) as f32));
    };
    scaled(&streams.prnu, sensor.prnu, &mut fixed.sensitivity, &|deviation| {
        deviation
    });
    let dcnu = if dark > 0.0 { sensor.dcnu } else { 0.0 };
    scaled(&streams.dcnu, dcnu, &mut fixed.dark, &|deviation| {
        (dark * (1.0 + deviation)).max(0.0)
    });
    scaled(&streams.dsnu, sensor.dsnu_e, &mut fixed.offset, &|deviation| {
        deviation
    });
    if sensor.hot_share > 0.0 {
        let start = fixed.dark.len() - length;
        let mut units = [0.0; BLOCK];
        streams
            .hot
            .fill_units(0, elements.first, elements.step, &mut units[..length]);
        let all = fixed.dark[start..].iter_mut().zip(&units);
        all.filter(|(_, unit)| **unit < sensor.hot_share)
            .for_each(|(dark, _)| *dark *= HOT as f32);
    }
}
