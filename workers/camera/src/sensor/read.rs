//! The sensor block by block.

use imaging::{Plane, Rgb, cancel, vectorized};

use super::arrival::ArrivalSampler;
use super::model::{Chance, Raw, SensorModel, color_of};
use super::noise::{BLOCK, Streams, fill_normals, normal};
use super::pattern::{Fixed, FixedBlock, FixedPattern, elements};
use crate::elementary::whole;

/// The codes of exposed light, white = 1; `pattern` must belong to this sensor.
#[must_use]
pub fn read(light: &Rgb<f32>, sensor: &SensorModel, chance: Chance, pattern: &FixedPattern) -> Raw {
    let (width, height) = light.size();
    let mut reader = SensorReader {
        sensor,
        pattern,
        chance,
        streams: Streams::new(chance),
        drawn: Fixed::default(),
        arrival: ArrivalSampler::default(),
    };
    let rows: Vec<f64> = (0..height as u64)
        .map(|row| sensor.row_noise_e * normal(&reader.streams.row, chance.frame, row))
        .collect();
    let mut plane = |plane: usize, sample: &dyn Fn(usize, usize, &mut [f32])| {
        let mut codes = vec![0u16; width * height];
        let mut row = vec![0.0f32; width];
        for (y, codes) in codes.chunks_mut(width.max(1)).enumerate() {
            cancel::check();
            sample(y, plane, &mut row);
            for (block, codes) in codes.chunks_mut(BLOCK).enumerate() {
                let start = y * width + block * BLOCK;
                let light = &row[block * BLOCK..][..codes.len()];
                let position = plane * width * height + start;
                reader.block(light, (plane, start, position), rows[y], codes);
            }
        }
        Plane::new(width, height, codes).expect("a code for each pixel")
    };
    let planes = light.planes().each_ref();
    match sensor.cfa {
        spec::Cfa::None => Raw::Planes([0, 1, 2].map(|channel| {
            plane(channel, &|y, channel, row| {
                row.copy_from_slice(planes[channel].row(y))
            })
        })),
        cfa => Raw::Mosaic(plane(0, &|y, _, row| {
            let color = |x| color_of(cfa, x, y).unwrap_or_default();
            let [even, odd] = [0, 1].map(|x| planes[color(x)].row(y));
            let pairs = even.chunks(2).zip(odd.chunks(2));
            for (row, (even, odd)) in row.chunks_mut(2).zip(pairs) {
                row[0] = even[0];
                if let [_, row] = row {
                    *row = odd[1];
                }
            }
        })),
    }
}

struct SensorReader<'a> {
    sensor: &'a SensorModel,
    pattern: &'a FixedPattern,
    chance: Chance,
    streams: Streams,
    /// Buffer for patterns too large to store.
    drawn: Fixed,
    arrival: ArrivalSampler,
}

impl SensorReader<'_> {
    /// Reads neighboring samples of a row.
    fn block(&mut self, light: &[f32], place: (usize, usize, usize), row_noise: f64, codes: &mut [u16]) {
        let (sensor, frame, length) = (self.sensor, self.chance.frame, light.len());
        let elements = elements(place.0, place.1);
        let mut buffers = [[0.0; BLOCK]; 2];
        let [electrons, normals] = buffers.each_mut().map(|buffer| &mut buffer[..length]);
        let fixed = self.pattern.block(&self.streams, place, length, &mut self.drawn);
        vectorized!(collect(&mut *electrons, light, sensor.white_e(), &fixed));
        if sensor.shot {
            self.arrival.arrive(&self.streams, frame, elements, electrons);
        }
        if sensor.read_noise_e > 0.0 {
            fill_normals(&self.streams.read, frame, elements, normals);
        } else {
            normals.fill(0.0);
        }
        vectorized!(convert(
            sensor,
            electrons,
            normals,
            fixed.offset,
            row_noise,
            &mut *codes
        ));
    }
}

/// Mean electrons of light.
#[inline(always)]
fn collect(electrons: &mut [f64], light: &[f32], white_e: f64, fixed: &FixedBlock<'_>) {
    let pattern = fixed.sensitivity.iter().zip(fixed.dark);
    for ((electrons, &light), (&sensitivity, &dark)) in electrons.iter_mut().zip(light).zip(pattern) {
        let light = imaging::simd::larger(f64::from(light), 0.0);
        let signal = light * white_e * (1.0 + f64::from(sensitivity));
        *electrons = imaging::simd::larger(signal, 0.0) + f64::from(dark);
    }
}

/// Converts electrons to codes with their noise.
#[inline(always)]
fn convert(
    sensor: &SensorModel,
    electrons: &[f64],
    read: &[f64],
    offset: &[f32],
    row_noise: f64,
    codes: &mut [u16],
) {
    let (full, per_e, most) = (sensor.full_well_e, sensor.dn_per_e(), sensor.most_dn());
    let base = f64::from(sensor.black_dn) + 0.5;
    let noise = read.iter().zip(offset);
    for ((code, &electrons), (&read, &offset)) in codes.iter_mut().zip(electrons).zip(noise) {
        let value = imaging::simd::smaller(electrons, full)
            + f64::from(offset)
            + sensor.read_noise_e * read
            + row_noise;
        let value = (value * per_e + base).floor();
        let value = imaging::simd::smaller(imaging::simd::larger(value, 0.0), most);
        *code = whole(value) as u16;
    }
}
