//! Steps between a Fourier and a cosine transform, on numbers k and N−k, with the twiddle factor w of k.
//!
//! ```text
//! forward: X[k] = ½(w V[k] + w̄ V[N−k])      X[N−k] = ½i (w V[k] − w̄ V[N−k])
//! inverse: V[k] = w̄ (X[k] − i X[N−k])       V[N−k] = w (X[k] + i X[N−k])
//! ```
//!
//! A chunk holds real and imaginary parts, and a product with i swaps neighbors. The compiler does not vectorize loops over complex
//! numbers.

use pulp::bytemuck::{cast_slice, cast_slice_mut};

use super::Direction;
use crate::fft::Complex;

/// Real and imaginary parts of eight numbers: a vector of AVX-512.
const CHUNK: usize = 16;
/// The sign of `i z` in its parts.
const TURN: [f32; CHUNK] = alternating(-1.0, 1.0);

type Chunk = [f32; CHUNK];

const fn alternating(even: f32, odd: f32) -> Chunk {
    let mut chunk = [even; CHUNK];
    let mut i = 1;
    while i < CHUNK {
        chunk[i] = odd;
        i += 2;
    }
    chunk
}

/// Real and imaginary parts of eight twiddle factors, each at both places of its number.
#[derive(Clone, Copy)]
struct Twiddles {
    re: Chunk,
    im: Chunk,
}

impl Twiddles {
    #[inline(always)]
    fn new(parts: &Chunk, factor: f32) -> Self {
        let mut twiddles = Self {
            re: [0.0; CHUNK],
            im: [0.0; CHUNK],
        };
        for i in 0..CHUNK {
            twiddles.re[i] = factor * parts[i & !1];
            twiddles.im[i] = factor * parts[i | 1];
        }
        twiddles
    }

    /// `w z`, or `w̄ z` with the sign −1.
    #[inline(always)]
    fn times(&self, z: &Chunk, sign: f32) -> Chunk {
        let turned = turned(z);
        let mut product = [0.0; CHUNK];
        for i in 0..CHUNK {
            product[i] = self.re[i] * z[i] + sign * (self.im[i] * turned[i]);
        }
        product
    }
}

/// `i z`.
#[inline(always)]
fn turned(z: &Chunk) -> Chunk {
    let mut turned = [0.0; CHUNK];
    for i in 0..CHUNK {
        turned[i] = TURN[i] * z[i ^ 1];
    }
    turned
}

#[inline(always)]
fn forward(twiddles: &Twiddles, one: &mut Chunk, other: &mut Chunk) {
    let (a, b) = (twiddles.times(one, 1.0), twiddles.times(other, -1.0));
    let mut difference = [0.0; CHUNK];
    for i in 0..CHUNK {
        one[i] = a[i] + b[i];
        difference[i] = a[i] - b[i];
    }
    *other = turned(&difference);
}

#[inline(always)]
fn inverse(twiddles: &Twiddles, one: &mut Chunk, other: &mut Chunk) {
    let turned = turned(other);
    let [mut less, mut more] = [[0.0; CHUNK]; 2];
    for i in 0..CHUNK {
        less[i] = one[i] - turned[i];
        more[i] = one[i] + turned[i];
    }
    *one = twiddles.times(&less, -1.0);
    *other = twiddles.times(&more, 1.0);
}

#[inline(always)]
fn step(direction: Direction, twiddles: &Twiddles, one: &mut Chunk, other: &mut Chunk) {
    match direction {
        Direction::Forward => forward(twiddles, one, other),
        Direction::Inverse => inverse(twiddles, one, other),
    }
}

/// The factor of the twiddles.
fn scale(direction: Direction) -> f32 {
    match direction {
        Direction::Forward => 0.5,
        Direction::Inverse => 1.0,
    }
}

/// Joins two lines with one twiddle factor.
#[inline(always)]
pub(super) fn across(
    direction: Direction,
    twiddle: Complex<f32>,
    one: &mut [Complex<f32>],
    other: &mut [Complex<f32>],
) {
    let factor = scale(direction);
    let twiddles = Twiddles::new(&pairs([twiddle; CHUNK / 2]), factor);
    let (ones, last_one) = cast_slice_mut::<_, f32>(one).as_chunks_mut::<CHUNK>();
    let (others, last_other) = cast_slice_mut::<_, f32>(other).as_chunks_mut::<CHUNK>();
    for (one, other) in ones.iter_mut().zip(others) {
        step(direction, &twiddles, one, other);
    }
    if !last_one.is_empty() {
        let [mut one, mut other] = [&*last_one, &*last_other].map(|last| {
            let mut chunk = [0.0; CHUNK];
            chunk[..last.len()].copy_from_slice(last);
            chunk
        });
        step(direction, &twiddles, &mut one, &mut other);
        last_one.copy_from_slice(&one[..last_one.len()]);
        last_other.copy_from_slice(&other[..last_other.len()]);
    }
}

/// Joins the number N/2, its mirror being itself.
#[inline(always)]
pub(super) fn middle(direction: Direction, twiddle: Complex<f32>, line: &mut [Complex<f32>]) {
    for value in line {
        let mut mirrored = [*value];
        across(direction, twiddle, std::slice::from_mut(value), &mut mirrored);
    }
}

/// Joins the numbers k and N−k of a line, k = 1 … N/2; number 0 is unchanged.
#[inline(always)]
pub(super) fn along(direction: Direction, twiddles: &[Complex<f32>], line: &mut [Complex<f32>]) {
    let (count, half) = (line.len(), CHUNK / 2);
    let factor = scale(direction);
    let pairs_end = count.div_ceil(2);
    let mut k = 1;
    if pairs_end > 1 {
        let (low, high) = line.split_at_mut(count + 1 - pairs_end);
        while k + half <= pairs_end {
            let end = high.len() + 1 - k;
            let one: &mut Chunk = chunk(&mut low[k..k + half]);
            let other: &mut Chunk = chunk(&mut high[end - half..end]);
            let parts = cast_slice(&twiddles[k..k + half])
                .try_into()
                .expect("eight numbers");
            let twiddles = Twiddles::new(parts, factor);
            let mut turned = reversed(other);
            step(direction, &twiddles, one, &mut turned);
            *other = reversed(&turned);
            k += half;
        }
        for k in k..pairs_end {
            let end = high.len() + 1 - k;
            across(direction, twiddles[k], &mut low[k..=k], &mut high[end - 1..end]);
        }
    }
    if count > 1 && count.is_multiple_of(2) {
        middle(direction, twiddles[count / 2], &mut line[count / 2..=count / 2]);
    }
}

#[inline(always)]
fn chunk(numbers: &mut [Complex<f32>]) -> &mut Chunk {
    cast_slice_mut(numbers).try_into().expect("eight numbers")
}

#[inline(always)]
fn pairs(numbers: [Complex<f32>; CHUNK / 2]) -> Chunk {
    cast_slice::<_, f32>(&numbers).try_into().expect("eight numbers")
}

/// Numbers in reverse order.
#[inline(always)]
fn reversed(chunk: &Chunk) -> Chunk {
    let mut reversed = [0.0; CHUNK];
    for i in 0..CHUNK {
        reversed[i] = chunk[CHUNK - 2 - (i & !1) + (i & 1)];
    }
    reversed
}
