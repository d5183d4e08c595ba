//! JPEG losses: encoding and decoding without the file.
//!
//! Losses come only from the quantization of the cosine transform of 8×8 blocks, the rounding of codes and, at half
//! resolution, the means of the color. Tables of ITU T.81, annex K, scaled by quality as in the Independent JPEG
//! Group's encoder; color by JFIF. At half resolution the color of 2×2 pixels is their mean, upsampled from the nearest
//! four, 9 : 3 : 3 : 1. Plain f32 in a fixed order: the same codes on every CPU.

use imaging::{Rgb8, cancel, vectorized};
use spec::{Chroma, Jpeg};

const SIDE: usize = 8;
type DctBlock = [[f32; SIDE]; SIDE];

/// Quantization of brightness (T.81, table K.1).
const BRIGHTNESS: [[u16; SIDE]; SIDE] = [
    [16, 11, 10, 16, 24, 40, 51, 61],
    [12, 12, 14, 19, 26, 58, 60, 55],
    [14, 13, 16, 24, 40, 57, 69, 56],
    [14, 17, 22, 29, 51, 87, 80, 62],
    [18, 22, 37, 56, 68, 109, 103, 77],
    [24, 35, 55, 64, 81, 104, 113, 92],
    [49, 64, 78, 87, 103, 121, 120, 101],
    [72, 92, 95, 98, 112, 100, 103, 99],
];
/// Quantization of color (T.81, table K.2).
const COLOR: [[u16; SIDE]; SIDE] = [
    [17, 18, 24, 47, 99, 99, 99, 99],
    [18, 21, 26, 66, 99, 99, 99, 99],
    [24, 26, 56, 99, 99, 99, 99, 99],
    [47, 66, 99, 99, 99, 99, 99, 99],
    [99, 99, 99, 99, 99, 99, 99, 99],
    [99, 99, 99, 99, 99, 99, 99, 99],
    [99, 99, 99, 99, 99, 99, 99, 99],
    [99, 99, 99, 99, 99, 99, 99, 99],
];

/// A channel of whole blocks; the picture's edge is repeated.
struct JpegChannel {
    width: usize,
    height: usize,
    samples: Vec<f32>,
}

/// The picture after encoding and decoding.
#[must_use]
pub fn compressed(picture: &Rgb8, law: Jpeg) -> Rgb8 {
    let (width, height) = (picture.width(), picture.height());
    if picture.data().is_empty() {
        return picture.clone();
    }
    let [brightness, blue, red] = [0, 1, 2]
        .map(|channel| JpegChannel::from_fn(width, height, |x, y| component(pixel(picture, x, y), channel)));
    let brightness = brightness.quantized(&scaled(&BRIGHTNESS, law.quality));
    let table = scaled(&COLOR, law.quality);
    let [blue, red] = [blue, red].map(|color| match law.chroma {
        Chroma::Full => color.quantized(&table),
        Chroma::Half => color
            .halved(width, height)
            .quantized(&table)
            .doubled(width, height),
    });
    Rgb8::from_fn(width, height, |x, y| {
        decoded(
            brightness.sample(x, y),
            blue.sample(x, y) - 128.0,
            red.sample(x, y) - 128.0,
        )
    })
}

fn pixel(picture: &Rgb8, x: usize, y: usize) -> [f32; 3] {
    let position = 3 * (y * picture.width() + x);
    [0, 1, 2].map(|channel| f32::from(picture.data()[position + channel]))
}

/// Y, Cb or Cr of a pixel, rounded as in a file.
fn component([r, g, b]: [f32; 3], channel: usize) -> f32 {
    let value = match channel {
        0 => 0.299 * r + 0.587 * g + 0.114 * b,
        1 => 128.0 - 0.168_735_9 * r - 0.331_264_1 * g + 0.5 * b,
        _ => 128.0 + 0.5 * r - 0.418_687_6 * g - 0.081_312_41 * b,
    };
    code(value)
}

fn decoded(y: f32, blue: f32, red: f32) -> [u8; 3] {
    let channels = [
        y + 1.402 * red,
        y - 0.344_136_3 * blue - 0.714_136_3 * red,
        y + 1.772 * blue,
    ];
    channels.map(|value| code(value) as u8)
}

/// The nearest integer in 0..=255.
#[inline(always)]
fn code(value: f32) -> f32 {
    let value = (value + 0.5).floor();
    imaging::simd::smaller(imaging::simd::larger(value, 0.0), 255.0)
}

/// The quantization table at a quality: `(t s + 50)/100` with s = 5000/q below 50, else 200 - 2q, clamped to 1..=255.
fn scaled(table: &[[u16; SIDE]; SIDE], quality: u8) -> DctBlock {
    let quality = u32::from(quality.clamp(1, 100));
    let scale = if quality < 50 {
        5000 / quality
    } else {
        200 - 2 * quality
    };
    table.map(|row| row.map(|step| ((u32::from(step) * scale + 50) / 100).clamp(1, 255) as f32))
}

