//! Layers of a frame, ordered by occlusion.
//!
//! If a neighbor is a quarter farther, occlusion is possible. A few cuts between the ranges of such edges divide the frame into
//! layers; each cut has a gate at the nearer side of its edges.

use imaging::{Plane, cancel};

use crate::range::is_hole;

/// A neighbor farther by this factor is behind an edge.
const BEHIND: f64 = 1.25;
/// Largest ratio of a cut to the range of its occluder, so that the gate is near the occluder.
const NEAR: f64 = 1.5;
/// Number of candidate ranges for cuts.
const CANDIDATES: usize = 64;
/// Share of edges that cuts need not serve.
const LEFT: f64 = 0.02;

/// The cuts and gates of a frame, nearest first.
#[derive(Debug, Clone, PartialEq)]
pub struct Layering {
    /// Ranges between the layers, meters: a pixel is in the layer of as many cuts as are nearer.
    pub cuts_m: Vec<f64>,
    /// Where the light behind each cut is stopped, meters.
    pub gates_m: Vec<f64>,
    /// Nearest and farthest range of each layer, meters; `None` for an empty layer.
    pub spans_m: Vec<Option<(f64, f64)>>,
}

/// Two neighbors with possible occlusion, ranges in meters.
#[derive(Debug, Clone, Copy)]
struct Edge {
    near: f64,
    far: f64,
}

impl Edge {
    /// Whether a cut divides the two near the occluder.
    fn is_served(self, cut: f64) -> bool {
        self.near <= cut && cut < self.far.min(NEAR * self.near)
    }
}

