//! MLLE with colors in single precision and running sums in f64.

mod contrast;

use imaging::{Plane, Rgb, Rgb8, lab, transfer, vectorized};
use spec::Mlle;

use super::color::{ChannelTransfer, Transfer};
use super::definition::{NEUTRAL, WHITE, balance};
use crate::blocks::binomial;
use crate::blocks::lab::{lab_of_encoded, linear_of_lab};
use contrast::contrasted;

/// Pixels per block.
const BLOCK: usize = 32;
/// Partial sums of a mean.
const LANES: usize = 8;
/// Rows per strip.
const STRIP: usize = 16;

pub(super) fn enhance(picture: &Rgb8, transfer: &Transfer, parameters: &Mlle) -> Rgb8 {
    let (width, height) = (picture.width(), picture.height());
    let corrected = corrected(picture, transfer, parameters.attenuation_gamma);
    let mut lightness = Plane::filled(width, height, 0.0f64);
    let mut opponents = [0; 2].map(|_| Plane::filled(width, height, 0.0f32));
    let mut sums = [0.0; 2];
    vectorized!({
        let colors = corrected.each_ref().map(Plane::data);
        let opponents = opponents.each_mut().map(Plane::data_mut);
        sums = to_lab(colors, lightness.data_mut(), opponents);
    });
    drop(corrected);
    let pixels = (width * height) as f64;
    let factors = balance(sums.map(|sum| sum / pixels + NEUTRAL));
    let lightness = contrasted(lightness, parameters);
    encoded(&lightness, &opponents, factors)
}

/// Steps 1 and 2.
fn corrected(picture: &Rgb8, transfer: &Transfer, gamma: f64) -> [Plane<f32>; 3] {
    let codes = picture.to_planes();
    let attenuation: [f32; 256] =
        std::array::from_fn(|code| (1.0 - (code as f64 / 255.0).powf(gamma)) as f32);
    let (width, height) = (picture.width(), picture.height());
    let mut attenuations = Plane::filled(width, height, 0.0f32);
    for (to, pixel) in attenuations.data_mut().iter_mut().zip(picture.pixels()) {
        let least = pixel[0].min(pixel[1]).min(pixel[2]);
        *to = attenuation[usize::from(least)];
    }
    let mut corrected = codes.each_ref().map(|codes| {
        let mut own = Plane::filled(width, height, 0.0f32);
        vectorized!(to_unit(codes.data(), own.data_mut()));
        binomial(&own)
    });
    let largest = codes[transfer.largest()].data();
    for ((plane, codes), channel) in corrected.iter_mut().zip(&codes).zip(transfer.channels()) {
        let fusion = ChannelFusion::new(channel);
        let sources = [codes.data(), largest];
        vectorized!(fusion.apply(sources, attenuations.data(), plane.data_mut()));
    }
    corrected
}

#[inline(always)]
fn to_unit(codes: &[u8], values: &mut [f32]) {
    for (value, &code) in values.iter_mut().zip(codes) {
        *value = f32::from(code) * (1.0 / 255.0);
    }
}

/// `c' = gain c + share l + offset`.
struct ChannelFusion {
    gain: f32,
    share: f32,
    offset: f32,
}

impl ChannelFusion {
    fn new(channel: ChannelTransfer) -> Self {
        let [gain, share, offset] = match channel {
            ChannelTransfer::Stretched(line) => [line.scale, 0.0, -line.scale * line.low],
            ChannelTransfer::Filled(share, line) => [1.0, share * line.scale, -share * line.scale * line.low],
        };
        Self {
            gain: gain as f32,
            share: share as f32,
            offset: offset as f32,
        }
    }

    /// Step 2 in place of a blurred channel, from the codes of the channel and of the largest.
    #[inline(always)]
    fn apply(&self, [codes, largest]: [&[u8]; 2], attenuation: &[f32], values: &mut [f32]) {
        let (gain, share, offset) = (self.gain, self.share, self.offset);
        let sources = codes.iter().zip(largest).zip(attenuation);
        for (value, ((&code, &largest), attenuation)) in values.iter_mut().zip(sources) {
            let c = f32::from(code) * (1.0 / 255.0);
            let transferred = gain * c + share * (f32::from(largest) * (1.0 / 255.0)) + offset;
            let sum = (c - *value) + attenuation * transferred + (1.0 - attenuation) * c;
            let sum = if sum > 0.0 { sum } else { 0.0 };
            *value = if sum < 1.0 { sum } else { 1.0 };
        }
    }
}

