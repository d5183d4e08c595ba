//! Legendre polynomials, and nodes and weights of Gauss–Legendre quadrature.

/// The nodes `x` and weights `w` on −1..=1 of the rule that integrates polynomials of degree 2n − 1 exactly, from the largest
/// node to the smallest: the roots of the Legendre polynomial P_n by Newton's method, `w = 2 / ((1 − x²) P_n'(x)²)`.
#[must_use]
pub fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    let mut rule: Vec<(f64, f64)> = (0..n.div_ceil(2)).map(|i| node(i, n)).collect();
    let mirrored: Vec<(f64, f64)> = rule[..n / 2].iter().rev().map(|&(x, w)| (-x, w)).collect();
    rule.extend(mirrored);
    rule
}

fn node(i: usize, n: usize) -> (f64, f64) {
    let degree = n as f64;
    let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (degree + 0.5)).cos();
    let mut slope = 1.0;
    // Newton's method doubles the digits in each step; from this start four steps suffice.
    for _ in 0..8 {
        let before = x;
        let (mut below, mut value) = (1.0, x);
        for k in 2..=n {
            let k = k as f64;
            (below, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * below) / k);
        }
        slope = degree * (x * value - below) / (x * x - 1.0);
        x -= value / slope;
        if x == before {
            break;
        }
    }
    (x, 2.0 / ((1.0 - x * x) * slope * slope))
}

/// `P_0 … P_{N − 1}` at a point of −1..=1; N is at least 2.
pub(crate) fn legendre_values<const N: usize>(x: f64) -> [f64; N] {
    let mut values = [1.0; N];
    values[1] = x;
    for l in 2..N {
        let degree = l as f64;
        values[l] = ((2.0 * degree - 1.0) * x * values[l - 1] - (degree - 1.0) * values[l - 2]) / degree;
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rule_of_n_nodes_is_exact_up_to_degree_2n_minus_1() {
        for n in [1, 2, 3, 8, 24, 64, 128] {
            let rule = gauss_legendre(n);
            for degree in [0, 2 * (n - 1)] {
                let sum: f64 = rule.iter().map(|(x, w)| w * x.powi(degree as i32)).sum();
                let expected = 2.0 / (degree as f64 + 1.0);
                assert!(
                    (sum - expected).abs() < 1e-12,
                    "{n} nodes, degree {degree}: {sum}"
                );
            }
            let next: f64 = rule.iter().map(|(x, w)| w * x.powi(2 * n as i32)).sum();
            assert!(n > 20 || (next - 2.0 / (2.0 * n as f64 + 1.0)).abs() > 1e-12);
        }
    }
}
