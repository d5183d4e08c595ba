//! Compiles loops for the vector instructions of the current CPU. Each call checks for cancellation.

use pulp::{Arch, Simd, WithSimd};

use crate::cancel;

/// Compiles the inlined code of an expression for the vector instructions of this CPU; see [`vectorize`].
#[macro_export]
macro_rules! vectorized {
    ($work:expr) => {
        $crate::simd::vectorize(
            #[inline(always)]
            || $work,
        )
    };
}

/// Runs a loop with the widest vector instructions of this CPU. Put the loop into an `#[inline(always)]` function of
/// slices and plain values, and call it from an `#[inline(always)]` closure: only inlined code is recompiled, and
/// captured variables are reloaded in every step, which keeps a loop scalar. Rust never fuses multiplications and
/// additions, so the result does not depend on the CPU.
#[inline(always)]
pub fn vectorize<R>(work: impl FnMut() -> R) -> R {
    cancel::check();
    Arch::new().dispatch(VectorWork(work))
}

/// The larger of two values; `max` takes extra instructions for NaN.
#[inline(always)]
pub fn larger<T: PartialOrd>(a: T, b: T) -> T {
    if a > b { a } else { b }
}

/// The smaller of two values; `min` takes extra instructions for NaN.
#[inline(always)]
pub fn smaller<T: PartialOrd>(a: T, b: T) -> T {
    if a < b { a } else { b }
}

/// A plain closure would be called through a shim compiled without the instructions.
struct VectorWork<F>(F);

impl<R, F: FnMut() -> R> WithSimd for VectorWork<F> {
    type Output = R;

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) -> R {
        (self.0)()
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_loop_gives_the_same_bits_as_without() {
        let plain: Vec<f32> = (0..1000).map(|i| (i as f32).sqrt() * 0.1 + 0.7).collect();
        let mut wide = vec![0.0f32; 1000];
        vectorized!({
            for (i, value) in wide.iter_mut().enumerate() {
                *value = (i as f32).sqrt() * 0.1 + 0.7;
            }
        });
        assert_eq!(wide, plain);
    }
}