/// The orthonormal cosine transform: `c(u)/2 cos((2x+1) u π/16)`, rows u.
fn transform() -> DctBlock {
    std::array::from_fn(|u| {
        std::array::from_fn(|x| {
            let angle = ((2 * x + 1) * u) as f64 * std::f64::consts::PI / 16.0;
            let scale = if u == 0 {
                std::f64::consts::FRAC_1_SQRT_2
            } else {
                1.0
            };
            (0.5 * scale * libm::cos(angle)) as f32
        })
    })
}

#[inline(always)]
fn product(a: &DctBlock, b: &DctBlock) -> DctBlock {
    let mut product = [[0.0; SIDE]; SIDE];
    for (row, weights) in product.iter_mut().zip(a) {
        for (weight, source) in weights.iter().zip(b) {
            for (sum, value) in row.iter_mut().zip(source) {
                *sum += weight * value;
            }
        }
    }
    product
}

fn transposed(block: &DctBlock) -> DctBlock {
    std::array::from_fn(|i| std::array::from_fn(|j| block[j][i]))
}

impl JpegChannel {
    fn from_fn(width: usize, height: usize, sample: impl Fn(usize, usize) -> f32) -> Self {
        let [padded_width, padded_height] = [width, height].map(|side| side.next_multiple_of(SIDE));
        let mut samples = Vec::with_capacity(padded_width * padded_height);
        for y in 0..padded_height {
            cancel::check();
            samples.extend((0..padded_width).map(|x| sample(x.min(width - 1), y.min(height - 1))));
        }
        Self {
            width: padded_width,
            height: padded_height,
            samples,
        }
    }

    fn sample(&self, x: usize, y: usize) -> f32 {
        self.samples[y * self.width + x]
    }

    /// Transforms its blocks, rounds to multiples of the table, and transforms back to codes.
    fn quantized(mut self, table: &DctBlock) -> Self {
        let (forward, width) = (transform(), self.width);
        let back = transposed(&forward);
        for y in (0..self.height).step_by(SIDE) {
            let rows = &mut self.samples[y * width..(y + SIDE) * width];
            vectorized!(quantize_row(&mut *rows, width, table, &forward, &back));
        }
        self
    }

    /// Means of 2×2 samples of a picture of this size.
    fn halved(&self, width: usize, height: usize) -> Self {
        Self::from_fn(width.div_ceil(2), height.div_ceil(2), |x, y| {
            let [left, right] = [2 * x, 2 * x + 1].map(|x| x.min(width - 1));
            let [top, bottom] = [2 * y, 2 * y + 1].map(|y| y.min(height - 1));
            let upper = self.sample(left, top) + self.sample(right, top);
            code((upper + self.sample(left, bottom) + self.sample(right, bottom)) * 0.25)
        })
    }

    /// Upsamples to this size from the nearest four samples.
    fn doubled(&self, width: usize, height: usize) -> Self {
        let (columns, rows) = (width.div_ceil(2), height.div_ceil(2));
        Self::from_fn(width, height, |x, y| {
            let ((near_x, far_x), (near_y, far_y)) = (nearest_pair(x, columns), nearest_pair(y, rows));
            let [near, far] = [near_y, far_y].map(|y| 3.0 * self.sample(near_x, y) + self.sample(far_x, y));
            code((3.0 * near + far) * 0.0625)
        })
    }
}

#[inline(always)]
fn quantize_row(rows: &mut [f32], width: usize, table: &DctBlock, forward: &DctBlock, back: &DctBlock) {
    for x in (0..width).step_by(SIDE) {
        let mut block = [[0.0; SIDE]; SIDE];
        for (y, row) in block.iter_mut().enumerate() {
            for (value, sample) in row.iter_mut().zip(&rows[y * width + x..][..SIDE]) {
                *value = sample - 128.0;
            }
        }
        let mut frequencies = product(&product(forward, &block), back);
        for (row, steps) in frequencies.iter_mut().zip(table) {
            for (value, step) in row.iter_mut().zip(steps) {
                *value = (*value / step + 0.5).floor() * step;
            }
        }
        let block = product(&product(back, &frequencies), forward);
        for (y, row) in block.iter().enumerate() {
            for (sample, value) in rows[y * width + x..][..SIDE].iter_mut().zip(row) {
                *sample = code(value + 128.0);
            }
        }
    }
}

/// The nearest and the next sample of a pixel along an axis of `side` samples.
fn nearest_pair(i: usize, side: usize) -> (usize, usize) {
    let near = i / 2;
    let far = if i.is_multiple_of(2) {
        near.saturating_sub(1)
    } else {
        (near + 1).min(side - 1)
    };
    (near, far)
}
