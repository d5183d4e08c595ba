//! Harris and Stephens' corner response (1988), `det M - 0.04 (trace M)²`, with M the products of Sobel derivatives of
//! the gray codes summed over 7 × 7 pixels. All sums are integers.

use imaging::Plane;

/// Weight of the squared trace.
const K: f64 = 0.04;
/// Radius of the sums.
const RADIUS: usize = 3;
/// Pixels along a side of the window with the neighbors of its derivatives.
const SIDE: usize = 2 * RADIUS + 3;

/// The response at (x, y), at least four pixels from the border.
#[inline(always)]
pub(crate) fn response(gray: &Plane<u8>, x: usize, y: usize) -> f64 {
    // Sums with weights 1 2 1 along a row, and differences across two columns.
    let mut smoothed = [[0i32; SIDE - 2]; SIDE];
    let mut differences = [[0i32; SIDE - 2]; SIDE];
    for j in 0..SIDE {
        let row = &gray.row(y + j - RADIUS - 1)[x - RADIUS - 1..][..SIDE];
        for i in 0..SIDE - 2 {
            let [left, here, right] = [row[i], row[i + 1], row[i + 2]].map(i32::from);
            smoothed[j][i] = left + 2 * here + right;
            differences[j][i] = right - left;
        }
    }
    let (mut xx, mut xy, mut yy) = (0, 0, 0);
    for j in 0..SIDE - 2 {
        for i in 0..SIDE - 2 {
            let gx = differences[j][i] + 2 * differences[j + 1][i] + differences[j + 2][i];
            let gy = smoothed[j + 2][i] - smoothed[j][i];
            xx += gx * gx;
            xy += gx * gy;
            yy += gy * gy;
        }
    }
    let [xx, xy, yy] = [xx, xy, yy].map(f64::from);
    xx * yy - xy * xy - K * (xx + yy) * (xx + yy)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_are_above_edges_and_flat_parts() {
        let corner = Plane::from_fn(21, 21, |x, y| if x > 10 && y > 10 { 200 } else { 50 });
        let edge = Plane::from_fn(21, 21, |x, _| if x > 10 { 200 } else { 50 });
        assert!(response(&corner, 10, 10) > 0.0);
        assert!(response(&edge, 10, 10) < 0.0);
        assert_eq!(response(&Plane::filled(21, 21, 9), 10, 10), 0.0);
    }

    #[test]
    fn a_ramp_has_the_products_of_its_slopes() {
        // gx = 24 and gy = 40 at all 49 pixels: the determinant is 0 and the trace 49 (24² + 40²).
        let ramp = Plane::from_fn(21, 21, |x, y| (3 * x + 5 * y) as u8);
        let trace = 49.0 * f64::from(24 * 24 + 40 * 40);
        assert_eq!(response(&ramp, 10, 10), -K * trace * trace);
    }
}
