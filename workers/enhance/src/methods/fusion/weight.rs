//! Step 4 in single precision: the weight of an input.

use imaging::{Plane, vectorized};

use super::definition::{LUMA, SALIENCY_SCALE};
use crate::blocks::blurred_row;
use crate::blocks::lab::lab_of_encoded;

/// Pixels per block.
const BLOCK: usize = 32;
/// Partial sums of a mean.
const LANES: usize = 8;

/// Planes of an input in CIE Lab, used for one input after another.
pub(super) struct Perceived {
    lab: [Plane<f32>; 3],
    mean: [f32; 3],
    luma: Plane<f32>,
}

impl Perceived {
    pub(super) fn new(width: usize, height: usize) -> Self {
        Self {
            lab: [0; 3].map(|_| Plane::filled(width, height, 0.0)),
            mean: [0.0; 3],
            luma: Plane::filled(width, height, 0.0),
        }
    }

    /// `w` of an input.
    pub(super) fn weight(&mut self, input: [&Plane<f32>; 3]) -> Plane<f32> {
        let (width, height) = input[0].size();
        let mut weight = Plane::filled(width, height, 0.0);
        vectorized!(perceive(input.map(Plane::data), self, weight.data_mut()));
        let mut lines = [0; 3].map(|_| vec![0.0; width]);
        let mut scratch = vec![0.0; width + 4];
        for y in 0..height {
            vectorized!({
                for (plane, line) in self.lab.iter().zip(&mut lines) {
                    blurred_row(plane, y, &mut scratch, line);
                }
                add_saliency(&lines, self.mean, weight.row_mut(y));
                add_contrast(&self.luma, y, &mut scratch, weight.row_mut(y));
            });
        }
        weight
    }
}

/// Fills Lab, its means and the luma, and the weight by `w_sat`.
#[inline(always)]
fn perceive([r, g, b]: [&[f32]; 3], perceived: &mut Perceived, weight: &mut [f32]) {
    let lumas = perceived.luma.data_mut();
    let mut sums = [[0.0f64; LANES]; 3];
    let [lab_l, lab_a, lab_b] = perceived.lab.each_mut().map(Plane::data_mut);
    for start in (0..r.len()).step_by(BLOCK) {
        let end = (start + BLOCK).min(r.len());
        let n = end - start;
        let mut colors = [[0.0f32; BLOCK]; 3];
        for (color, plane) in colors.iter_mut().zip([r, g, b]) {
            color[..n].copy_from_slice(&plane[start..end]);
        }
        let mut lab = [[0.0f32; BLOCK]; 3];
        let (mut luma, mut saturation) = ([0.0f32; BLOCK], [0.0f32; BLOCK]);
        for x in 0..BLOCK {
            let color = [colors[0][x], colors[1][x], colors[2][x]];
            let values = lab_of_encoded(color);
            lab[0][x] = values[0];
            lab[1][x] = values[1];
            lab[2][x] = values[2];
            let y = LUMA[0] as f32 * color[0] + LUMA[1] as f32 * color[1] + LUMA[2] as f32 * color[2];
            luma[x] = y;
            let [r, g, b] = color.map(|value| (value - y) * (value - y));
            saturation[x] = ((r + g + b) * (1.0 / 3.0)).sqrt();
        }
        for (sums, lab) in sums.iter_mut().zip(&mut lab) {
            lab[n..].fill(0.0);
            for (i, &value) in lab.iter().enumerate() {
                sums[i % LANES] += f64::from(value);
            }
        }
        lab_l[start..end].copy_from_slice(&lab[0][..n]);
        lab_a[start..end].copy_from_slice(&lab[1][..n]);
        lab_b[start..end].copy_from_slice(&lab[2][..n]);
        lumas[start..end].copy_from_slice(&luma[..n]);
        weight[start..end].copy_from_slice(&saturation[..n]);
    }
    perceived.mean = sums.map(|sums| (sums.iter().sum::<f64>() / r.len() as f64) as f32);
}

/// Adds `w_S` of a row blurred in Lab.
#[inline(always)]
fn add_saliency([l, a, b]: &[Vec<f32>; 3], mean: [f32; 3], weight: &mut [f32]) {
    for (weight, (l, (a, b))) in weight.iter_mut().zip(l.iter().zip(a.iter().zip(b))) {
        let [l, a, b] = [mean[0] - l, mean[1] - a, mean[2] - b];
        *weight += SALIENCY_SCALE as f32 * (l * l + a * a + b * b).sqrt();
    }
}

/// Adds `w_L` of a row.
#[inline(always)]
fn add_contrast(luma: &Plane<f32>, y: usize, scratch: &mut [f32], weight: &mut [f32]) {
    let row = luma.row(y);
    let (width, last) = (row.len(), luma.height() - 1);
    let line = &mut scratch[..width + 2];
    line[1..=width].copy_from_slice(row);
    line[0] = row[0];
    line[width + 1] = row[width - 1];
    let vertical = luma
        .row(y.saturating_sub(1))
        .iter()
        .zip(luma.row((y + 1).min(last)));
    let across = line[..width].iter().zip(&line[2..]);
    for ((weight, own), ((above, below), (left, right))) in
        weight.iter_mut().zip(row).zip(vertical.zip(across))
    {
        *weight += (4.0 * own - (left + right + above + below)).abs();
    }
}
