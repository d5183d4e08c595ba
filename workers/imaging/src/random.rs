//! The counter-based random stream: values have addresses instead of an order.
//!
//! Philox4x32-10 (Salmon, Moraes, Dror, Shaw 2011, "Parallel random numbers: as easy as 1, 2, 3") maps a 128-bit
//! counter and a 64-bit key to 128 bits. The key identifies the purpose, the counter the value, so a value does not
//! depend on other draws, their order, or the number of threads.

use sha2::{Digest, Sha256};

use crate::vectorized;

const ROUNDS: usize = 10;
const MULTIPLIERS: [u32; 2] = [0xD251_1F53, 0xCD9E_8D57];
const WEYL: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];

/// Philox4x32-10: 128 random bits from a counter and a key.
#[must_use]
pub fn philox4x32_10(counter: [u32; 4], key: [u32; 2]) -> [u32; 4] {
    let mut state = counter;
    let mut key = key;
    for _ in 0..ROUNDS {
        let first = u64::from(MULTIPLIERS[0]) * u64::from(state[0]);
        let second = u64::from(MULTIPLIERS[1]) * u64::from(state[2]);
        state = [
            (second >> 32) as u32 ^ state[1] ^ key[0],
            second as u32,
            (first >> 32) as u32 ^ state[3] ^ key[1],
            first as u32,
        ];
        key = [key[0].wrapping_add(WEYL[0]), key[1].wrapping_add(WEYL[1])];
    }
    state
}

/// Random values for one purpose, addressed by (index, element).
///
/// The key is the first eight bytes of SHA-256(tag ‖ seed as u64 little-endian ‖ name in UTF-8), read as two
/// little-endian u32.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stream {
    key: [u32; 2],
}

impl Stream {
    /// The stream of a random distribution at a JSON pointer of a job.
    #[must_use]
    pub fn law(seed: u64, pointer: &str) -> Self {
        Self::keyed("fathom-law-v1", seed, pointer)
    }

    /// The stream of a stage of the chain.
    #[must_use]
    pub fn stage(seed: u64, name: &str) -> Self {
        Self::keyed("fathom-stage-v1", seed, name)
    }

    fn keyed(tag: &str, seed: u64, name: &str) -> Self {
        let digest = Sha256::new()
            .chain_update(tag)
            .chain_update(seed.to_le_bytes())
            .chain_update(name)
            .finalize();
        let word =
            |at: usize| u32::from_le_bytes([digest[at], digest[at + 1], digest[at + 2], digest[at + 3]]);
        Self {
            key: [word(0), word(4)],
        }
    }

    /// 64 random bits: the first two words of the block at counter (index, element), low word first.
    #[must_use]
    pub fn bits(&self, index: u64, element: u64) -> u64 {
        let counter = [
            index as u32,
            (index >> 32) as u32,
            element as u32,
            (element >> 32) as u32,
        ];
        let [low, high, ..] = philox4x32_10(counter, self.key);
        u64::from(low) | u64::from(high) << 32
    }

