//! The phase function of Fournier and Forand for particles of a hyperbolic size distribution.

use std::f64::consts::PI;

/// Limits of the refractive index that [`FournierForand::of_backscatter`] looks in.
const INDEX: (f64, f64) = (1.0101, 1.35);

/// Fournier and Forand in the form of Fournier and Jonasz 1999.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FournierForand {
    /// Refractive index of the particles relative to water, above 1.
    pub index: f64,
    /// Slope of their size distribution, 3 to 5.
    pub slope: f64,
}

impl FournierForand {
    /// The law of a backscatter fraction b_b/b on the line `m = 3 + (n − 1.01)/0.1542` of Mobley, Sundman and Boss 2002; fractions
    /// beyond the line take its nearest end.
    #[must_use]
    pub fn of_backscatter(fraction: f64) -> Self {
        let on_line = |index: f64| Self {
            index,
            slope: 3.0 + (index - 1.01) / 0.1542,
        };
        let (mut low, mut high) = INDEX;
        // The error after sixty halvings is below the spacing of doubles.
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if on_line(middle).backscatter_fraction() < fraction {
                low = middle;
            } else {
                high = middle;
            }
        }
        on_line(0.5 * (low + high))
    }

    /// b_b/b by the closed form at 90 degrees.
    #[must_use]
    pub fn backscatter_fraction(&self) -> f64 {
        let nu = self.nu();
        let d = self.delta(1.0);
        let power = d.powf(nu);
        1.0 - (1.0 - power * d - 0.5 * (1.0 - power)) / ((1.0 - d) * power)
    }

    /// Share of the light scattered within an angle of `1 − cos = v`.
    #[must_use]
    pub fn within(&self, v: f64) -> f64 {
        if v <= 0.0 {
            return 0.0;
        }
        let nu = self.nu();
        let d = self.delta(v);
        let power = d.powf(nu);
        (1.0 - power * d - 0.5 * v * (1.0 - power)) / ((1.0 - d) * power)
            + self.tail() * (1.0 - v) * v * (2.0 - v)
    }

    /// K of the term `K (3 cos² − 1)` of the phase function, 1/sr, its rise toward 180°: with δ_π = 4/(3 (n − 1)²), `K = (1 −
    /// δ_π^ν)/(16 π (δ_π − 1) δ_π^ν)`. The integral of the term is 0 over the sphere, and over its backward half.
    #[must_use]
    pub fn rise(&self) -> f64 {
        self.tail() / (2.0 * PI)
    }

    fn tail(&self) -> f64 {
        let (nu, far) = (self.nu(), self.delta(2.0));
        (1.0 - far.powf(nu)) / (8.0 * (far - 1.0) * far.powf(nu))
    }

    fn nu(&self) -> f64 {
        0.5 * (3.0 - self.slope)
    }

    /// `δ = u²/(3 (n − 1)²)` with `u² = 4 sin²(θ/2) = 2 v`, moved off its removable singularity at 1.
    fn delta(&self, v: f64) -> f64 {
        let d = 2.0 * v / (3.0 * (self.index - 1.0).powi(2));
        if (d - 1.0).abs() < 1e-6 { 1.0 + 1e-6 } else { d }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_of_backscatter_fractions_has_its_published_places() {
        let places = [
            (0.005, 1.06638, 3.3656),
            (0.01, 1.08251, 3.4703),
            (0.0183, 1.09996, 3.5834),
            (0.03, 1.11716, 3.6949),
        ];
        for (fraction, index, slope) in places {
            let law = FournierForand::of_backscatter(fraction);
            assert!((law.index - index).abs() < 1e-5, "{fraction}: {law:?}");
            assert!((law.slope - slope).abs() < 1e-4, "{fraction}: {law:?}");
            assert!((1.0 - law.within(1.0) - fraction).abs() < 1e-9, "{fraction}");
            assert!((law.within(2.0) - 1.0).abs() < 1e-9, "{fraction}");
        }
    }
}
