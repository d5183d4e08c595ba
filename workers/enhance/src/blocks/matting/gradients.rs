//! Conjugate gradients, preconditioned by the diagonal (Hestenes and Stiefel 1952; Golub and Van Loan 2013, algorithm 11.5.1).

use imaging::{Plane, vectorized};

use super::laplacian::Laplacian;
use super::windows::RIM;

/// Far more steps than the worst picture needs: rounding could keep the residual above its bound forever.
const STEPS_MAX: usize = 40_000;

/// Solves `(L + λ E) x = λ p` from a start until the residual is below a share of `λ p`.
pub(super) fn solved(
    laplacian: &Laplacian,
    closeness: f64,
    plane: &Plane<f64>,
    start: &Plane<f64>,
    residual: f64,
) -> Plane<f64> {
    let target = with_rim(laplacian, &plane.map(|value| closeness * value));
    let mut x = with_rim(laplacian, start);
    let mut product = vec![0.0; x.len()];
    laplacian.apply(closeness, &x, &mut product);
    let mut rest: Vec<f64> = target.iter().zip(&product).map(|(b, ax)| b - ax).collect();
    let bound = residual * residual * dot(&target, &target);
    let inverse: Vec<f64> = laplacian
        .diagonal()
        .iter()
        .map(|own| 1.0 / (own + closeness))
        .collect();
    let mut scaled: Vec<f64> = rest
        .iter()
        .zip(&inverse)
        .map(|(r, inverse)| r * inverse)
        .collect();
    let mut direction = scaled.clone();
    let mut weight = dot(&rest, &scaled);
    for _ in 0..STEPS_MAX {
        if dot(&rest, &rest) <= bound {
            break;
        }
        laplacian.apply(closeness, &direction, &mut product);
        let length = weight / dot(&direction, &product);
        vectorized!(advance(&mut x, &direction, length));
        vectorized!(advance(&mut rest, &product, -length));
        vectorized!(multiply(&mut scaled, &rest, &inverse));
        let next = dot(&rest, &scaled);
        vectorized!(turn(&mut direction, &scaled, next / weight));
        weight = next;
    }
    Plane::from_fn(laplacian.width, laplacian.height, |i, j| {
        x[laplacian.position(i, j)]
    })
}

fn with_rim(laplacian: &Laplacian, plane: &Plane<f64>) -> Vec<f64> {
    let mut padded = vec![0.0; laplacian.stride() * (laplacian.height + 2 * RIM)];
    for (y, row) in plane.data().chunks_exact(laplacian.width).enumerate() {
        padded[laplacian.position(0, y)..][..laplacian.width].copy_from_slice(row);
    }
    padded
}

/// Dot product in fixed lanes, independent of the CPU.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    vectorized!(lanes(a, b))
}

#[inline(always)]
fn lanes(a: &[f64], b: &[f64]) -> f64 {
    const LANES: usize = 16;
    let mut sums = [0.0f64; LANES];
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    for (a, b) in a.iter().zip(b) {
        for i in 0..LANES {
            sums[i] += a[i] * b[i];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}

#[inline(always)]
fn advance(x: &mut [f64], direction: &[f64], length: f64) {
    for (x, d) in x.iter_mut().zip(direction) {
        *x += length * d;
    }
}

#[inline(always)]
fn multiply(out: &mut [f64], a: &[f64], b: &[f64]) {
    for (out, (a, b)) in out.iter_mut().zip(a.iter().zip(b)) {
        *out = a * b;
    }
}

#[inline(always)]
fn turn(direction: &mut [f64], scaled: &[f64], share: f64) {
    for (d, s) in direction.iter_mut().zip(scaled) {
        *d = s + share * *d;
    }
}