/// Lightness in 0..=1, a and b; returns the sums of a and b.
#[inline(always)]
fn to_lab([r, g, b]: [&[f32]; 3], lightness: &mut [f64], [to_a, to_b]: [&mut [f32]; 2]) -> [f64; 2] {
    let mut sums = [[0.0f64; LANES]; 2];
    for start in (0..r.len()).step_by(BLOCK) {
        let end = (start + BLOCK).min(r.len());
        let n = end - start;
        let mut colors = [[0.0f32; BLOCK]; 3];
        for (color, plane) in colors.iter_mut().zip([r, g, b]) {
            color[..n].copy_from_slice(&plane[start..end]);
        }
        let mut l = [0.0f64; BLOCK];
        let mut opponents = [[0.0f32; BLOCK]; 2];
        for x in 0..BLOCK {
            let lab = lab_of_encoded([colors[0][x], colors[1][x], colors[2][x]]);
            l[x] = f64::from(lab[0]) * (1.0 / WHITE);
            opponents[0][x] = lab[1];
            opponents[1][x] = lab[2];
        }
        for (sums, opponent) in sums.iter_mut().zip(&mut opponents) {
            opponent[n..].fill(0.0);
            for (i, &value) in opponent.iter().enumerate() {
                sums[i % LANES] += f64::from(value);
            }
        }
        lightness[start..end].copy_from_slice(&l[..n]);
        to_a[start..end].copy_from_slice(&opponents[0][..n]);
        to_b[start..end].copy_from_slice(&opponents[1][..n]);
    }
    sums.map(|sums| sums.iter().sum())
}

/// The codes of lightness, a and b, strip by strip, to avoid full-size planes of linear light.
fn encoded(lightness: &Plane<f64>, opponents: &[Plane<f32>; 2], factors: [f64; 2]) -> Rgb8 {
    let (width, height) = lightness.size();
    let mut codes = Vec::with_capacity(3 * width * height);
    let [a, b] = opponents
        .each_ref()
        .map(|plane| plane.data().chunks(STRIP * width));
    let lightness = lightness.data().chunks(STRIP * width);
    for (l, (a, b)) in lightness.zip(a.zip(b)) {
        let mut light = [0; 3].map(|_| vec![0.0f32; l.len()]);
        vectorized!(to_linear(l, [a, b], factors, &mut light));
        let light = light.map(|plane| Plane::new(width, l.len() / width, plane).expect("whole rows"));
        let (strip, _) = transfer::encode_rgb8(&Rgb::new(light).expect("three planes of one size"));
        codes.extend_from_slice(strip.data());
    }
    Rgb8::new(width, height, codes).expect("three codes for each pixel")
}

#[inline(always)]
fn to_linear(lightness: &[f64], [a, b]: [&[f32]; 2], factors: [f64; 2], light: &mut [Vec<f32>; 3]) {
    let matrix = lab::from_xyz().map(|row| row.map(|value| value as f32));
    let scales = factors.map(|factor| factor as f32);
    let shifts = factors.map(|factor| (NEUTRAL * (factor - 1.0)) as f32);
    let [red, green, blue] = light;
    let targets = red.iter_mut().zip(green.iter_mut().zip(blue));
    let sources = lightness.iter().zip(a.iter().zip(b));
    for ((red, (green, blue)), (&l, (a, b))) in targets.zip(sources) {
        let l = (WHITE * l) as f32;
        let l = if l > 0.0 { l } else { 0.0 };
        let l = if l < WHITE as f32 { l } else { WHITE as f32 };
        let lab = [l, scales[0] * a + shifts[0], scales[1] * b + shifts[1]];
        [*red, *green, *blue] = linear_of_lab(lab, &matrix);
    }
}
