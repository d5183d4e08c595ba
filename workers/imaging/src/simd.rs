//! Loops compiled for the vector instructions of the CPU that runs them. Each ends a computation that is cancelled.

use pulp::{Arch, Simd, WithSimd};

use crate::cancel;

/// Compiles what is inlined in an expression for the vector instructions of this CPU; see [`vectorize`].
#[macro_export]
macro_rules! vectorized {
    ($work:expr) => {
        $crate::simd::vectorize(
            #[inline(always)]
            || $work,
        )
    };
}

/// Runs a loop with the widest vector instructions that this CPU has. Put the loop into a function that is
/// `#[inline(always)]` and takes slices and plain values, and call it from a closure that is `#[inline(always)]` as well:
/// only what is inlined here is compiled anew, and what a closure merely captures is read again in every step, which keeps a
/// loop scalar. Rust fuses no multiplication with an addition by itself, so the result does not depend on the CPU.
#[inline(always)]
pub fn vectorize<R>(work: impl FnMut() -> R) -> R {
    cancel::check();
    Arch::new().dispatch(Work(work))
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

/// A plain closure would be called through a shim that is compiled apart, without the instructions.
struct Work<F>(F);

impl<R, F: FnMut() -> R> WithSimd for Work<F> {
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
