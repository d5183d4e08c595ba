//! Distortion after Brown (1966) and Conrady (1919).

use spec::Distortion;

/// Brown and Conrady's map from ideal to distorted coordinates:
/// `x R + 2 p1 x y + p2 (r² + 2x²)`, `y R + p1 (r² + 2y²) + 2 p2 x y` with `R = 1 + k1 r² + k2 r⁴ + k3 r⁶`.
#[inline(always)]
pub(super) fn distorted(d: &Distortion, x: f64, y: f64) -> (f64, f64) {
    let r2 = x * x + y * y;
    let radial = 1.0 + r2 * (d.k1 + r2 * (d.k2 + r2 * d.k3));
    (
        x * radial + 2.0 * d.p1 * x * y + d.p2 * (r2 + 2.0 * x * x),
        y * radial + d.p1 * (r2 + 2.0 * y * y) + 2.0 * d.p2 * x * y,
    )
}

/// The derivatives of [`distorted`]: those of its x and of its y, by x and by y.
pub(super) fn jacobian(d: &Distortion, x: f64, y: f64) -> [[f64; 2]; 2] {
    let r2 = x * x + y * y;
    let radial = 1.0 + r2 * (d.k1 + r2 * (d.k2 + r2 * d.k3));
    // Of the radial factor by r².
    let growth = d.k1 + r2 * (2.0 * d.k2 + r2 * 3.0 * d.k3);
    let mixed = 2.0 * (x * y * growth + d.p1 * x + d.p2 * y);
    [
        [
            radial + 2.0 * x * x * growth + 2.0 * d.p1 * y + 6.0 * d.p2 * x,
            mixed,
        ],
        [
            mixed,
            radial + 2.0 * y * y * growth + 6.0 * d.p1 * y + 2.0 * d.p2 * x,
        ],
    ]
}

/// The lens of tests.
#[cfg(test)]
pub(super) const BARREL: Distortion = Distortion {
    k1: -0.12,
    k2: 0.03,
    k3: 0.0,
    p1: 0.002,
    p2: -0.001,
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jacobian_is_the_limit_of_differences() {
        const STEP: f64 = 1e-6;
        let (x, y) = (0.4, -0.7);
        let [[xx, xy], [yx, yy]] = jacobian(&BARREL, x, y);
        let [east, west] = [STEP, -STEP].map(|step| distorted(&BARREL, x + step, y));
        let [south, north] = [STEP, -STEP].map(|step| distorted(&BARREL, x, y + step));
        let slope = |after: f64, before: f64| (after - before) / (2.0 * STEP);
        let differences = [
            slope(east.0, west.0) - xx,
            slope(south.0, north.0) - xy,
            slope(east.1, west.1) - yx,
            slope(south.1, north.1) - yy,
        ];
        assert!(
            differences.iter().all(|difference| difference.abs() < 1e-8),
            "{differences:?}"
        );
    }
}