    /// A value in [0, 1) with 53 random bits: `(bits >> 11) · 2^-53`.
    #[must_use]
    pub fn unit(&self, index: u64, element: u64) -> f64 {
        (self.bits(index, element) >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }

    /// [`Stream::unit`] of the elements `first`, `first + step`, …: the same values, several at a time.
    pub fn fill_units(&self, index: u64, first: u64, step: u64, units: &mut [f64]) {
        vectorized!(fill(self.key, index, first, step, &mut *units));
    }

    /// [`Stream::unit`] of the elements `first + step · position`: the same values, several at a time. The shorter of
    /// both slices determines the number.
    pub fn fill_units_at(&self, index: u64, (first, step): (u64, u64), positions: &[u8], units: &mut [f64]) {
        vectorized!(fill_at(self.key, index, (first, step), positions, &mut *units));
    }
}

#[inline(always)]
fn fill(key: [u32; 2], index: u64, first: u64, step: u64, units: &mut [f64]) {
    for (position, unit) in units.iter_mut().enumerate() {
        *unit = wide_unit(key, index, first.wrapping_add(step.wrapping_mul(position as u64)));
    }
}

#[inline(always)]
fn fill_at(key: [u32; 2], index: u64, (first, step): (u64, u64), positions: &[u8], units: &mut [f64]) {
    for (unit, &position) in units.iter_mut().zip(positions) {
        let element = first.wrapping_add(step.wrapping_mul(u64::from(position)));
        *unit = wide_unit(key, index, element);
    }
}

/// Philox with each word in the lower half of a 64-bit register, as required by vector multiplication. The next
/// multiplication ignores the upper halves for free.
#[inline(always)]
fn wide_unit(mut key: [u32; 2], index: u64, element: u64) -> f64 {
    const LOW: u64 = u32::MAX as u64;
    let mut state = [index & LOW, index >> 32, element & LOW, element >> 32];
    for _ in 0..ROUNDS {
        let left = u64::from(MULTIPLIERS[0]) * (state[0] & LOW);
        let right = u64::from(MULTIPLIERS[1]) * (state[2] & LOW);
        state = [
            right >> 32 ^ state[1] ^ u64::from(key[0]),
            right,
            left >> 32 ^ state[3] ^ u64::from(key[1]),
            left,
        ];
        key = [key[0].wrapping_add(WEYL[0]), key[1].wrapping_add(WEYL[1])];
    }
    let bits = state[0] & LOW | state[1] << 32;
    (bits >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The published test vectors of Philox.
    #[test]
    fn philox_gives_its_published_answers() {
        let answers = [
            (
                [0; 4],
                [0; 2],
                [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8],
            ),
            (
                [u32::MAX; 4],
                [u32::MAX; 2],
                [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd],
            ),
            (
                [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344],
                [0xa409_3822, 0x299f_31d0],
                [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1],
            ),
        ];
        for (counter, key, expected) in answers {
            assert_eq!(philox4x32_10(counter, key), expected);
        }
    }

    #[test]
    fn seed_name_tag_index_and_element_each_change_the_value() {
        let base = Stream::law(1, "/alpha").bits(2, 3);
        let others = [
            Stream::law(2, "/alpha").bits(2, 3),
            Stream::law(1, "/alphb").bits(2, 3),
            Stream::stage(1, "/alpha").bits(2, 3),
            Stream::law(1, "/alpha").bits(3, 3),
            Stream::law(1, "/alpha").bits(2, 4),
            Stream::law(1, "/alpha").bits(2 + (1 << 32), 3),
        ];
        assert!(others.iter().all(|&other| other != base));
        assert_eq!(Stream::law(1, "/alpha").bits(2, 3), base);
    }

    #[test]
    fn many_units_are_the_same_as_one_by_one() {
        let stream = Stream::stage(7, "camera-read");
        let (index, first) = (3 + (5 << 32), (1 << 32) - 40);
        for (length, step) in [(1, 1), (37, 1), (64, 2), (101, 8)] {
            let mut units = vec![0.0; length];
            stream.fill_units(index, first, step, &mut units);
            for (position, unit) in units.into_iter().enumerate() {
                assert_eq!(unit, stream.unit(index, first + step * position as u64));
            }
            let positions: Vec<u8> = (0..length as u8).rev().map(|place| 2 * place).collect();
            let mut units = vec![0.0; length];
            stream.fill_units_at(index, (first, step), &positions, &mut units);
            for (position, unit) in positions.into_iter().zip(units) {
                assert_eq!(unit, stream.unit(index, first + step * u64::from(position)));
            }
        }
    }

    #[test]
    fn units_fill_the_interval_evenly() {
        let stream = Stream::stage(0, "snow");
        let values: Vec<f64> = (0..10_000).map(|i| stream.unit(i, 0)).collect();
        assert!(values.iter().all(|v| (0.0..1.0).contains(v)));
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        assert!((mean - 0.5).abs() < 0.01, "{mean}");
    }
}
