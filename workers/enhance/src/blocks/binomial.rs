//! Binomial blur with 5 × 5 taps, `(1, 4, 6, 4, 1) / 16` along both axes, with replicated borders: close to a Gaussian
//! of one pixel, with weights that are exact in binary.

use imaging::{Plane, vectorized};

/// The weights of a pixel, of its neighbors and of theirs.
const WEIGHTS: [f32; 3] = [6.0 / 16.0, 4.0 / 16.0, 1.0 / 16.0];
/// Pixels on either side of the window's center.
const RADIUS: usize = 2;

/// The blurred plane, in single precision.
#[must_use]
pub fn binomial(plane: &Plane<f32>) -> Plane<f32> {
    let mut blurred = Plane::filled(plane.width(), plane.height(), 0.0);
    let mut line = vec![0.0; plane.width() + 2 * RADIUS];
    for y in 0..plane.height() {
        vectorized!(blurred_row(plane, y, &mut line, blurred.row_mut(y)));
    }
    blurred
}

/// One row of the blurred plane; `line` is scratch space, four samples longer than the row.
#[inline(always)]
pub(crate) fn blurred_row(plane: &Plane<f32>, y: usize, line: &mut [f32], blurred: &mut [f32]) {
    blend_rows(plane, y, line);
    let n = blurred.len();
    let taps = line[..n]
        .iter()
        .zip(&line[1..=n])
        .zip(&line[2..n + 2])
        .zip(line[3..n + 3].iter().zip(&line[4..n + 4]));
    for (to, (((a, b), c), (d, e))) in blurred.iter_mut().zip(taps) {
        *to = weighted([*a, *b, *c, *d, *e]);
    }
}

/// Five rows around row `y` blended into one, at `line[2..]`, with its border replicated by two samples on either side.
#[inline(always)]
pub(crate) fn blend_rows(plane: &Plane<f32>, y: usize, line: &mut [f32]) {
    let (width, height) = plane.size();
    let last = height - 1;
    let [a, b, c, d, e] = [
        plane.row(y.saturating_sub(2)),
        plane.row(y.saturating_sub(1)),
        plane.row(y),
        plane.row((y + 1).min(last)),
        plane.row((y + 2).min(last)),
    ];
    let taps = a.iter().zip(b).zip(c).zip(d.iter().zip(e));
    for (to, (((a, b), c), (d, e))) in line[RADIUS..].iter_mut().zip(taps) {
        *to = weighted([*a, *b, *c, *d, *e]);
    }
    let (first, last) = (line[RADIUS], line[width + RADIUS - 1]);
    line[..RADIUS].fill(first);
    line[width + RADIUS..].fill(last);
}

#[inline(always)]
pub(crate) fn weighted([a, b, c, d, e]: [f32; 5]) -> f32 {
    WEIGHTS[0] * c + WEIGHTS[1] * (b + d) + WEIGHTS[2] * (a + e)
}

/// The definition: the sum over the 25 taps.
#[must_use]
pub fn binomial_exact(plane: &Plane<f64>) -> Plane<f64> {
    let (width, height) = plane.size();
    let taps: Vec<(usize, f64)> = (0..=2 * RADIUS)
        .map(|i| (i, f64::from(WEIGHTS[i.abs_diff(RADIUS)])))
        .collect();
    Plane::from_fn(width, height, |x, y| {
        let rows = taps.iter().map(|&(j, down)| {
            let row = plane.row((y + j).saturating_sub(RADIUS).min(height - 1));
            let across = taps
                .iter()
                .map(|&(i, across)| across * row[(x + i).saturating_sub(RADIUS).min(width - 1)]);
            down * across.sum::<f64>()
        });
        rows.sum()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_impulse_becomes_the_window() {
        let impulse = Plane::from_fn(9, 7, |x, y| if (x, y) == (4, 3) { 256.0f32 } else { 0.0 });
        let blurred = binomial(&impulse);
        assert_eq!(&blurred.row(3)[2..7], &[6.0, 24.0, 36.0, 24.0, 6.0]);
        assert_eq!(&blurred.row(1)[2..7], &[1.0, 4.0, 6.0, 4.0, 1.0]);
        assert_eq!(
            blurred.map(|&value| f64::from(value)),
            binomial_exact(&impulse.map(|&value| f64::from(value)))
        );
    }

    #[test]
    fn the_border_is_replicated() {
        let plane = Plane::new(2, 1, vec![0.0f32, 16.0]).unwrap();
        assert_eq!(binomial(&plane).data(), &[5.0, 11.0]);
        assert_eq!(binomial(&Plane::filled(1, 1, 0.3f32)).data(), &[0.3]);
    }
}
