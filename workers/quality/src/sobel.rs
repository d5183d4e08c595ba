//! The 3 × 3 Sobel derivatives of one channel, weights 1 2 1, not scaled.

use imaging::Plane;

/// Extension beyond the border.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Border {
    /// The edge pixel.
    Replicate,
    /// The pixel next to the edge pixel; the edge pixel if there is no other.
    Reflect,
}

/// Buffers for one row of derivatives.
pub(crate) struct Sobel<'a> {
    channel: &'a Plane<u8>,
    border: Border,
    /// Column sums with weights 1 2 1, and column differences, with one more column on each side.
    smoothed: Vec<i16>,
    differences: Vec<i16>,
}

impl<'a> Sobel<'a> {
    pub(crate) fn new(channel: &'a Plane<u8>, border: Border) -> Self {
        let line = vec![0; channel.width() + 2];
        Self {
            channel,
            border,
            smoothed: line.clone(),
            differences: line,
        }
    }

    /// Writes the derivatives along x and along y of the first pixels of row `y`.
    #[inline(always)]
    pub(crate) fn row(&mut self, y: usize, gx: &mut [i16], gy: &mut [i16]) {
        let (width, height) = self.channel.size();
        let (before, after) = self.neighbors(y, height);
        let rows = self
            .channel
            .row(before)
            .iter()
            .zip(self.channel.row(y))
            .zip(self.channel.row(after));
        let sums = self.smoothed[1..].iter_mut().zip(&mut self.differences[1..]);
        for (((&above, &here), &below), (smoothed, difference)) in rows.zip(sums) {
            *smoothed = i16::from(above) + 2 * i16::from(here) + i16::from(below);
            *difference = i16::from(below) - i16::from(above);
        }
        let (first, _) = self.neighbors(0, width);
        let (_, last) = self.neighbors(width - 1, width);
        for line in [&mut self.smoothed, &mut self.differences] {
            line[0] = line[first + 1];
            line[width + 1] = line[last + 1];
        }
        let count = gx.len();
        let (left, right) = (&self.smoothed[..count], &self.smoothed[2..count + 2]);
        for ((gx, &left), &right) in gx.iter_mut().zip(left).zip(right) {
            *gx = right - left;
        }
        let lines = self
            .differences
            .iter()
            .zip(&self.differences[1..])
            .zip(&self.differences[2..]);
        for (gy, ((&left, &here), &right)) in gy.iter_mut().zip(lines) {
            *gy = left + 2 * here + right;
        }
    }

    /// The samples before and after sample `i` of `n`.
    #[inline(always)]
    fn neighbors(&self, i: usize, n: usize) -> (usize, usize) {
        let (beyond_first, beyond_last) = match self.border {
            Border::Replicate => (0, n - 1),
            Border::Reflect => (1.min(n - 1), n.saturating_sub(2)),
        };
        (
            i.checked_sub(1).unwrap_or(beyond_first),
            if i + 1 < n { i + 1 } else { beyond_last },
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn derivatives(channel: &Plane<u8>, border: Border, y: usize) -> (Vec<i16>, Vec<i16>) {
        let (mut gx, mut gy) = (vec![0; channel.width()], vec![0; channel.width()]);
        Sobel::new(channel, border).row(y, &mut gx, &mut gy);
        (gx, gy)
    }

    #[test]
    fn a_ramp_has_eight_times_its_slope_inside() {
        let ramp = Plane::from_fn(5, 5, |x, y| (3 * x + 7 * y) as u8);
        let (gx, gy) = derivatives(&ramp, Border::Replicate, 2);
        assert_eq!((gx[2], gy[2]), (24, 56));
        // At the replicated edge the difference spans one step instead of two.
        assert_eq!((gx[0], gx[4]), (12, 12));
        assert_eq!(derivatives(&ramp, Border::Replicate, 0).1[2], 28);
    }

    #[test]
    fn across_a_reflected_edge_the_derivative_vanishes() {
        let ramp = Plane::from_fn(5, 5, |x, y| (3 * x + 7 * y) as u8);
        let (gx, gy) = derivatives(&ramp, Border::Reflect, 0);
        assert_eq!((gx[0], gx[4]), (0, 0));
        assert_eq!(gy, [0; 5]);
    }

    #[test]
    fn one_pixel_has_no_slope() {
        for border in [Border::Replicate, Border::Reflect] {
            assert_eq!(
                derivatives(&Plane::filled(1, 1, 200), border, 0),
                (vec![0], vec![0])
            );
        }
    }
}
