//! Transfer functions and transforms that frames of one size share.

use std::collections::HashMap;
use std::sync::Arc;

use imaging::dct::PairDct;
use imaging::fft::Complex;

use super::buffers::{Buffers, MOST_KEPT_BYTES};
use super::decimation::Decimation;
use crate::kernel::{GateReach, Transfer};

/// Memory that cached transfer functions may take: at least 40 of a 768×492 frame, a few frames' worth of nodes. Beyond it the
/// least recently used goes.
const CACHE_BYTES: usize = 64 << 20;

/// Transforms and decimations are kept for this number of sizes: of a frame, and of its coarse rows.
const MOST_SIZES: usize = 10;

/// Transfer functions by (kernel scale, frame size), least recently used first out, and the transforms of the last sizes with
/// their planes. One for each thread, for a frame is computed on one.
#[derive(Default)]
pub struct KernelCache {
    grids: HashMap<Key, Entry>,
    clock: u64,
    bytes: usize,
    /// Part of it behind gates.
    gated_bytes: usize,
    /// Of a frame and of its coarse rows, the last used first.
    transforms: Vec<PairDct>,
    decimations: Vec<Arc<Decimation>>,
    pub(crate) buffers: Buffers,
    /// Memory of evicted transfer functions.
    spare: Vec<Vec<f32>>,
    /// Coarse rows of the last transforms.
    pub(super) coarse: Vec<Vec<Complex<f32>>>,
    hits: u64,
    misses: u64,
}

/// The part of it for kernels behind gates: they follow from the range of a gate, so other frames rarely have them.
const GATED_BYTES: usize = 8 << 20;

/// Kept memory of evicted transfer functions, in planes: fresh memory would cost page faults.
const MOST_SPARE: usize = 8;

/// Identity of a cached transfer function.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
struct Key {
    gamma_bits: u64,
    size: (usize, usize),
    /// Number of rows: that of the frame, or of its coarse rows.
    rows: usize,
    /// Number of columns of a kernel behind gates; `None` without gates, where it follows from the scale.
    gated_columns: Option<usize>,
}

struct Entry {
    grid: Arc<Grid>,
    used: u64,
}

/// H of a kernel on the grid of a frame's cosine transform, without its negligible columns and without the frequencies beyond
/// coarse rows.
#[derive(Debug, PartialEq)]
pub(super) struct Grid {
    values: Vec<f32>,
    rows: usize,
}

impl Grid {
    fn new(key: Key, mut values: Vec<f32>) -> Self {
        let (gamma, size) = (f64::from_bits(key.gamma_bits), key.size);
        let (transfer, columns) = match key.gated_columns {
            Some(columns) => (Transfer::behind_gates(gamma), columns),
            None => {
                let transfer = Transfer::new(gamma);
                let columns = transfer.columns(size.0);
                (transfer, columns)
            }
        };
        transfer.write_corner(size, columns, key.rows, &mut values);
        Self {
            values,
            rows: key.rows,
        }
    }

    /// Columns that are not 0.
    pub(super) fn columns(&self) -> usize {
        self.values.len() / self.rows.max(1)
    }

    /// H along fy at `fx = p/2W`; `None` where it is 0.
    pub(super) fn column(&self, p: usize) -> Option<&[f32]> {
        self.values.chunks_exact(self.rows).nth(p)
    }

    fn bytes(&self) -> usize {
        size_of_val(self.values.as_slice())
    }
}

impl KernelCache {
    /// An empty cache.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// H of a kernel scale on the first rows of the grid of a frame size.
    pub(super) fn transfer(&mut self, gamma: f64, size: (usize, usize), rows: usize) -> Arc<Grid> {
        self.grid(Key {
            gamma_bits: gamma.to_bits(),
            size,
            rows,
            gated_columns: None,
        })
    }

    /// The same of a kernel whose light passes a gate.
    pub(super) fn gated_transfer(
        &mut self,
        gamma: f64,
        size: (usize, usize),
        rows: usize,
        reach: GateReach,
    ) -> Arc<Grid> {
        self.grid(Key {
            gamma_bits: gamma.to_bits(),
            size,
            rows,
            gated_columns: Some(reach.columns(gamma, size.0)),
        })
    }

