//! The sample order that turns a cosine transform into a Fourier transform of the same length.

/// Folded order on both axes of a plane: even samples forward, then odd samples backward. Fold a plane once for several
/// transforms.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Folding {
    width: usize,
    height: usize,
}

impl Folding {
    /// For planes of this size.
    #[must_use]
    pub fn new(width: usize, height: usize) -> Self {
        Self { width, height }
    }

    /// Copies a row-major plane in folded order.
    ///
    /// # Panics
    /// If a plane has another size.
    pub fn fold(&self, plane: &[f32], folded: &mut [f32]) {
        let size = self.width * self.height;
        assert_eq!([plane.len(), folded.len()], [size, size], "planes of {self:?}");
        for (place, line) in folded.chunks_exact_mut(self.width.max(1)).enumerate() {
            let row = &plane[self.row(place) * self.width..][..self.width];
            let (evens, odds) = line.split_at_mut(self.width.div_ceil(2));
            evens
                .iter_mut()
                .zip(row.iter().step_by(2))
                .for_each(|(to, &from)| *to = from);
            odds.iter_mut()
                .rev()
                .zip(row.iter().skip(1).step_by(2))
                .for_each(|(to, &from)| *to = from);
        }
    }

    /// The row at a position of the folded order.
    #[must_use]
    pub fn row(&self, place: usize) -> usize {
        if place < self.height.div_ceil(2) {
            2 * place
        } else {
            2 * (self.height - place) - 1
        }
    }

    /// Writes a folded row in natural order, mapped by `value`.
    pub fn unfold_row<T: Copy>(&self, line: &[T], value: impl Fn(T) -> f32, row: &mut [f32]) {
        let (evens, odds) = line.split_at(line.len().div_ceil(2));
        row.iter_mut()
            .step_by(2)
            .zip(evens)
            .for_each(|(to, &from)| *to = value(from));
        row.iter_mut()
            .skip(1)
            .step_by(2)
            .zip(odds.iter().rev())
            .for_each(|(to, &from)| *to = value(from));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn even_samples_go_forward_and_odd_ones_come_back() {
        let folding = Folding::new(5, 4);
        assert_eq!([0, 1, 2, 3].map(|place| folding.row(place)), [0, 2, 3, 1]);
        let plane: Vec<f32> = (0..20).map(|i| i as f32).collect();
        let mut folded = vec![0.0; 20];
        folding.fold(&plane, &mut folded);
        assert_eq!(folded[5..10], [10.0, 12.0, 14.0, 13.0, 11.0]);
        let mut row = [0.0; 5];
        folding.unfold_row(&folded[5..10], |v| v, &mut row);
        assert_eq!(row, plane[10..15]);
    }
}
