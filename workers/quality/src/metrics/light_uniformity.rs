//! Light uniformity: evenness of the illumination of an unknown scene.
//!
//! The picture is divided into 8 × 8 cells of equal sides (fewer along an axis of less than 8 pixels). With `m_i` the
//! mean linear luminance of cell i (sRGB decoded; 0.2126 R + 0.7152 G + 0.0722 B, 0..=1) and ε one half of the light of
//! code 1, `U = exp(-s)`, `s = sqrt(mean (ln(m_i + ε) - mean ln(m + ε))²)`.
//!
//! U is in 0..=1 and has no unit: 1 is even light, and 1 / U is the geometric standard deviation, the factor by which a
//! typical cell is brighter or darker than the picture's geometric mean. At U = 0.5 that factor is two.
//!
//! Rationale: lighting practice rates a working plane by the ratio of illuminances (EN 12464-1: minimum over mean),
//! which is independent of exposure. A ratio of two extremes depends on two cells, and the darkest cell of a picture is
//! as often a dark object as a dark corner. The standard deviation of the logarithm is also independent of exposure (a
//! factor is an offset of all logarithms), uses every cell, and is the spread of the light alone if all cells have the
//! same reflectance. The mean of a cell averages texture and grain smaller than the cell, but not a lamp, whose cone is
//! larger. ε keeps black cells finite and below the resolution of codes.
//!
//! Limitation: a scene with a bright and a dark half looks unevenly lit. Compare pictures of the same scene.

use std::sync::LazyLock;

use crate::linear::{HALF_CODE, LINEAR, LUMINANCE};
use crate::mask::contains_block;
use crate::work::MetricInput;

/// Cells along either axis.
const CELLS: usize = 8;
/// Light is summed in integer multiples of this, so that the order of the sum does not matter.
const STEPS: f64 = (1u64 << 32) as f64;

/// Luminance of each code of red, green and blue, in steps.
static LIGHT: LazyLock<[[u64; 256]; 3]> =
    LazyLock::new(|| LUMINANCE.map(|weight| LINEAR.map(|light| (weight * light * STEPS).round() as u64)));

/// Evenness of the light, 0..=1.
pub(crate) fn light_uniformity(work: &MetricInput) -> f64 {
    let cells = cells(work);
    if cells.is_empty() {
        return 0.0;
    }
    // Relative to the first cell, so that even light is exactly 1.
    let first = cells[0] + HALF_CODE;
    let logs: Vec<f64> = cells
        .iter()
        .map(|mean| ((mean + HALF_CODE) / first).ln())
        .collect();
    let mean = logs.iter().sum::<f64>() / logs.len() as f64;
    let variance = logs.iter().map(|log| (log - mean) * (log - mean)).sum::<f64>() / logs.len() as f64;
    (-variance.sqrt()).exp()
}

/// Mean luminance of every cell entirely inside the mask.
fn cells(work: &MetricInput) -> Vec<f64> {
    let light: &[[u64; 256]; 3] = &LIGHT;
    let picture = work.picture();
    let (across, down) = (CELLS.min(picture.width()), CELLS.min(picture.height()));
    let mut means = Vec::with_capacity(across * down);
    for j in 0..down {
        let rows = j * picture.height() / down..(j + 1) * picture.height() / down;
        for i in 0..across {
            let columns = i * picture.width() / across..(i + 1) * picture.width() / across;
            let inside = work
                .mask()
                .is_none_or(|mask| contains_block(mask, columns.clone(), rows.clone()));
            if !inside {
                continue;
            }
            let mut sum = 0u64;
            for y in rows.clone() {
                let pixels = &work.picture_row(y)[3 * columns.start..3 * columns.end];
                for p in pixels.chunks_exact(3) {
                    sum += light[0][usize::from(p[0])]
                        + light[1][usize::from(p[1])]
                        + light[2][usize::from(p[2])];
                }
            }
            means.push(sum as f64 / STEPS / (rows.len() * columns.len()) as f64);
        }
    }
    means
}
