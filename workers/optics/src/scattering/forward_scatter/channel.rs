//! One channel in the fast method: light and kernel scales in the order of the transform, and the interpolation weights of the
//! nodes at each pixel.

use std::ops::Range;
use std::sync::Arc;

use imaging::Plane;
use imaging::dct::Folding;
use imaging::vectorized;

use super::basis::{BLOCK, Basis};
use super::cache::Grid;
use super::{Coarseness, KernelCache, Nodes};
use crate::kernel::GateReach;

/// A channel during its transforms.
pub(crate) struct Channel<'a> {
    nodes: &'a Nodes,
    basis: Basis,
    pub(super) light: Vec<f32>,
    located: Vec<f32>,
    /// Which sum it is added to: two channels of one color share one.
    pub(super) sum: usize,
    /// Factor of its light in that sum.
    pub(super) gain: f32,
    /// Reach of its kernels if its light passes a gate.
    gate: Option<GateReach>,
    /// Light of one kernel that passed the gate behind.
    passed: Option<Passed<'a>>,
    /// Error of coarse rows.
    coarse: Coarseness,
    size: (usize, usize),
}

/// Light that passed a gate and continues with one of the kernels.
#[derive(Clone, Copy)]
pub(super) struct Passed<'a> {
    /// Light at the gate, in folded order.
    pub(super) light: &'a [f32],
    /// Share of it that the kernel spreads, in units of the channel's light.
    pub(super) share: f32,
    /// The kernel.
    pub(super) k: usize,
}

impl<'a> Channel<'a> {
    /// `gamma` is the kernel scale of each pixel in pixels, finite.
    ///
    /// # Panics
    /// When the planes differ in size.
    #[must_use]
    pub(crate) fn new(
        light: &Plane<f32>,
        gamma: &Plane<f32>,
        nodes: &'a Nodes,
        cache: &mut KernelCache,
    ) -> Self {
        let size = light.size();
        assert_eq!(size, gamma.size(), "light and kernel scale belong to one frame");
        let [light, mut gamma] = [light, gamma].map(|plane| folded(plane, cache));
        let basis = Basis::new(nodes);
        vectorized!(basis.locate(&mut gamma));
        Self::located(light, gamma, nodes, size)
    }

    /// The same, given light and located scales in folded order.
    pub(super) fn located(
        light: Vec<f32>,
        located: Vec<f32>,
        nodes: &'a Nodes,
        size: (usize, usize),
    ) -> Self {
        Self {
            nodes,
            basis: Basis::new(nodes),
            light,
            located,
            sum: 0,
            gain: 1.0,
            gate: None,
            passed: None,
            coarse: Coarseness::default(),
            size,
        }
    }

    /// The same on coarse rows where a kernel permits it.
    #[must_use]
    pub(crate) fn on_coarse_rows(self, coarse: Coarseness) -> Self {
        Self { coarse, ..self }
    }

    /// The number of rows of the transform of kernel `k`.
    pub(super) fn rows(&self, k: usize) -> usize {
        let height = self.size.1;
        self.coarse.rows(self.nodes.gamma(k), height).unwrap_or(height)
    }

    /// The same with the light that passed the gate behind.
    #[must_use]
    pub(super) fn with_passed(self, passed: Option<Passed<'a>>) -> Self {
        Self { passed, ..self }
    }

    /// The same as a part of sum number `sum`.
    #[must_use]
    pub(crate) fn part_of(self, sum: usize) -> Self {
        Self { sum, ..self }
    }

    /// The same for light that passes a gate, multiplied by `gain`.
    #[must_use]
    pub(super) fn through(self, gate: GateReach, gain: f32) -> Self {
        Self {
            gain,
            gate: Some(gate),
            ..self
        }
    }

    fn transfer(&self, k: usize, cache: &mut KernelCache) -> Arc<Grid> {
        let (gamma, rows) = (self.nodes.gamma(k), self.rows(k));
        match self.gate {
            Some(gate) => cache.gated_transfer(gamma, self.size, rows, gate),
            None => cache.transfer(gamma, self.size, rows),
        }
    }

    pub(super) fn size(&self) -> (usize, usize) {
        self.size
    }

    pub(super) fn terms(&self) -> usize {
        self.nodes.terms()
    }

