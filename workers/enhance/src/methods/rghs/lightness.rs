//! Step 3: stretches lightness and strengthens colors in CIE Lab.

use imaging::{Plane, Rgb, Rgb8, lab, transfer, vectorized};

use crate::blocks::histogram::Curves;
use crate::blocks::tails;
use crate::elementary::exp;
use crate::variant::Variant;

/// Share of the pixels beyond either end of the lightness.
const TAIL: f64 = 0.01;
/// `1.3^(1 - |p| / 128)`.
const STRENGTH: f64 = 1.3;
/// Lightness within this span is one value.
const FLAT_L: f64 = 1e-6;

pub(super) fn stretched(picture: &Rgb8, curves: &Curves, variant: Variant) -> Rgb8 {
    match variant {
        Variant::Fast => fast(picture, curves),
        Variant::Reference => reference(picture, curves),
    }
}

fn reference(picture: &Rgb8, curves: &Curves) -> Rgb8 {
    let linear = linear(curves);
    let lab: Vec<[f64; 3]> = picture
        .pixels()
        .map(|pixel| lab::of_linear([0, 1, 2].map(|c| linear[c][usize::from(pixel[c])])))
        .collect();
    let lightness: Vec<f64> = lab.iter().map(|lab| lab[0]).collect();
    let (low, high) = tails(&lightness, TAIL, Variant::Reference);
    let codes = lab.into_iter().flat_map(|[l, a, b]| {
        let l = if high - low > FLAT_L {
            100.0 * ((l - low) / (high - low)).clamp(0.0, 1.0)
        } else {
            l
        };
        let [a, b] = [a, b].map(|p| p * STRENGTH.powf(1.0 - p.abs() / 128.0));
        lab::to_linear([l, a, b], lab::from_xyz())
            .map(|light| (255.0 * transfer::encode(light.clamp(0.0, 1.0)) + 0.5).floor() as u8)
    });
    Rgb8::new(picture.width(), picture.height(), codes.collect()).expect("three codes for each pixel")
}

fn fast(picture: &Rgb8, curves: &Curves) -> Rgb8 {
    let linear = linear(curves);
    let pixels = picture.data().len() / 3;
    let mut lightness = vec![0.0f64; pixels];
    let mut opponents = [0; 2].map(|_| vec![0.0f32; pixels]);
    vectorized!(to_lab(picture.data(), &linear, &mut lightness, &mut opponents));
    let (low, high) = tails(&lightness, TAIL, Variant::Fast);
    // Strip by strip, to avoid a full-size plane of linear light.
    let width = picture.width();
    let mut codes = Vec::with_capacity(picture.data().len());
    let [a, b] = opponents.each_ref().map(|plane| plane.chunks(STRIP * width));
    for (l, (a, b)) in lightness.chunks(STRIP * width).zip(a.zip(b)) {
        let mut planes = [0; 3].map(|_| vec![0.0f32; l.len()]);
        vectorized!(from_lab(l, [a, b], (low, high), &mut planes));
        let planes = planes.map(|plane| Plane::new(width, l.len() / width, plane).expect("whole rows"));
        let (strip, _) = transfer::encode_rgb8(&Rgb::new(planes).expect("three planes of one size"));
        codes.extend_from_slice(strip.data());
    }
    Rgb8::new(width, picture.height(), codes).expect("three codes for each pixel")
}

/// Rows per strip.
const STRIP: usize = 16;

/// Pixels per block.
const BLOCK: usize = 32;

#[inline(always)]
fn to_lab(codes: &[u8], linear: &Curves, lightness: &mut [f64], [a, b]: &mut [Vec<f32>; 2]) {
    let planes = lightness
        .chunks_mut(BLOCK)
        .zip(a.chunks_mut(BLOCK).zip(b.chunks_mut(BLOCK)));
    for (codes, (l, (a, b))) in codes.chunks(3 * BLOCK).zip(planes) {
        let lab = lab::of_codes::<BLOCK>(codes, linear.each_ref());
        l.copy_from_slice(&lab[0][..l.len()]);
        for (to, from) in a.iter_mut().zip(&lab[1]).chain(b.iter_mut().zip(&lab[2])) {
            *to = *from as f32;
        }
    }
}

#[inline(always)]
fn from_lab(lightness: &[f64], [a, b]: [&[f32]; 2], (low, high): (f64, f64), light: &mut [Vec<f32>; 3]) {
    let scale = if high - low > FLAT_L {
        100.0 / (high - low)
    } else {
        0.0
    };
    let matrix = lab::from_xyz().map(|row| row.map(|value| value as f32));
    let decay = -(STRENGTH.ln() / 128.0) as f32;
    let strengthened = |p: f32| p * (STRENGTH as f32) * exp(decay * p.abs());
    let planes = lightness
        .chunks(BLOCK)
        .zip(a.chunks(BLOCK).zip(b.chunks(BLOCK)))
        .enumerate();
    for (block, (l, (a, b))) in planes {
        let mut lab = [[0.0f32; BLOCK]; 3];
        for (to, &l) in lab[0].iter_mut().zip(l) {
            let stretched = (l - low) * scale;
            let stretched = if stretched > 0.0 { stretched } else { 0.0 };
            let stretched = if stretched < 100.0 { stretched } else { 100.0 };
            *to = if scale > 0.0 { stretched } else { l } as f32;
        }
        lab[1][..a.len()].copy_from_slice(a);
        lab[2][..b.len()].copy_from_slice(b);
        let mut out = [[0.0f32; BLOCK]; 3];
        for x in 0..BLOCK {
            let y = (lab[0][x] + 16.0) / 116.0;
            let xyz = [
                response(y + strengthened(lab[1][x]) / 500.0),
                response(y),
                response(y - strengthened(lab[2][x]) / 200.0),
            ];
            for (out, row) in out.iter_mut().zip(&matrix) {
                out[x] = row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2];
            }
        }
        let start = block * BLOCK;
        for (plane, out) in light.iter_mut().zip(&out) {
            plane[start..start + l.len()].copy_from_slice(&out[..l.len()]);
        }
    }
}

/// The inverse of the response of CIE Lab.
#[inline(always)]
fn response(t: f32) -> f32 {
    const KNEE: f32 = 6.0 / 29.0;
    let cube = t * t * t;
    if t > KNEE {
        cube
    } else {
        3.0 * KNEE * KNEE * (t - 4.0 / 29.0)
    }
}

pub(super) fn linear(curves: &Curves) -> Curves {
    curves.map(|curve| curve.map(|value| imaging::transfer::decode(value / 255.0)))
}
