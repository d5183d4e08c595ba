//! The sensor block by block.

use imaging::{Plane, Rgb, cancel, vectorized};

use super::noise::{BLOCK, Elements, Streams, fill_normals, normal};
use super::pattern::{Fixed, FixedBlock, Pattern, elements};
use super::{Chance, MOST_COUNTED, POISSON_SWITCH, Raw, Sensor, color_of};
use crate::elementary::exponential_of_minus;

/// Pixels that are counted together.
const LANES: usize = 8;

/// The codes of exposed light, white = 1; `pattern` is that of this sensor.
#[must_use]
pub fn read(light: &Rgb<f32>, sensor: &Sensor, chance: Chance, pattern: &Pattern) -> Raw {
    let (width, height) = light.size();
    let mut reader = Reader {
        sensor,
        pattern,
        chance,
        streams: Streams::new(chance),
        drawn: Fixed::default(),
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
                let at = plane * width * height + start;
                reader.block(light, (plane, start, at), rows[y], codes);
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
            for (x, light) in row.iter_mut().enumerate() {
                *light = if x % 2 == 0 { even[x] } else { odd[x] };
            }
        })),
    }
}

struct Reader<'a> {
    sensor: &'a Sensor,
    pattern: &'a Pattern,
    chance: Chance,
    streams: Streams,
    /// Of a pattern that is too large to be kept.
    drawn: Fixed,
}

impl Reader<'_> {
    /// Reads neighboring samples of a row.
    fn block(&mut self, light: &[f32], place: (usize, usize, usize), row_noise: f64, codes: &mut [u16]) {
        let (sensor, frame, length) = (self.sensor, self.chance.frame, light.len());
        let elements = elements(place.0, place.1);
        let mut buffers = [[0.0; BLOCK]; 3];
        let [electrons, normals, units] = buffers.each_mut().map(|buffer| &mut buffer[..length]);
        let fixed = self.pattern.block(&self.streams, place, length, &mut self.drawn);
        vectorized!(collect(&mut *electrons, light, sensor.white_e(), &fixed));
        if sensor.shot {
            let buffers = [&mut *electrons, &mut *normals, &mut *units];
            arrive(&self.streams, frame, elements, buffers);
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

/// Makes whole electrons of means, in place; the other two are room for random numbers.
fn arrive(streams: &Streams, frame: u64, elements: Elements, [electrons, normals, units]: [&mut [f64]; 3]) {
    let [least, most] = extremes(electrons);
    let mut buffer = [0.0; BLOCK];
    let means = &mut buffer[..electrons.len()];
    means.copy_from_slice(electrons);
    if most >= POISSON_SWITCH {
        fill_normals(&streams.shot_normal, frame, elements, normals);
        vectorized!(scatter(&mut *electrons, normals));
    }
    if least < POISSON_SWITCH {
        (streams.shot).fill_units(frame, 2 * elements.first, 2 * elements.step, units);
        vectorized!(count(&mut *electrons, means, units));
    }
}

/// Least and greatest value.
fn extremes(values: &[f64]) -> [f64; 2] {
    let (mut least, mut most) = ([f64::INFINITY; LANES], [0.0; LANES]);
    for values in values.chunks(LANES) {
        for ((least, most), &value) in least.iter_mut().zip(&mut most).zip(values) {
            *least = imaging::simd::smaller(*least, value);
            *most = imaging::simd::larger(*most, value);
        }
    }
    [
        least.into_iter().fold(f64::INFINITY, f64::min),
        most.into_iter().fold(0.0, f64::max),
    ]
}

/// Whole electrons from many: a normal number with the skewness of Poisson's.
#[inline(always)]
fn scatter(electrons: &mut [f64], normals: &[f64]) {
    for (electrons, &n) in electrons.iter_mut().zip(normals) {
        let whole = (*electrons + electrons.sqrt() * n + (n * n - 1.0) * (1.0 / 6.0) + 0.5).floor();
        *electrons = imaging::simd::larger(whole, 0.0);
    }
}

/// Whole electrons where few are expected, by the sum of Poisson's probabilities; the others stay as they are.
#[inline(always)]
fn count(electrons: &mut [f64], means: &[f64], units: &[f64]) {
    let blocks = means.chunks(LANES).zip(units.chunks(LANES));
    for (electrons, (means, units)) in electrons.chunks_mut(LANES).zip(blocks) {
        // A lane without few electrons stops at once.
        let (mut mean, mut unit) = ([0.0; LANES], [-1.0; LANES]);
        for (lane, (&of, &with)) in means.iter().zip(units).enumerate() {
            if of < POISSON_SWITCH {
                (mean[lane], unit[lane]) = (of, with);
            }
        }
        let found = count_lanes(&mean, &unit);
        for ((electrons, &mean), found) in electrons.iter_mut().zip(means).zip(found) {
            if mean < POISSON_SWITCH {
                *electrons = found;
            }
        }
    }
}

#[inline(always)]
fn count_lanes(mean: &[f64; LANES], unit: &[f64; LANES]) -> [f64; LANES] {
    let mut probability = mean.map(exponential_of_minus);
    let (mut sum, mut found) = ([0.0; LANES], [0.0; LANES]);
    for k in 1..=MOST_COUNTED {
        let per_k = 1.0 / k as f64;
        let mut open = 0.0;
        for lane in 0..LANES {
            sum[lane] += probability[lane];
            let more = if unit[lane] >= sum[lane] { 1.0 } else { 0.0 };
            found[lane] += more;
            open += more;
            probability[lane] *= mean[lane] * per_k;
        }
        if open == 0.0 {
            break;
        }
    }
    found
}

/// Electrons with their noise as codes.
#[inline(always)]
fn convert(
    sensor: &Sensor,
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
        *code = value as i32 as u16;
    }
}