    pub(super) fn into_buffers(self) -> [Vec<f32>; 2] {
        [self.light, self.located]
    }
}

/// A plane in the order of the transform.
pub(super) fn folded(plane: &Plane<f32>, cache: &mut KernelCache) -> Vec<f32> {
    let mut folded = cache.buffers.take(plane.data().len());
    Folding::new(plane.width(), plane.height()).fold(plane.data(), &mut folded);
    folded
}

/// Kernel `k` of channel `channel`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Term {
    pub(super) channel: usize,
    pub(super) k: usize,
}

/// Two terms that share a complex transform; the second may be missing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pair {
    pub(super) first: Term,
    pub(super) second: Option<Term>,
}

/// Pairs consecutive terms of some channels: first neighbors of one channel, since most of their weights are common, then the
/// leftovers of channels with an odd number.
pub(super) fn pairs(terms: impl IntoIterator<Item = Range<usize>>) -> Vec<Pair> {
    let (mut pairs, mut left) = (Vec::new(), Vec::new());
    for (channel, terms) in terms.into_iter().enumerate() {
        let term = |k| Term { channel, k };
        pairs.extend((terms.start + 1..terms.end).step_by(2).map(|k| Pair {
            first: term(k - 1),
            second: Some(term(k)),
        }));
        left.extend((!terms.len().is_multiple_of(2)).then(|| term(terms.end - 1)));
    }
    pairs.extend(left.chunks(2).map(|two| Pair {
        first: two[0],
        second: two.get(1).copied(),
    }));
    pairs
}

impl Pair {
    /// The second again the first where it is missing: its share is 0.
    fn both(self) -> [Term; 2] {
        [self.first, self.second.unwrap_or(self.first)]
    }

    pub(super) fn channels(self) -> [usize; 2] {
        self.both().map(|term| term.channel)
    }

    /// H of both.
    pub(super) fn transfers(self, channels: &[Channel<'_>], cache: &mut KernelCache) -> [Arc<Grid>; 2] {
        self.both()
            .map(|Term { channel, k }| channels[channel].transfer(k, cache))
    }

    /// Light that passed the gate behind and continues with the kernel of each term.
    pub(super) fn passed<'a>(self, channels: &[Channel<'a>]) -> [Option<Passed<'a>>; 2] {
        let passed = |term: Term| channels[term.channel].passed.filter(|passed| passed.k == term.k);
        [passed(self.first), self.second.and_then(passed)]
    }

    /// The share of both in at most [`BLOCK`] pixels.
    #[inline(always)]
    pub(super) fn shares(
        self,
        channels: &[Channel<'_>],
        start: usize,
        count: usize,
        [first, second]: &mut [[f32; BLOCK]; 2],
    ) {
        let (first, second) = (&mut first[..count], &mut second[..count]);
        let located = |term: Term| &channels[term.channel].located[start..][..count];
        let (Term { channel, k }, basis) = (self.first, &channels[self.first.channel].basis);
        match self.second {
            Some(other) if other.channel == channel => basis.pair_of_shares(k, located(other), first, second),
            Some(other) => {
                basis.shares(k, located(self.first), first);
                channels[other.channel]
                    .basis
                    .shares(other.k, located(other), second);
            }
            None => {
                basis.shares(k, located(self.first), first);
                second.fill(0.0);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn listed(terms: &[usize]) -> Vec<[(usize, usize); 2]> {
        let number = |term: Term| (term.channel, term.k);
        let listed = pairs(terms.iter().map(|&terms| 0..terms)).into_iter();
        listed
            .map(|pair| [number(pair.first), pair.second.map_or((9, 9), number)])
            .collect()
    }

    #[test]
    fn what_is_left_of_odd_channels_travels_together() {
        assert_eq!(
            listed(&[3, 2, 1]),
            [[(0, 0), (0, 1)], [(1, 0), (1, 1)], [(0, 2), (2, 0)]]
        );
        assert_eq!(listed(&[1]), [[(0, 0), (9, 9)]]);
        assert!(listed(&[0]).is_empty());
        let later = pairs([2..5, 1..2]);
        assert_eq!(later.iter().map(|pair| pair.first.k).collect::<Vec<_>>(), [2, 4]);
    }
}
