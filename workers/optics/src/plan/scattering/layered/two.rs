//! The light that the two kernels of a channel spread.

use super::part::{Part, Way};
use crate::forward_scatter::Gate;
use crate::plan::passages::Through;
use crate::plan::terms::PILED_UP;
use crate::water::{Spread, Tail};

/// The gate behind a layer, and the most light that passes it.
#[derive(Clone, Copy)]
pub(super) struct Behind {
    pub(super) gate: Gate,
    pub(super) light: f64,
}

/// The kernels of a channel.
pub(super) struct Two {
    pub(super) channel: usize,
    pub(super) spread: Spread,
    pub(super) tail: Option<Tail>,
    pub(super) widest_px: f64,
}

impl Two {
    /// Spread of lit ranges by the narrow and the wide kernel, and of light that passes the gate `behind`.
    pub(super) fn parts(
        &self,
        span: (f64, f64),
        lit: &[((f64, f64), f64)],
        through: Option<Through>,
        behind: Option<Behind>,
    ) -> [Option<Part>; 2] {
        let of = |kernel: usize, spread: Spread, taken: &dyn Fn((f64, f64)) -> f64| {
            let gammas = |(near, far): (f64, f64)| {
                let gamma = |meters: f64| spread.gamma(self.channel, meters, self.widest_px);
                (gamma(near), gamma(far))
            };
            let bins = lit
                .iter()
                .map(|&(step, light)| (gammas(step), light * taken(step)));
            let bins: Vec<_> = bins.filter(|(_, light)| *light > 0.0).collect();
            let behind = behind.filter(|behind| behind.gate.spread[kernel] > 0.0);
            let passing = behind.map(|behind| behind.gate.gammas[kernel]);
            let own = (!bins.is_empty()).then(|| gammas(span));
            let span = match (own, passing) {
                (Some((near, far)), Some(gamma)) => Some((near.min(gamma), far.max(gamma))),
                (own, passing) => own.or(passing.map(|gamma| (gamma, gamma))),
            };
            span.map(|span| Part {
                span,
                bins,
                way: through.map(|through| Way { through, kernel }),
                passing,
                passing_light: behind
                    .map_or(0.0, |behind| PILED_UP * behind.light * behind.gate.spread[kernel]),
            })
        };
        match self.tail {
            None => [of(0, self.spread, &|_| 1.0), None],
            Some(tail) => [
                of(0, self.spread, &|(near, _)| {
                    1.0 - tail.share_at(self.channel, near)
                }),
                of(1, tail.spread, &|(_, far)| tail.share_at(self.channel, far)),
            ],
        }
    }
}
