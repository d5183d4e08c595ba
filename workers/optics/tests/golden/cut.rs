//! Truncation of the stored arrays of two kernels.

#[path = "cut/gated.rs"]
mod gated;

use std::f64::consts::PI;

use imaging::dct::Dct2;
use imaging::{Plane, Rgb};
use optics::kernel::{Transfer, pixel};
use optics::layering::Layering;

use crate::case::Case;

/// Kernels that the arrays were made with.
const NODES: usize = 24;
/// Narrower kernels are cut at this number of pixels; their remainder is in the middle.
const NARROW: f64 = 0.3;
const REACH: i64 = 60;
/// Added to a scale before its logarithm is taken.
const SHIFT: f64 = 0.3;

/// A number that grows with the optical path b Z: its value at 0, and its slope.
type Line = (f64, f64);

/// Angles of the narrow and the wide kernel, radians, and the share of the wide one.
#[derive(Clone, Copy)]
struct Fit {
    angles: [Line; 2],
    share: Line,
}

const FOURNIER_FORAND: Fit = Fit {
    angles: [(0.0015, 0.0007), (0.035, 0.010)],
    share: (0.63, 0.065),
};
const HENYEY_GREENSTEIN: Fit = Fit {
    angles: [(0.0045, 0.0), (0.040, 0.010)],
    share: (0.84, 0.02),
};

/// Forward scatter by two kernels as the prototype computed it, whose narrow kernels are cut off against the definition; behind gates
/// where there are layers.
pub(crate) fn forward_of_cut_kernels(
    case: &Case,
    radiance: &Rgb<f64>,
    range: &Plane<f64>,
    layering: Option<&Layering>,
) -> Rgb<f64> {
    let focal_px = case.number("focal_px").expect("a focal length");
    let [a, b] = ["absorption", "scattering"].map(|name| case.triple(name).expect("three values"));
    let planes = [0, 1, 2].map(|channel| {
        let water = Water {
            absorption: a[channel],
            scattering: b[channel],
            focal_px,
            fit: match case.text("law").as_str() {
                "hg" => HENYEY_GREENSTEIN,
                _ => FOURNIER_FORAND,
            },
        };
        let (prototype, light) = (Prototype::new(water, range), &radiance.planes()[channel]);
        match layering {
            Some(layering) => prototype.gated(light, layering),
            None => prototype.forward(light),
        }
    });
    Rgb::new(planes).expect("planes of one frame")
}

#[derive(Clone, Copy)]
struct Water {
    absorption: f64,
    scattering: f64,
    focal_px: f64,
    fit: Fit,
}

impl Water {
    /// Scales of both kernels at a range, pixels.
    fn scales(&self, z: f64) -> [f64; 2] {
        let path = self.scattering * z;
        let angles = self.fit.angles.iter();
        let scales: Vec<f64> = angles
            .map(|(at_zero, slope)| self.focal_px * (at_zero + slope * path))
            .collect();
        [scales[0], scales[1]]
    }

    fn wide_share(&self, z: f64) -> f64 {
        (self.fit.share.0 + self.fit.share.1 * self.scattering * z).min(1.0)
    }

    fn direct(&self, z: f64) -> f64 {
        (-(self.absorption + self.scattering) * z).exp()
    }

    fn spread(&self, z: f64) -> f64 {
        (-(self.absorption + 0.05 * self.scattering) * z).exp() - self.direct(z)
    }
}

/// One channel of the prototype: nodes over the scales of both kernels in the frame.
struct Prototype<'a> {
    water: Water,
    range: &'a Plane<f64>,
    low: f64,
    high: f64,
    /// Transfer function of each node.
    kernels: Vec<Vec<f64>>,
}

fn is_seen(z: f64) -> bool {
    z.is_finite() && z > 0.0
}

fn place(gamma: f64) -> f64 {
    (gamma + SHIFT).ln()
}

fn angle(k: usize) -> f64 {
    PI * (k as f64 + 0.5) / NODES as f64
}

