//! The 5 × 5 median as a selection network over many columns.
//!
//! Each column of five is sorted once and serves the five windows that contain it. In a window the columns are sorted,
//! then each of the five ranks is sorted across the columns. The element of rank i among the ranks and j across then
//! has at least `i j - 1` others not above it and `(6 - i)(6 - j) - 1` not below it, which leaves 13 candidates for the
//! median; the smallest and the largest are dropped until one is left.

use imaging::{Plane, vectorized};

/// Columns per step: two vectors of 32 codes.
const BLOCK: usize = 64;
const RADIUS: usize = 2;

pub(super) fn median(picture: &Plane<u8>) -> Plane<u8> {
    vectorized!(sweep(picture))
}

#[inline(always)]
fn sweep(picture: &Plane<u8>) -> Plane<u8> {
    let (width, height) = picture.size();
    let line = width.div_ceil(BLOCK) * BLOCK + 2 * RADIUS;
    let mut columns = [const { Vec::new() }; 5];
    columns.fill(vec![0u8; line]);
    let mut medians = Vec::with_capacity(width * height);
    for y in 0..height {
        let rows = [0, 1, 2, 3, 4].map(|row| picture.row((y + row).saturating_sub(RADIUS).min(height - 1)));
        sort_columns(rows, &mut columns);
        for start in (0..width).step_by(BLOCK) {
            let block = window_medians(columns.each_ref().map(|rank| &rank[start..]));
            medians.extend_from_slice(&block[..BLOCK.min(width - start)]);
        }
    }
    Plane::new(width, height, medians).expect("one median for each pixel")
}

/// Orders pairs of elements in sequence.
macro_rules! order {
    ($v:ident: $(($low:literal, $high:literal))*) => {$(
        ($v[$low], $v[$high]) = ($v[$low].min($v[$high]), $v[$low].max($v[$high]));
    )*};
}

/// Five neighbors of each rank.
macro_rules! across {
    ($x:ident: $($rank:ident)*) => {
        [$([$rank[$x], $rank[$x + 1], $rank[$x + 2], $rank[$x + 3], $rank[$x + 4]]),*]
    };
}

#[inline(always)]
fn sort_five(mut v: [u8; 5]) -> [u8; 5] {
    order!(v: (0, 3)(1, 4) (0, 2)(1, 3) (0, 1)(2, 4) (1, 2)(3, 4) (2, 3));
    v
}

/// Writes the sorted columns of five rows rank by rank, with the border columns repeated twice.
#[inline(always)]
fn sort_columns(rows: [&[u8]; 5], columns: &mut [Vec<u8>; 5]) {
    let width = rows[0].len();
    let [p, q, r, s, t] = rows.map(|row| &row[..width]);
    let [a, b, c, d, e] = columns.each_mut().map(|rank| &mut rank[RADIUS..RADIUS + width]);
    for x in 0..width {
        [a[x], b[x], c[x], d[x], e[x]] = sort_five([p[x], q[x], r[x], s[x], t[x]]);
    }
    for rank in columns {
        let (first, last) = (rank[RADIUS], rank[RADIUS + width - 1]);
        rank[..RADIUS].fill(first);
        rank[RADIUS + width..].fill(last);
    }
}

/// The medians of `BLOCK` windows; `columns[rank]` starts two columns to the left of the first center.
#[inline(always)]
fn window_medians(columns: [&[u8]; 5]) -> [u8; BLOCK] {
    let [a, b, c, d, e] = columns.map(|rank| &rank[..BLOCK + 2 * RADIUS]);
    let mut medians = [0u8; BLOCK];
    for x in 0..BLOCK {
        medians[x] = select(across!(x: a b c d e));
    }
    medians
}

/// The median of 25, given five columns sorted down: `ranks[i][j]` is element i of column j.
#[inline(always)]
fn select(ranks: [[u8; 5]; 5]) -> u8 {
    let [a, b, c, d, e] = ranks;
    let [a, b, c, d, e] = [
        sort_five(a),
        sort_five(b),
        sort_five(c),
        sort_five(d),
        sort_five(e),
    ];
    let mut v = [
        a[3], a[4], b[2], b[3], b[4], c[1], c[2], c[3], d[0], d[1], d[2], e[0], e[1],
    ];
    // Among eight of the thirteen, neither the smallest nor the largest is the median; then among the remaining six and
    // the next…
    order!(v: (0, 7)(1, 6)(2, 5)(3, 4) (0, 1)(0, 2)(0, 3) (4, 7)(5, 7)(6, 7));
    order!(v: (1, 8)(2, 6)(3, 5) (1, 2)(1, 3)(1, 4) (5, 8)(6, 8)(4, 8));
    order!(v: (2, 9)(3, 6)(4, 5) (2, 3)(2, 4) (5, 9)(6, 9));
    order!(v: (3, 10)(4, 6) (3, 4)(3, 5) (5, 10)(6, 10));
    order!(v: (4, 11)(5, 6) (4, 5) (6, 11));
    order!(v: (5, 12)(5, 6)(6, 12));
    v[6]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A network of minima and maxima is correct for all codes if it is correct for zeros and ones (the 0-1 principle);
    /// sorted columns of zeros and ones are described by their number of ones.
    #[test]
    fn the_network_selects_the_thirteenth_of_twenty_five() {
        for case in 0..6usize.pow(5) {
            let ones: [usize; 5] = std::array::from_fn(|column| case / 6usize.pow(column as u32) % 6);
            let ranks = std::array::from_fn(|rank| ones.map(|ones| u8::from(rank + ones >= 5)));
            assert_eq!(
                select(ranks),
                u8::from(ones.iter().sum::<usize>() >= 13),
                "{ones:?}"
            );
        }
    }

    #[test]
    fn five_of_zeros_and_ones_are_sorted() {
        for bits in 0..32u8 {
            let sorted = sort_five(std::array::from_fn(|i| bits >> i & 1));
            assert!(sorted.is_sorted(), "{bits:05b}");
        }
    }
}
