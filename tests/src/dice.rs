//! Reproducible random numbers.

/// A linear congruential generator with Knuth's constants, so that a failed run can be repeated.
pub struct Dice(pub u64);

impl Dice {
    /// A number below `n`.
    pub fn draw(&mut self, n: u64) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % n
    }
}
