//! Exact 8-bit sRGB encoding by table: the top bits of a float select a bucket with at most one threshold.
//!
//! Below 2^-13 every value has the code 0 (the threshold of code 1 is about 1.5e-4 > 2^-13 = 1.2e-4). Above, the upper
//! 16 bits of the float number the buckets: at most 1/128 of an octave each, narrower than the distance of two
//! neighboring thresholds. A bucket stores its lowest code and the threshold of the next.

const LOWEST: f32 = 1.0 / 8192.0;
const SHIFT: u32 = 16;

pub(super) struct Encoder {
    first: usize,
    buckets: Vec<Bucket>,
}

#[derive(Clone, Copy)]
struct Bucket {
    threshold: f32,
    code: u8,
}

impl Encoder {
    pub(super) fn new() -> Self {
        let thresholds: Vec<f32> = (1..=255u8).map(threshold).collect();
        let first = (LOWEST.to_bits() >> SHIFT) as usize;
        let last = (1.0f32.to_bits() >> SHIFT) as usize;
        let buckets = (first..=last).map(|index| {
            let start = f32::from_bits((index as u32) << SHIFT);
            let code = thresholds.partition_point(|&t| t <= start);
            let threshold = thresholds.get(code).copied().unwrap_or(f32::INFINITY);
            Bucket {
                threshold,
                code: code as u8,
            }
        });
        Self {
            first,
            buckets: buckets.collect(),
        }
    }

    /// The code of linear light, clamped to 0..=1; NaN is 0.
    #[inline]
    #[expect(
        clippy::manual_clamp,
        reason = "`clamp` keeps NaN; this way it ends in the lowest bucket"
    )]
    pub(super) fn code(&self, l: f32) -> u8 {
        let l = l.max(LOWEST).min(1.0);
        let bucket = self.buckets[(l.to_bits() >> SHIFT) as usize - self.first];
        bucket.code + u8::from(l >= bucket.threshold)
    }
}

/// The reference: `floor(255 encode(clamp(l)) + 1/2)`.
fn reference(l: f32) -> u8 {
    let v = super::curve::encode(f64::from(if l.is_nan() { 0.0 } else { l.clamp(0.0, 1.0) }));
    (255.0 * v + 0.5).floor() as u8
}

/// The smallest float whose code is at least `code`, by bisection over the floats.
fn threshold(code: u8) -> f32 {
    let (mut below, mut from) = (0u32, 1.0f32.to_bits());
    while from - below > 1 {
        let middle = below + (from - below) / 2;
        if reference(f32::from_bits(middle)) >= code {
            from = middle
        } else {
            below = middle
        }
    }
    f32::from_bits(from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_equal_the_reference_at_every_threshold_and_its_neighbors() {
        let encoder = Encoder::new();
        for code in 1..=255u8 {
            let position = threshold(code).to_bits();
            for bits in position - 3..=position + 3 {
                let l = f32::from_bits(bits);
                assert_eq!(encoder.code(l), reference(l), "{l:e}");
            }
        }
    }

    #[test]
    fn codes_equal_the_reference_on_a_dense_walk_over_the_floats() {
        let encoder = Encoder::new();
        for bits in (0..=1.1f32.to_bits()).step_by(997) {
            let l = f32::from_bits(bits);
            assert_eq!(encoder.code(l), reference(l), "{l:e}");
        }
        for l in [-1.0, -0.0, f32::NEG_INFINITY, f32::INFINITY, f32::NAN, 1e30] {
            assert_eq!(encoder.code(l), reference(l), "{l:e}");
        }
    }

    #[test]
    fn no_bucket_holds_two_thresholds() {
        let thresholds: Vec<u32> = (1..=255u8)
            .map(|code| threshold(code).to_bits() >> SHIFT)
            .collect();
        assert!(thresholds.is_sorted_by(|a, b| a < b));
        assert!(threshold(1) > LOWEST);
    }
}