impl Layering {
    /// Divides a frame into at most `most` layers; `None` without occlusion.
    #[must_use]
    pub fn find<T: Copy + Into<f64>>(range: &Plane<T>, most: usize) -> Option<Self> {
        let mut edges = edges(range);
        if edges.is_empty() {
            return None;
        }
        let candidates = candidates(range);
        let most_left = LEFT * edges.len() as f64;
        let mut found: Vec<(f64, f64)> = Vec::new();
        while found.len() + 1 < most && edges.len() as f64 > most_left {
            let Some(cut) = most_served(&edges, &candidates) else {
                break;
            };
            let (served, left): (Vec<Edge>, Vec<Edge>) =
                edges.into_iter().partition(|edge| edge.is_served(cut));
            found.push((cut, median(served.iter().map(|edge| edge.near).collect())));
            edges = left;
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        if found.is_empty() {
            return None;
        }
        let (cuts_m, gates_m): (Vec<f64>, Vec<f64>) = found.into_iter().unzip();
        let spans_m = spans(range, &cuts_m);
        Some(Self {
            cuts_m,
            gates_m,
            spans_m,
        })
    }

    /// How many layers.
    #[must_use]
    pub fn count(&self) -> usize {
        self.cuts_m.len() + 1
    }

    /// The layer of a range in meters, 0 the nearest; behind all layers for a hole.
    #[must_use]
    pub fn layer_of(&self, range_m: f64) -> usize {
        if is_hole(range_m) {
            return self.count();
        }
        self.cuts_m.iter().filter(|&&cut| range_m > cut).count()
    }
}

/// Nearest and farthest range between the cuts.
fn spans<T: Copy + Into<f64>>(range: &Plane<T>, cuts: &[f64]) -> Vec<Option<(f64, f64)>> {
    let mut spans = vec![(f64::INFINITY, 0.0f64); cuts.len() + 1];
    for &z in range.data() {
        let z: f64 = z.into();
        if !is_hole(z) {
            let span = &mut spans[cuts.iter().filter(|&&cut| z > cut).count()];
            *span = (span.0.min(z), span.1.max(z));
        }
    }
    let known = |span: (f64, f64)| (span.0 <= span.1).then_some(span);
    spans.into_iter().map(known).collect()
}

fn edges<T: Copy + Into<f64>>(range: &Plane<T>) -> Vec<Edge> {
    let mut edges = Vec::new();
    let mut look = |a: T, b: T| {
        let (a, b): (f64, f64) = (a.into(), b.into());
        let (near, far) = if a < b { (a, b) } else { (b, a) };
        if far > BEHIND * near && !is_hole(near) && !is_hole(far) {
            edges.push(Edge { near, far });
        }
    };
    for y in 0..range.height() {
        cancel::check();
        let row = range.row(y);
        row.windows(2).for_each(|pair| look(pair[0], pair[1]));
        if y + 1 < range.height() {
            row.iter().zip(range.row(y + 1)).for_each(|(&a, &b)| look(a, b));
        }
    }
    edges
}

/// Ranges of equal ratio between the nearest and the farthest.
fn candidates<T: Copy + Into<f64>>(range: &Plane<T>) -> Vec<f64> {
    let valid = range.data().iter().map(|&z| z.into()).filter(|&z| !is_hole(z));
    let (nearest, farthest) = valid.fold((f64::INFINITY, 0.0f64), |(near, far), z| {
        (near.min(z), far.max(z))
    });
    let share = |q: usize| (q as f64 + 0.5) / CANDIDATES as f64;
    (0..CANDIDATES)
        .map(|q| nearest * (farthest / nearest).powf(share(q)))
        .collect()
}

/// The candidate that serves the most edges, the nearest of equals; `None` if all serve 0.
fn most_served(edges: &[Edge], candidates: &[f64]) -> Option<f64> {
    let mut starts = vec![0i64; candidates.len() + 1];
    for edge in edges {
        let end = edge.far.min(NEAR * edge.near);
        starts[candidates.partition_point(|&cut| cut < edge.near)] += 1;
        starts[candidates.partition_point(|&cut| cut < end)] -= 1;
    }
    let mut served = 0;
    let mut best = (0, None);
    for (&cut, start) in candidates.iter().zip(starts) {
        served += start;
        if served > best.0 {
            best = (served, Some(cut));
        }
    }
    best.1
}

/// The middle value, of an even number the mean of the middle two.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len().is_multiple_of(2) {
        (values[middle - 1] + values[middle]) / 2.0
    } else {
        values[middle]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pole_before_a_wall_is_one_cut_with_its_gate_at_the_pole() {
        let range = Plane::from_fn(20, 6, |x, _| if (8..12).contains(&x) { 1.5f32 } else { 9.0 });
        let layering = Layering::find(&range, 3).unwrap();
        assert_eq!((layering.count(), layering.gates_m[0]), (2, 1.5));
        assert!((1.5..2.25).contains(&layering.cuts_m[0]));
        assert_eq!(
            [1.5, 9.0, f64::NAN, f64::INFINITY].map(|z| layering.layer_of(z)),
            [0, 1, 2, 2]
        );
        assert_eq!(layering.spans_m, [Some((1.5, 1.5)), Some((9.0, 9.0))]);
    }

    #[test]
    fn what_hides_nothing_has_no_layers() {
        let slope = Plane::from_fn(40, 5, |x, _| 1.0 + 0.1 * x as f32);
        assert_eq!(Layering::find(&slope, 4), None);
        let holes = Plane::from_fn(9, 9, |x, _| if x % 2 == 0 { 2.0f32 } else { f32::NAN });
        assert_eq!(Layering::find(&holes, 4), None);
        let step = Plane::from_fn(9, 9, |x, _| if x < 4 { 2.0f32 } else { 7.0 });
        assert_eq!(Layering::find(&step, 1), None);
    }

    #[test]
    fn there_are_never_more_layers_than_asked_for() {
        let stairs = Plane::from_fn(60, 30, |x, _| 0.5 * 1.6f32.powi(x as i32 / 8));
        for most in 2..=4 {
            let layering = Layering::find(&stairs, most).unwrap();
            assert_eq!(layering.count(), most);
            assert!(layering.cuts_m.is_sorted() && layering.gates_m.is_sorted());
            let pairs = layering.gates_m.iter().zip(&layering.cuts_m);
            assert!(
                pairs
                    .into_iter()
                    .all(|(gate, cut)| gate <= cut && *cut < 1.5 * gate)
            );
        }
    }
}
