//! What the fast method knows of one channel: light and kernel scales in the order of the transform, and the shares of the
//! nodes in each pixel.

use std::sync::Arc;

use imaging::Plane;
use imaging::dct::Folding;
use imaging::vectorized;

use super::basis::{BLOCK, Basis};
use super::cache::Grid;
use super::{KernelCache, Nodes};

/// A channel on its way through the transforms.
pub(crate) struct Channel<'a> {
    nodes: &'a Nodes,
    basis: Basis,
    pub(super) light: Vec<f32>,
    located: Vec<f32>,
    wide: Option<Wide>,
    size: (usize, usize),
}

/// The second, wider kernel of each pixel.
struct Wide {
    located: Vec<f32>,
    /// Share of the light that it takes.
    share: Vec<f32>,
}

impl<'a> Channel<'a> {
    /// The light of each pixel, and the pixel's own kernel scale `gamma` in pixels, finite.
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
        let [light, gamma] = [light, gamma].map(|plane| folded(plane, cache));
        Self::folded(light, gamma, nodes, size)
    }

    /// The same, given both in folded order.
    pub(super) fn folded(light: Vec<f32>, mut gamma: Vec<f32>, nodes: &'a Nodes, size: (usize, usize)) -> Self {
        let basis = Basis::new(nodes);
        vectorized!(basis.locate(&mut gamma));
        Self {
            nodes,
            basis,
            light,
            located: gamma,
            wide: None,
            size,
        }
    }

    /// The same with a wider kernel in each pixel that takes a share of its light.
    #[must_use]
    pub(crate) fn with_wide(self, gamma: &Plane<f32>, share: &Plane<f32>, cache: &mut KernelCache) -> Self {
        let [gamma, share] = [gamma, share].map(|plane| folded(plane, cache));
        self.with_wide_folded(gamma, share)
    }

    /// The same, given both in folded order.
    #[must_use]
    pub(super) fn with_wide_folded(self, mut gamma: Vec<f32>, share: Vec<f32>) -> Self {
        vectorized!(self.basis.locate(&mut gamma));
        let wide = Some(Wide { located: gamma, share });
        Self { wide, ..self }
    }

    /// l_k of at most [`BLOCK`] pixels from `start` on.
    #[inline(always)]
    fn shares(&self, k: usize, start: usize, shares: &mut [f32]) {
        let pixels = start..start + shares.len();
        self.basis.shares(k, &self.located[pixels.clone()], shares);
        if let Some(wide) = &self.wide {
            let mut others = [0.0; BLOCK];
            let others = &mut others[..shares.len()];
            self.basis.shares(k, &wide.located[pixels.clone()], others);
            mix(shares, others, &wide.share[pixels]);
        }
    }

    /// l_k and l_{k+1} of the same pixels.
    #[inline(always)]
    fn pair_of_shares(&self, k: usize, start: usize, first: &mut [f32], second: &mut [f32]) {
        let pixels = start..start + first.len();
        self.basis
            .pair_of_shares(k, &self.located[pixels.clone()], first, second);
        if let Some(wide) = &self.wide {
            let (mut one, mut other) = ([0.0; BLOCK], [0.0; BLOCK]);
            let (one, other) = (&mut one[..first.len()], &mut other[..first.len()]);
            self.basis
                .pair_of_shares(k, &wide.located[pixels.clone()], one, other);
            mix(first, one, &wide.share[pixels.clone()]);
            mix(second, other, &wide.share[pixels]);
        }
    }

    pub(super) fn size(&self) -> (usize, usize) {
        self.size
    }

    pub(super) fn terms(&self) -> usize {
        self.nodes.terms()
    }

    pub(super) fn into_buffers(self) -> impl Iterator<Item = Vec<f32>> {
        let wide = self.wide.map(|wide| [wide.located, wide.share]);
        [self.light, self.located].into_iter().chain(wide.into_iter().flatten())
    }
}

/// A plane in the order of the transform.
pub(super) fn folded(plane: &Plane<f32>, cache: &mut KernelCache) -> Vec<f32> {
    let mut folded = cache.buffers.take(plane.data().len());
    Folding::new(plane.width(), plane.height()).fold(plane.data(), &mut folded);
    folded
}

/// `(1 − m) a + m b` in place of a.
#[inline(always)]
fn mix(a: &mut [f32], b: &[f32], m: &[f32]) {
    for (a, (&b, &m)) in a.iter_mut().zip(b.iter().zip(m)) {
        *a += m * (b - *a);
    }
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

/// The terms of some channels two by two: neighbors of one channel as far as they go, since most of their shares is common;
/// then what is left of channels with an odd number.
pub(super) fn pairs(terms: impl IntoIterator<Item = usize>) -> Vec<Pair> {
    let (mut pairs, mut left) = (Vec::new(), Vec::new());
    for (channel, terms) in terms.into_iter().enumerate() {
        let term = |k| Term { channel, k };
        pairs.extend((1..terms).step_by(2).map(|k| Pair {
            first: term(k - 1),
            second: Some(term(k)),
        }));
        left.extend((!terms.is_multiple_of(2)).then(|| term(terms - 1)));
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
        self.both().map(|Term { channel, k }| {
            let Channel { nodes, size, .. } = &channels[channel];
            cache.transfer(nodes.gamma(k), size.0, size.1)
        })
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
        let (one, k) = (&channels[self.first.channel], self.first.k);
        match self.second {
            Some(other) if other.channel == self.first.channel => {
                one.pair_of_shares(k, start, first, second);
            }
            Some(other) => {
                one.shares(k, start, first);
                channels[other.channel].shares(other.k, start, second);
            }
            None => {
                one.shares(k, start, first);
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
        let listed = pairs(terms.iter().copied()).into_iter();
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
    }
}
