//! Transfer functions and transforms that frames of one size share.

use std::collections::HashMap;
use std::sync::Arc;

use imaging::dct::Dct2;

use crate::kernel::Transfer;

/// Memory that cached transfer functions may take: 40 of a 768×492 frame, a few frames' worth of nodes. Beyond it the
/// least recently used goes.
const CACHE_BYTES: usize = 64 << 20;

/// Transfer functions by (kernel scale, frame size), least recently used first out, and the transform of the last size.
#[derive(Default)]
pub struct KernelCache {
    grids: HashMap<(u64, usize, usize), Entry>,
    clock: u64,
    bytes: usize,
    transform: Option<Dct2<f32>>,
}

struct Entry {
    grid: Arc<[f32]>,
    used: u64,
}

impl KernelCache {
    /// An empty cache.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// H of a kernel scale on the grid of a frame size, times nothing: the transform carries no factor.
    pub(super) fn transfer(&mut self, gamma: f64, width: usize, height: usize) -> Arc<[f32]> {
        self.clock += 1;
        let key = (gamma.to_bits(), width, height);
        if let Some(entry) = self.grids.get_mut(&key) {
            entry.used = self.clock;
            return Arc::clone(&entry.grid);
        }
        let grid: Arc<[f32]> = Transfer::new(gamma)
            .grid(width, height)
            .into_iter()
            .map(|h| h as f32)
            .collect();
        let bytes = size_of_val(&*grid);
        while self.bytes + bytes > CACHE_BYTES {
            let Some(oldest) = self
                .grids
                .iter()
                .min_by_key(|(_, entry)| entry.used)
                .map(|(key, _)| *key)
            else {
                return grid;
            };
            let gone = self
                .grids
                .remove(&oldest)
                .map_or(0, |entry| size_of_val(&*entry.grid));
            self.bytes -= gone;
        }
        self.bytes += bytes;
        self.grids.insert(
            key,
            Entry {
                grid: Arc::clone(&grid),
                used: self.clock,
            },
        );
        grid
    }

    /// The transform of a frame size.
    pub(super) fn transform(&mut self, width: usize, height: usize) -> &mut Dct2<f32> {
        let fits = self
            .transform
            .as_ref()
            .is_some_and(|transform| transform.size() == (width, height));
        if !fits {
            self.transform = None;
        }
        self.transform.get_or_insert_with(|| Dct2::new(width, height))
    }

    /// Bytes that the transfer functions take now.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cache_stays_within_its_memory_and_answers_the_same_after_eviction() {
        let mut cache = KernelCache::new();
        let first = cache.transfer(1.0, 512, 512);
        for step in 0..100 {
            cache.transfer(2.0 + f64::from(step), 512, 512);
            assert!(cache.bytes() <= CACHE_BYTES);
        }
        assert!(
            !cache.grids.contains_key(&(1f64.to_bits(), 512, 512)),
            "the oldest is still there"
        );
        assert_eq!(cache.transfer(1.0, 512, 512), first);
    }
}