    fn grid(&mut self, key: Key) -> Arc<Grid> {
        self.clock += 1;
        if let Some(entry) = self.grids.get_mut(&key) {
            entry.used = self.clock;
            self.hits += 1;
            return Arc::clone(&entry.grid);
        }
        self.misses += 1;
        // Room for any kernel of the frame: growing memory later would move it.
        let room = key.size.0 * key.size.1;
        self.spare.retain(|values| values.capacity() >= room);
        let values = self.spare.pop().unwrap_or_else(|| Vec::with_capacity(room));
        let grid = Arc::new(Grid::new(key, values));
        let bytes = grid.bytes();
        let is_gated = key.gated_columns.is_some();
        while is_gated && self.gated_bytes > 0 && self.gated_bytes + bytes > GATED_BYTES {
            self.evict(|key| key.gated_columns.is_some());
        }
        while self.bytes > 0 && self.bytes + bytes > CACHE_BYTES {
            self.evict(|_| true);
        }
        if bytes > if is_gated { GATED_BYTES } else { CACHE_BYTES } {
            return grid;
        }
        self.bytes += bytes;
        self.gated_bytes += if is_gated { bytes } else { 0 };
        self.grids.insert(
            key,
            Entry {
                grid: Arc::clone(&grid),
                used: self.clock,
            },
        );
        grid
    }

    /// Drops the least recently used of some kernels.
    fn evict(&mut self, is_candidate: impl Fn(&Key) -> bool) {
        let candidates = self.grids.iter().filter(|(key, _)| is_candidate(key));
        let Some(oldest) = candidates
            .min_by_key(|(_, entry)| entry.used)
            .map(|(key, _)| *key)
        else {
            return;
        };
        let Some(gone) = self.grids.remove(&oldest) else {
            return;
        };
        let bytes = gone.grid.bytes();
        self.bytes -= bytes;
        self.gated_bytes -= if oldest.gated_columns.is_some() { bytes } else { 0 };
        if let Ok(grid) = Arc::try_unwrap(gone.grid)
            && self.spare.len() < MOST_SPARE
        {
            self.spare.push(grid.values);
        }
    }

    /// The transform of a frame size.
    pub(super) fn transform(&mut self, (width, height): (usize, usize)) -> &mut PairDct {
        let known = self
            .transforms
            .iter()
            .position(|transform| transform.size() == (width, height));
        let transform = match known {
            Some(at) => self.transforms.remove(at),
            None => PairDct::new(width, height),
        };
        self.transforms.truncate(MOST_SIZES - 1);
        self.transforms.insert(0, transform);
        &mut self.transforms[0]
    }

    /// Coarse rows of a height.
    pub(super) fn decimation(&mut self, height: usize, coarse: usize) -> Arc<Decimation> {
        let is_known = |decimation: &Arc<Decimation>| {
            (decimation.height, decimation.coarse_height()) == (height, coarse)
        };
        let known = self.decimations.iter().position(is_known);
        let decimation = match known {
            Some(at) => self.decimations.remove(at),
            None => Arc::new(Decimation::new(height, coarse)),
        };
        self.decimations.truncate(MOST_SIZES - 1);
        self.decimations.insert(0, Arc::clone(&decimation));
        decimation
    }

    /// Drops the transform of a very large frame.
    pub(crate) fn trim(&mut self) {
        self.transforms
            .retain(|transform| transform.bytes() <= MOST_KEPT_BYTES);
    }

    /// How often a transfer function was there, and how often it was not.
    #[must_use]
    pub fn hits_and_misses(&self) -> (u64, u64) {
        (self.hits, self.misses)
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
        let first = cache.transfer(1.0, (512, 512), 512);
        cache.transfer(1.0, (512, 512), 512);
        assert_eq!(cache.hits_and_misses(), (1, 1));
        for step in 0..100 {
            cache.transfer(1.5 + f64::from(step) / 100.0, (512, 512), 512);
            assert!(cache.bytes() <= CACHE_BYTES);
        }
        assert!(
            !cache.grids.keys().any(|key| key.gamma_bits == 1f64.to_bits()),
            "the oldest is still there"
        );
        assert_eq!(cache.transfer(1.0, (512, 512), 512), first);
    }

    #[test]
    fn kernels_behind_gates_displace_each_other_and_no_others() {
        let mut cache = KernelCache::new();
        let reach = GateReach {
            amplification: 9.0,
            gamma_px: 1.0,
        };
        let plain = cache.transfer(1.0, (512, 512), 512);
        let size = (512, 512);
        let first = cache.gated_transfer(1.0, size, 512, reach);
        for step in 0..100 {
            cache.gated_transfer(1.0 + f64::from(step) / 100.0, size, 512, reach);
            assert!(cache.gated_bytes <= GATED_BYTES);
        }
        let (hits, misses) = cache.hits_and_misses();
        assert_eq!(cache.gated_transfer(1.0, size, 512, reach), first);
        assert_eq!(cache.transfer(1.0, size, 512), plain);
        assert_eq!(cache.hits_and_misses(), (hits + 1, misses + 1));
    }
}
