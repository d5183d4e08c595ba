//! How many nodes a run of pixels needs.
//!
//! With β = θ/2 + π/4 the phase function has its poles at β = ± i ½ ln(1/g): behind them the error of the quadrature falls as
//! ρ^{−2n}, ρ the ellipse through the pole about the interval. Toward the open end the light fades over the angle κ = c D, which
//! acts as an edge while the spacing of nodes is wider; that error was measured for κ from 0.003 to 3 and 4 to 48 nodes and stays
//! below `min(1, 8 e^{−2 (κ n²)^{1/3}})/(2 n²)` of the light at that end.

use std::f32::consts::FRAC_PI_2;

use super::phase::GlowPhase;

/// Candidate node counts, all even.
const COUNTS: [usize; 13] = [4, 6, 8, 10, 12, 14, 16, 20, 24, 28, 32, 40, 64];
/// The largest node count.
pub const MOST_NODES: usize = COUNTS[COUNTS.len() - 1];
/// By this the measured error exceeds ρ^{−2n} at most; 4 nodes need most of it.
const POLE_FACTOR: f64 = 50.0;
/// The share of the light that swells late, half of it treated as an edge.
const SWELLING: f64 = 0.31;
/// Bounds of a run of pixels: the widest interval, the nearest approach, the shortest path.
#[derive(Debug, Clone, Copy)]
pub(super) struct Span {
    /// Start and end of the interval in β.
    pub(super) from: f32,
    pub(super) to: f32,
    /// The least end of an interval.
    pub(super) least_to: f32,
    /// Least distance of the lamp from a ray and from the end of one, m.
    pub(super) nearest_m: f32,
    pub(super) end_m: f32,
    /// Least and greatest factor of c, and the greatest of b.
    pub(super) clearest: f32,
    pub(super) murkiest: f32,
    pub(super) source: f32,
    /// How many times as long a ray is as the stretch of it that the factor of b is a mean of, at most.
    pub(super) stretch: f32,
}

/// Bounds of the light of one lamp.
#[derive(Debug, Clone, Copy)]
pub(super) struct Source {
    /// The largest b I₀ of the three channels, and the least c.
    pub(super) strength: f64,
    pub(super) attenuation: f64,
    /// How fast light fades toward the end of a ray, 1/m.
    pub(super) edge: f64,
    /// Rate at which multiple scattering reaches its maximum, 1/m; 0 without.
    pub(super) swelling: f64,
    pub(super) phase: GlowPhase,
    /// The error in linear light that the lamp may have.
    pub(super) tolerance: f64,
}

/// Parts of the quadrature error on a run of pixels.
struct Left {
    pole: f64,
    /// By this factor the error of the pole falls with each node, e-folds.
    growth: f64,
    edge: f64,
    fade: f64,
    /// The part that falls only as 1/n².
    swelling: f64,
}

impl Left {
    fn new(span: Span, source: Source) -> Self {
        let (from, to) = (f64::from(span.from), f64::from(span.to).min(f64::from(FRAC_PI_2)));
        let half = 0.5 * (to - from);
        let distance = f64::from(span.nearest_m);
        let (clear, murky) = (f64::from(span.clearest), f64::from(span.murkiest));
        let scale = source.strength * f64::from(span.source) / distance * 4.0 * half;
        // At β the scattering angle has the cosine cos 2β.
        let phase = |(sin, cos): (f64, f64)| source.phase.most(cos * cos - sin * sin);
        let ends = [from.sin_cos(), to.sin_cos()];
        let [at_start, at_end] = ends.map(|end| scale * phase(end));
        let growth = 2.0 * ellipse(source.phase.asymmetry, from, half).ln();
        let fade = source.attenuation * clear * distance;
        let shown = |rate: f64| (rate * murky * distance * ends[1].0 / ends[1].1).powi(2).min(1.0);
        let swelling = SWELLING * at_end * shown(source.swelling);
        Self {
            pole: POLE_FACTOR * at_start.max(at_end),
            growth,
            edge: at_end * shown(source.edge),
            fade,
            swelling,
        }
    }
}

/// The least count whose error is within the tolerance, or the largest count, and that error.
pub(super) fn count(span: Span, source: Source) -> (usize, f64) {
    let Left {
        pole,
        growth,
        edge,
        fade,
        swelling,
    } = Left::new(span, source);
    // The cube root and its exponential only where they can help.
    let left = |n: f64, enough: f64| {
        let (pole, edge) = (
            pole * (-growth * n).exp() + swelling / (n * n),
            0.5 * edge / (n * n),
        );
        if pole > enough || pole + edge <= enough {
            return pole + edge;
        }
        pole + edge * (8.0 * (-2.0 * (fade * n * n).cbrt()).exp()).min(1.0)
    };
    // Fewer nodes exceed the tolerance behind the pole.
    let least = (pole / source.tolerance).ln() / growth;
    COUNTS
        .into_iter()
        .filter(|&n| n as f64 >= least - 1.0)
        .map(|n| (n, left(n as f64, source.tolerance)))
        .find(|(_, left)| *left <= source.tolerance)
        .unwrap_or_else(|| (MOST_NODES, left(MOST_NODES as f64, 0.0)))
}

/// The sum of the half axes of the ellipse with its foci at the ends of the interval, through the pole of the phase function.
fn ellipse(g: f64, from: f64, half: f64) -> f64 {
    // For g below 0 the poles are at the other end, π/2 ± i ½ ln(1/|g|).
    let pole = if g < 0.0 { std::f64::consts::FRAC_PI_2 } else { 0.0 };
    let height = 0.5 * (1.0 / g.abs().max(1e-6)).ln() / half.max(1e-6);
    let middle = (from + half - pole) / half.max(1e-6);
    let to_focus = |x: f64| (x * x + height * height).sqrt();
    let sum = 0.5 * (to_focus(middle - 1.0) + to_focus(middle + 1.0));
    sum + (sum * sum - 1.0).max(0.0).sqrt()
}
