//! The closed-form color transfer: the affine map from the mean and covariance of one set of colors to those of
//! another.
//!
//! `y = A x + b`, `A = Cx^-1/2 (Cx^1/2 Cs Cx^1/2)^1/2 Cx^-1/2`, `b = ms - A mx`: the linear Monge-Kantorovich map
//! between Gaussians (Pitié and Kokaram 2007, "The linear Monge-Kantorovitch linear color mapping for example-based
//! color transfer"), for means m and covariances C of the content (x) and the style (s), each with 1e-5 on its
//! diagonal.

use crate::tensor::Tensor;

type Matrix = [[f64; 3]; 3];

const FLOOR: f64 = 1e-5;

/// Mean and covariance of the colors of pictures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ColorStats {
    /// Mean.
    pub(crate) mean: [f64; 3],
    /// Covariance.
    pub(crate) covariance: Matrix,
}

impl ColorStats {
    /// Over all pixels of the pictures.
    pub(crate) fn measure<'a>(pictures: impl Iterator<Item = &'a Tensor<f32>>) -> Self {
        let (mut count, mut sums, mut products) = (0.0, [0.0; 3], [[0.0; 3]; 3]);
        for picture in pictures {
            count += picture.plane(0).len() as f64;
            for row in 0..3 {
                sums[row] += picture.plane(row).iter().map(|&v| f64::from(v)).sum::<f64>();
                for column in 0..3 {
                    let pairs = picture.plane(row).iter().zip(picture.plane(column));
                    products[row][column] += pairs.map(|(&a, &b)| f64::from(a) * f64::from(b)).sum::<f64>();
                }
            }
        }
        let mean = sums.map(|sum| sum / count);
        let mut covariance = products;
        for row in 0..3 {
            for column in 0..3 {
                covariance[row][column] = products[row][column] / count - mean[row] * mean[column];
            }
        }
        Self { mean, covariance }
    }

    /// The largest standard deviation of a channel.
    pub(crate) fn spread(&self) -> f64 {
        (0..3)
            .map(|channel| self.covariance[channel][channel].max(0.0).sqrt())
            .fold(0.0, f64::max)
    }
}

/// The map from the colors of the content to those of the style: matrix and offset.
pub(crate) fn transfer(content: &ColorStats, style: &ColorStats) -> (Matrix, [f64; 3]) {
    let [cx, cs] = [content, style].map(|colors| {
        let mut covariance = colors.covariance;
        (0..3).for_each(|i| covariance[i][i] += FLOOR);
        covariance
    });
    let (root, inverse) = (power(&cx, 0.5), power(&cx, -0.5));
    let middle = power(&product(&product(&root, &cs), &root), 0.5);
    let map = product(&product(&inverse, &middle), &inverse);
    let offset = [0, 1, 2].map(|row| {
        let mapped: f64 = (0..3).map(|i| map[row][i] * content.mean[i]).sum();
        style.mean[row] - mapped
    });
    (map, offset)
}

/// A map whose matrix and offset change with the range q: `near + q change`.
pub(crate) struct RangedTransfer {
    pub(crate) near: (Matrix, [f64; 3]),
    pub(crate) change: (Matrix, [f64; 3]),
}

/// The transfer between the near halves of two sets of pictures, and between the far halves: linear in the range q of
/// the content, through both at the mean q of the halves. Halves are over all pixels of a set, in its order of range.
pub(crate) fn ranged_transfer<'a>(
    contents: impl Iterator<Item = (&'a Tensor<f32>, &'a Tensor<f32>)>,
    styles: impl Iterator<Item = (&'a Tensor<f32>, &'a Tensor<f32>)>,
) -> RangedTransfer {
    let (contents, styles) = (Halves::split(contents), Halves::split(styles));
    let maps = [0, 1].map(|half| transfer(&contents.colors[half], &styles.colors[half]));
    let [near, far] = contents.ranges;
    // If all pixels have the same range, the near half represents all.
    let distance = if far > near { far - near } else { f64::INFINITY };
    let [(near_matrix, near_offset), (far_matrix, far_offset)] = maps;
    let rows = [0, 1, 2];
    let matrix = rows.map(|i| rows.map(|j| (far_matrix[i][j] - near_matrix[i][j]) / distance));
    let offset = rows.map(|i| (far_offset[i] - near_offset[i]) / distance);
    RangedTransfer {
        near: (
            rows.map(|i| rows.map(|j| near_matrix[i][j] - near * matrix[i][j])),
            rows.map(|i| near_offset[i] - near * offset[i]),
        ),
        change: (matrix, offset),
    }
}