impl<'a> Prototype<'a> {
    fn new(water: Water, range: &'a Plane<f64>) -> Self {
        // A hole counts as 1 m where scales are spanned.
        let meters = range.data().iter().map(|&z| if is_seen(z) { z } else { 1.0 });
        let all = meters.flat_map(|z| water.scales(z)).map(place);
        let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), s| {
            (l.min(s), h.max(s))
        });
        let mut prototype = Self {
            water,
            range,
            low,
            high,
            kernels: Vec::new(),
        };
        prototype.kernels = (0..NODES)
            .map(|k| transfer((prototype.node(k).exp() - SHIFT).max(0.0), range.size()))
            .collect();
        prototype
    }

    /// A node in s.
    fn node(&self, k: usize) -> f64 {
        (self.low + self.high) / 2.0 + (self.high - self.low) / 2.0 * angle(k).cos()
    }

    /// Barycentric weights of all nodes at a scale.
    fn shares(&self, gamma: f64) -> Vec<f64> {
        let s = place(gamma);
        let weight = |k: usize| {
            let sign = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
            sign * angle(k).sin() / (s - self.node(k))
        };
        let weights: Vec<f64> = (0..NODES).map(weight).collect();
        let sum: f64 = weights.iter().sum();
        weights.into_iter().map(|weight| weight / sum).collect()
    }

    /// Spectrum of light that is spread with the kernels of its range.
    fn spread(&self, light: &Plane<f64>, range: &Plane<f64>) -> Vec<f64> {
        let (width, height) = light.size();
        let mut transform = Dct2::new(width, height);
        let mut parts = vec![vec![0.0; light.data().len()]; NODES];
        for (at, (&light, &z)) in light.data().iter().zip(range.data()).enumerate() {
            let [narrow, wide] = self.water.scales(z).map(|gamma| self.shares(gamma));
            let m = self.water.wide_share(z);
            for (k, part) in parts.iter_mut().enumerate() {
                part[at] = light * self.water.spread(z) * ((1.0 - m) * narrow[k] + m * wide[k]);
            }
        }
        let mut sum = vec![0.0; light.data().len()];
        for (mut part, kernel) in parts.into_iter().zip(&self.kernels) {
            transform.forward(&mut part);
            for ((sum, part), kernel) in sum.iter_mut().zip(&part).zip(kernel) {
                *sum += part * kernel;
            }
        }
        sum
    }

    /// F without gates.
    fn forward(&self, radiance: &Plane<f64>) -> Plane<f64> {
        let shown = zip(
            radiance,
            self.range,
            |light, z| if is_seen(z) { light } else { 0.0 },
        );
        let range = self.range.map(|&z| if is_seen(z) { z } else { 1.0 });
        let mut sum = self.spread(&shown, &range);
        let (width, height) = radiance.size();
        Dct2::new(width, height).inverse(&mut sum);
        Plane::new(width, height, sum).expect("the size of the frame")
    }
}

fn zip(a: &Plane<f64>, b: &Plane<f64>, join: impl Fn(f64, f64) -> f64) -> Plane<f64> {
    let data = a.data().iter().zip(b.data()).map(|(&a, &b)| join(a, b));
    Plane::new(a.width(), a.height(), data.collect()).expect("the size of the frame")
}

fn transfer(gamma: f64, (width, height): (usize, usize)) -> Vec<f64> {
    if gamma >= NARROW {
        return Transfer::new(gamma).grid(width, height);
    }
    let side = -REACH..=REACH;
    let mut kernel: Vec<Vec<f64>> = side
        .clone()
        .map(|j| side.clone().map(|i| pixel(i, j, gamma)).collect())
        .collect();
    kernel[REACH as usize][REACH as usize] += 1.0 - kernel.iter().flatten().sum::<f64>();
    let waves = |count: usize| -> Vec<Vec<f64>> {
        let wave = |p: usize| {
            side.clone()
                .map(|i| (PI * p as f64 * i as f64 / count as f64).cos())
                .collect()
        };
        (0..count).map(wave).collect()
    };
    let (across, down) = (waves(width), waves(height));
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    // Over columns first, then over rows.
    let rows: Vec<Vec<f64>> = (across.iter())
        .map(|wave| kernel.iter().map(|row| dot(row, wave)).collect())
        .collect();
    let grid = down
        .iter()
        .flat_map(|wave| rows.iter().map(|column| dot(column, wave)));
    grid.collect()
}
