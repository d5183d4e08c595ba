//! Number types of training: f32, and f64 for gradient tests.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// A floating-point number.
pub trait Real:
    Copy
    + Default
    + PartialOrd
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + 'static
{
    /// The nearest value of this type.
    fn from_f64(value: f64) -> Self;
    /// The same value in f64.
    fn to_f64(self) -> f64;
    /// Indices of the values in ascending order; stable.
    fn ascending(values: &[Self]) -> Vec<u32>;
}

impl Real for f32 {
    fn from_f64(value: f64) -> Self {
        value as f32
    }

    fn to_f64(self) -> f64 {
        f64::from(self)
    }

    /// Sorts integers with the index in their lower half: faster than sorting indices by value.
    fn ascending(values: &[Self]) -> Vec<u32> {
        let keys = values.iter().enumerate().map(|(place, value)| {
            let bits = value.to_bits();
            let ordered = if bits >> 31 == 0 { bits | 1 << 31 } else { !bits };
            u64::from(ordered) << 32 | place as u64
        });
        let mut keys: Vec<u64> = keys.collect();
        keys.sort_unstable();
        keys.into_iter().map(|key| key as u32).collect()
    }
}

impl Real for f64 {
    fn from_f64(value: f64) -> Self {
        value
    }

    fn to_f64(self) -> f64 {
        self
    }

    fn ascending(values: &[Self]) -> Vec<u32> {
        let mut places: Vec<u32> = (0..values.len() as u32).collect();
        places.sort_by(|&a, &b| values[a as usize].total_cmp(&values[b as usize]));
        places
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_kinds_sort_alike() {
        let values = [0.5, -1.0, 3.0, -0.25, 0.5, 0.0, -7.5];
        let narrow = values.map(|value| value as f32);
        assert_eq!(f64::ascending(&values), [6, 1, 3, 5, 0, 4, 2]);
        assert_eq!(f32::ascending(&narrow), f64::ascending(&values));
    }
}
