//! Bins of equal width.

/// Bins of equal width; one of them begins at 0. If the width has few decimals, the edges are the doubles nearest to the decimal
/// numbers: 0.3, not 3 · 0.1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bins {
    numerator: f64,
    denominator: f64,
}

/// Most decimals of a width whose edges are decimal: powers of ten that are exact.
const MOST_DECIMALS: usize = 15;

impl Bins {
    /// Bins of a width above 0.
    #[must_use]
    pub fn new(width: f64) -> Self {
        let text = width.to_string();
        let decimals = text.split_once('.').map_or(0, |(_, decimals)| decimals.len());
        if decimals > MOST_DECIMALS {
            return Self {
                numerator: width,
                denominator: 1.0,
            };
        }
        let denominator = 10f64.powi(decimals as i32);
        Self {
            numerator: (width * denominator).round(),
            denominator,
        }
    }

    fn edge(&self, bin: f64) -> f64 {
        bin * self.numerator / self.denominator + 0.0
    }

    /// Estimate of the bin that contains a number; rounding may shift it by one.
    pub(crate) fn about(&self, number: f64) -> i64 {
        (number * self.denominator / self.numerator) as i64
    }

    /// The edge behind that of a bin, unless the bin is so far from 0 that its number is not certain.
    pub(crate) fn upper_edge(&self, lower_edge: f64) -> Option<f64> {
        const MOST: f64 = 1e12;
        let bin = (lower_edge * self.denominator / self.numerator).round();
        (bin.abs() < MOST).then(|| self.edge(bin + 1.0))
    }

    /// The edge of the bin that holds a number: edge ≤ number < next edge.
    #[must_use]
    pub fn lower_edge(&self, number: f64) -> f64 {
        let bin = (number / (self.numerator / self.denominator)).floor();
        // The division may round across an edge.
        if self.edge(bin) > number {
            self.edge(bin - 1.0)
        } else if self.edge(bin + 1.0) <= number {
            self.edge(bin + 1.0)
        } else {
            self.edge(bin)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_in_the_bin_between_the_edges_that_are_returned() {
        for width in [0.1, 0.25, 3.0, 1e-20, 1e300, 0.007, 1.0 / 3.0] {
            let bins = Bins::new(width);
            for step in -2000..2000 {
                let number = f64::from(step) * width / 7.0;
                let low = bins.lower_edge(number);
                let bin = (low / width).round();
                assert!(
                    low <= number && number < bins.edge(bin + 1.0),
                    "{number} at {low} of {width}"
                );
            }
        }
        let tenths = Bins::new(0.1);
        for (number, edge) in [
            (0.3, 0.3),
            (0.29, 0.2),
            (0.7, 0.7),
            (-0.05, -0.1),
            (0.0, 0.0),
            (1.1, 1.1),
        ] {
            assert_eq!(tenths.lower_edge(number), edge, "{number}");
        }
    }
}
