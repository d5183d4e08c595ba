//! Polynomials in x, y and z up to the third degree.

/// Exponents of x, y and z of the twenty monomials. The first ten are eliminated by the five-point method, in the order of
/// Nistér; the others are x, y and 1 times powers of z.
const MONOMIALS: [[u8; 3]; 20] = [
    [3, 0, 0],
    [0, 3, 0],
    [2, 1, 0],
    [1, 2, 0],
    [2, 0, 1],
    [2, 0, 0],
    [0, 2, 1],
    [0, 2, 0],
    [1, 1, 1],
    [1, 1, 0],
    [1, 0, 2],
    [1, 0, 1],
    [1, 0, 0],
    [0, 1, 2],
    [0, 1, 1],
    [0, 1, 0],
    [0, 0, 3],
    [0, 0, 2],
    [0, 0, 1],
    [0, 0, 0],
];

/// Indices of the monomials of a linear and of a quadratic polynomial: x, y, z, 1 and x², y², xy, xz, yz, z², x, y, z, 1.
const LINEAR: [usize; 4] = [12, 15, 18, 19];
const QUADRATIC: [usize; 10] = [5, 7, 9, 11, 14, 17, 12, 15, 18, 19];

/// `a x + b y + c z + d`.
pub(crate) type Linear = [f64; 4];
/// Coefficients in the order of x², y², xy, xz, yz, z², x, y, z, 1.
pub(crate) type Quadratic = [f64; 10];
/// Coefficients of the twenty monomials.
pub(crate) type Cubic = [f64; 20];

/// Position in `among` of the product of two monomials.
const fn find_product(one: usize, other: usize, among: &[usize]) -> usize {
    let (a, b) = (MONOMIALS[one], MONOMIALS[other]);
    let mut i = 0;
    loop {
        let c = MONOMIALS[among[i]];
        if c[0] == a[0] + b[0] && c[1] == a[1] + b[1] && c[2] == a[2] + b[2] {
            return i;
        }
        i += 1;
    }
}

const ALL: [usize; 20] = {
    let mut all = [0; 20];
    let mut i = 0;
    while i < 20 {
        all[i] = i;
        i += 1;
    }
    all
};

/// Where the product of each pair of monomials belongs.
const LINEAR_BY_LINEAR: [[usize; 4]; 4] = {
    let mut table = [[0; 4]; 4];
    let mut i = 0;
    while i < 16 {
        table[i / 4][i % 4] = find_product(LINEAR[i / 4], LINEAR[i % 4], &QUADRATIC);
        i += 1;
    }
    table
};
const QUADRATIC_BY_LINEAR: [[usize; 4]; 10] = {
    let mut table = [[0; 4]; 10];
    let mut i = 0;
    while i < 40 {
        table[i / 4][i % 4] = find_product(QUADRATIC[i / 4], LINEAR[i % 4], &ALL);
        i += 1;
    }
    table
};

/// Adds `factor a b`.
pub(crate) fn add_linear_product(sum: &mut Quadratic, factor: f64, a: &Linear, b: &Linear) {
    for i in 0..4 {
        for j in 0..4 {
            sum[LINEAR_BY_LINEAR[i][j]] += factor * a[i] * b[j];
        }
    }
}

/// Adds `factor a b`.
pub(crate) fn add_product(sum: &mut Cubic, factor: f64, a: &Quadratic, b: &Linear) {
    for i in 0..10 {
        for j in 0..4 {
            sum[QUADRATIC_BY_LINEAR[i][j]] += factor * a[i] * b[j];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn evaluate(coefficients: &[f64], monomials: &[usize], point: [f64; 3]) -> f64 {
        let power = |&monomial: &usize| -> f64 {
            let exponents = MONOMIALS[monomial].map(i32::from);
            (0..3).map(|axis| point[axis].powi(exponents[axis])).product()
        };
        coefficients
            .iter()
            .zip(monomials)
            .map(|(c, monomial)| c * power(monomial))
            .sum()
    }

    #[test]
    fn products_of_polynomials_have_the_product_of_their_values() {
        let (a, b, c) = (
            [1.0, -2.0, 0.5, 3.0],
            [0.3, 4.0, -1.0, 0.7],
            [-2.0, 0.1, 1.5, -0.4],
        );
        let point = [0.7, -1.3, 2.1];
        let [a_value, b_value, c_value] = [a, b, c].map(|p| evaluate(&p, &LINEAR, point));
        let mut quadratic = [0.0; 10];
        add_linear_product(&mut quadratic, 2.0, &a, &b);
        assert!((evaluate(&quadratic, &QUADRATIC, point) - 2.0 * a_value * b_value).abs() < 1e-12);
        let mut cubic = [0.0; 20];
        add_product(&mut cubic, -1.0, &quadratic, &c);
        assert!((evaluate(&cubic, &ALL, point) + 2.0 * a_value * b_value * c_value).abs() < 1e-12);
    }
}