/// Colors and mean range of the near and of the far half of a set's pixels.
struct Halves {
    colors: [ColorStats; 2],
    ranges: [f64; 2],
}

impl Halves {
    fn split<'a>(pictures: impl Iterator<Item = (&'a Tensor<f32>, &'a Tensor<f32>)>) -> Self {
        let mut pixels: Vec<(f32, [f32; 3])> = Vec::new();
        for (picture, range) in pictures {
            let colors =
                (0..picture.plane(0).len()).map(|at| [0, 1, 2].map(|channel| picture.plane(channel)[at]));
            pixels.extend(range.plane(0).iter().copied().zip(colors));
        }
        pixels.sort_by(|one, other| one.0.total_cmp(&other.0));
        let (near, far) = pixels.split_at(pixels.len() / 2);
        let halves = [near, far].map(|pixels| {
            let mut colors = Tensor::zeros(3, 1, pixels.len());
            for channel in 0..3 {
                for (out, (_, color)) in colors.plane_mut(channel).iter_mut().zip(pixels) {
                    *out = color[channel];
                }
            }
            let range = pixels.iter().map(|(range, _)| f64::from(*range)).sum::<f64>();
            (
                ColorStats::measure(std::iter::once(&colors)),
                range / pixels.len().max(1) as f64,
            )
        });
        let [(near, near_range), (far, far_range)] = halves;
        Self {
            colors: [near, far],
            ranges: [near_range, far_range],
        }
    }
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    [0, 1, 2].map(|row| [0, 1, 2].map(|column| (0..3).map(|at| a[row][at] * b[at][column]).sum()))
}

/// A power of a symmetric positive semidefinite matrix, by Jacobi rotations.
fn power(matrix: &Matrix, exponent: f64) -> Matrix {
    let (mut a, mut vectors) = (*matrix, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    // A 3×3 matrix is diagonal to the last bit after five or six sweeps.
    for _ in 0..12 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[p][q] == 0.0 {
                continue;
            }
            let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
            let tangent = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let cosine = 1.0 / (tangent * tangent + 1.0).sqrt();
            let sine = tangent * cosine;
            let rotate = |m: &mut Matrix, columns: bool| {
                for at in 0..3 {
                    let (i, j) = if columns {
                        ((at, p), (at, q))
                    } else {
                        ((p, at), (q, at))
                    };
                    let (one, other) = (m[i.0][i.1], m[j.0][j.1]);
                    m[i.0][i.1] = cosine * one - sine * other;
                    m[j.0][j.1] = sine * one + cosine * other;
                }
            };
            rotate(&mut a, true);
            rotate(&mut a, false);
            rotate(&mut vectors, true);
        }
    }
    let values = [0, 1, 2].map(|at| libm::pow(a[at][at].max(1e-12), exponent));
    [0, 1, 2].map(|row| {
        [0, 1, 2].map(|column| {
            (0..3)
                .map(|at| vectors[row][at] * values[at] * vectors[column][at])
                .sum()
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONTENT: ColorStats = ColorStats {
        mean: [0.4, 0.5, 0.3],
        covariance: [[0.05, 0.02, 0.01], [0.02, 0.06, 0.015], [0.01, 0.015, 0.04]],
    };

    #[test]
    fn the_map_gives_the_mean_and_covariance_of_the_style() {
        let style = ColorStats {
            mean: [0.1, 0.4, 0.6],
            covariance: [[0.004, 0.001, 0.0], [0.001, 0.02, 0.008], [0.0, 0.008, 0.03]],
        };
        let (map, offset) = transfer(&CONTENT, &style);
        let transposed = [0, 1, 2].map(|row| [0, 1, 2].map(|column| map[column][row]));
        let mapped = product(&product(&map, &CONTENT.covariance), &transposed);
        for row in 0..3 {
            let mean: f64 = (0..3).map(|at| map[row][at] * CONTENT.mean[at]).sum();
            assert!((mean + offset[row] - style.mean[row]).abs() < 1e-12);
            for column in 0..3 {
                // The remaining difference is the floor on both diagonals.
                assert!((mapped[row][column] - style.covariance[row][column]).abs() < 5e-5);
            }
        }
    }

    #[test]
    fn the_same_colors_are_left_alone() {
        let (map, offset) = transfer(&CONTENT, &CONTENT);
        for row in 0..3 {
            assert!(offset[row].abs() < 1e-9);
            for column in 0..3 {
                let identity = f64::from(u8::from(row == column));
                assert!((map[row][column] - identity).abs() < 1e-9);
            }
        }
    }
}
