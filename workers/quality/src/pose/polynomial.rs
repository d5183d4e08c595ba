//! Real roots of polynomials in one unknown.

/// Largest degree.
const DEGREE: usize = 10;
/// Steps of a search: bisection alone reaches the resolution of f64.
const STEPS: usize = 64;

/// Coefficients, the constant first.
pub(crate) type Polynomial = [f64; DEGREE + 1];

/// The real roots of odd order, where the sign changes. Those beyond ±1 are the inverse roots of the polynomial with
/// its coefficients reversed, so all are found within -1..=1.
pub(crate) fn find_roots(polynomial: &Polynomial) -> Vec<f64> {
    let mut roots = find_small_roots(polynomial);
    let mut reversed = *polynomial;
    let degree = polynomial
        .iter()
        .rposition(|&coefficient| coefficient != 0.0)
        .unwrap_or(0);
    reversed[..=degree].reverse();
    let large = find_small_roots(&reversed).into_iter();
    roots.extend(
        large
            .filter(|root| root.abs() > 0.0 && root.abs() < 1.0)
            .map(|root| 1.0 / root),
    );
    roots
}

/// The roots in -1..=1, from the smallest. Between neighboring roots of its derivative a polynomial has at most one.
fn find_small_roots(polynomial: &Polynomial) -> Vec<f64> {
    // All derivatives, scaled by the factorial of their order.
    let mut derivatives = vec![*polynomial];
    for _ in 0..DEGREE {
        let last = derivatives[derivatives.len() - 1];
        derivatives.push(differentiate(&last));
    }
    let mut roots = Vec::new();
    for order in (0..DEGREE).rev() {
        let (function, slope) = (&derivatives[order], &derivatives[order + 1]);
        let mut ends = vec![-1.0];
        ends.append(&mut roots);
        ends.push(1.0);
        for pair in ends.windows(2) {
            roots.extend(find_root(function, slope, pair[0], pair[1]));
        }
    }
    roots
}

fn differentiate(polynomial: &Polynomial) -> Polynomial {
    let mut derivative = [0.0; DEGREE + 1];
    for power in 1..=DEGREE {
        derivative[power - 1] = power as f64 * polynomial[power];
    }
    derivative
}

fn evaluate(polynomial: &Polynomial, x: f64) -> f64 {
    polynomial
        .iter()
        .rev()
        .fold(0.0, |sum, coefficient| sum * x + coefficient)
}

/// The root between two ends of different sign: Newton's steps, or halves where these leave the bracket.
fn find_root(function: &Polynomial, slope: &Polynomial, mut low: f64, mut high: f64) -> Option<f64> {
    let (at_low, at_high) = (evaluate(function, low), evaluate(function, high));
    if (at_low < 0.0) == (at_high < 0.0) {
        return None;
    }
    let mut x = 0.5 * (low + high);
    for _ in 0..STEPS {
        let value = evaluate(function, x);
        if (value < 0.0) == (at_low < 0.0) {
            low = x;
        } else {
            high = x;
        }
        let newton = x - value / evaluate(slope, x);
        let next = if low < newton && newton < high {
            newton
        } else {
            0.5 * (low + high)
        };
        if (next - x).abs() <= f64::EPSILON * x.abs() || low + f64::EPSILON > high {
            break;
        }
        x = next;
    }
    Some(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with_roots(roots: &[f64], factor: f64) -> Polynomial {
        let mut polynomial = [0.0; DEGREE + 1];
        polynomial[0] = factor;
        for root in roots {
            for power in (0..=DEGREE).rev() {
                let below = if power > 0 { polynomial[power - 1] } else { 0.0 };
                polynomial[power] = below - root * polynomial[power];
            }
        }
        polynomial
    }

    #[test]
    fn known_roots_are_found_inside_and_outside_of_the_unit_interval() {
        for expected in [
            vec![-120.0, -3.0, -0.9, -0.1, 0.05, 0.7, 1.5, 8.0, 40.0, 300.0],
            vec![0.25],
            vec![-0.5, 0.5, 2.0],
        ] {
            let mut roots = find_roots(&with_roots(&expected, -3.7));
            roots.sort_by(f64::total_cmp);
            assert_eq!(roots.len(), expected.len(), "{roots:?}");
            for (root, expected) in roots.iter().zip(expected) {
                assert!(
                    (root - expected).abs() < 1e-9 * expected.abs().max(1.0),
                    "{roots:?}"
                );
            }
        }
    }

    #[test]
    fn complex_roots_constants_and_zero_have_none() {
        // (x² + 1)(x² + 4).
        let mut complex = [0.0; DEGREE + 1];
        (complex[0], complex[2], complex[4]) = (4.0, 5.0, 1.0);
        assert!(find_roots(&complex).is_empty());
        assert!(find_roots(&[0.0; DEGREE + 1]).is_empty());
        assert!(find_roots(&with_roots(&[], 2.0)).is_empty());
    }
}
