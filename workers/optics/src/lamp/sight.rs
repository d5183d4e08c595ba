//! Visible share of a lamp from each point of a batch, in f32.

use std::ops::Range;

use imaging::rays::{Rays, ShadowRays};
use imaging::vectorized;

use super::shadow::on_unit_disc;

/// Rim samples of a disc, traced first: if all or none of them are occluded, the others are assumed equal. An occluder that covers
/// a part of a disc but no rim sample is thinner than the disc.
const FIRST: usize = 5;
/// Starts whose rays to all samples are neighbors in the list: a packet of rays.
const NEIGHBORS: usize = 64;

/// Traces shadow rays through a scene and keeps its allocations.
pub(super) struct Sight<'a> {
    rays: &'a dyn Rays,
    ways: ShadowRays,
    clear: Vec<bool>,
    undecided: Vec<usize>,
}

/// Ray origins, offset from the surfaces there: one coordinate axis after the other.
#[derive(Default)]
pub(super) struct Starts {
    axes: [Vec<f32>; 3],
}

impl Starts {
    pub(super) fn clear(&mut self) {
        self.axes.iter_mut().for_each(Vec::clear);
    }

    pub(super) fn push(&mut self, place: [f32; 3]) {
        self.axes.iter_mut().zip(place).for_each(|(axis, v)| axis.push(v));
    }

    pub(super) fn len(&self) -> usize {
        self.axes[0].len()
    }
}

/// The radius of the disc of each start, m.
#[derive(Clone, Copy)]
pub(super) enum Radius<'a> {
    Same(f32),
    Of(&'a [f32]),
}

impl Radius<'_> {
    /// Those of some of the starts.
    fn select(&self, starts: Range<usize>) -> Radius<'_> {
        match self {
            Self::Same(radius_m) => Radius::Same(*radius_m),
            Self::Of(radii) => Radius::Of(&radii[starts]),
        }
    }
}

/// A disc about a lamp, perpendicular to the ray to it: its samples in units of its radius, outermost first.
pub(super) struct Disc {
    places: Vec<[f32; 2]>,
}

impl Disc {
    /// A disc of `count` samples; a single one is its center.
    pub(super) fn new(count: usize) -> Self {
        let place = |k| on_unit_disc(k, count).map(|v| v as f32);
        let places = match count {
            0 | 1 => vec![[0.0; 2]],
            _ => (0..count).rev().map(place).collect(),
        };
        Self { places }
    }
}

impl<'a> Sight<'a> {
    pub(super) fn new(rays: &'a dyn Rays) -> Self {
        Self {
            rays,
            ways: ShadowRays::default(),
            clear: Vec::new(),
            undecided: Vec::new(),
        }
    }

    /// Sets for each start which share of a disc about `middle` is seen from it; `radius_m` is that of the disc for each start.
    pub(super) fn shares(
        &mut self,
        starts: &Starts,
        middle: [f32; 3],
        (disc, radius_m): (&Disc, Radius<'_>),
        shares: &mut Vec<f32>,
    ) {
        let first = FIRST.min(disc.places.len());
        let (rim, rest) = disc.places.split_at(first);
        shares.clear();
        shares.resize(starts.len(), 0.0);
        self.count_clear(&starts.axes, (rim, middle), radius_m, shares);
        if rest.is_empty() {
            let unit = 1.0 / first as f32;
            shares.iter_mut().for_each(|share| *share *= unit);
            return;
        }
        let whole = first as f32;
        let mut undecided = std::mem::take(&mut self.undecided);
        undecided.clear();
        undecided.extend((0..starts.len()).filter(|&i| shares[i] > 0.0 && shares[i] < whole));
        let of = |lane: &[f32]| undecided.iter().map(|&i| lane[i]).collect::<Vec<_>>();
        let radii = match radius_m {
            Radius::Of(radii) => of(radii),
            Radius::Same(_) => Vec::new(),
        };
        let radius_m = match radius_m {
            Radius::Of(_) => Radius::Of(&radii),
            same => same,
        };
        let mut more = vec![0.0f32; undecided.len()];
        let open = starts.axes.each_ref().map(|axis| of(axis));
        self.count_clear(&open, (rest, middle), radius_m, &mut more);
        let mut is_open = undecided.iter().zip(&more).peekable();
        for (i, share) in shares.iter_mut().enumerate() {
            *share = match is_open.next_if(|(at, _)| **at == i) {
                Some((_, more)) => (*share + more) * (1.0 / disc.places.len() as f32),
                None => *share * (1.0 / whole),
            };
        }
        self.undecided = undecided;
    }

    /// Adds the number of clear rays from each start to samples of a disc. Rays from the same starts are neighbors in the list.
    fn count_clear(
        &mut self,
        starts: &[Vec<f32>; 3],
        (places, middle): (&[[f32; 2]], [f32; 3]),
        radius_m: Radius<'_>,
        counts: &mut [f32],
    ) {
        for (at, counts) in counts.chunks_mut(NEIGHBORS).enumerate() {
            let own = at * NEIGHBORS..at * NEIGHBORS + counts.len();
            self.ways.clear();
            for &place in places {
                self.add_ways(
                    starts.each_ref().map(|axis| &axis[own.clone()]),
                    place,
                    middle,
                    radius_m.select(own.clone()),
                );
            }
            self.look();
            for clear in self.clear.chunks(counts.len()) {
                vectorized!(count(clear, counts));
            }
        }
    }

    /// Adds rays from each start to a sample of its disc.
    fn add_ways(&mut self, starts: [&[f32]; 3], place: [f32; 2], middle: [f32; 3], radius_m: Radius<'_>) {
        let ShadowRays { from, to } = &mut self.ways;
        let (first, count) = (from[0].len(), starts[0].len());
        from.iter_mut()
            .zip(starts)
            .for_each(|(axis, own)| axis.extend_from_slice(own));
        to.iter_mut()
            .zip(middle)
            .for_each(|(axis, v)| axis.resize(first + count, v));
        let mut to = to.each_mut().map(|axis| &mut axis[first..]);
        match radius_m {
            Radius::Same(0.0) => {}
            Radius::Same(radius_m) => vectorized!(ends(starts, &mut to, middle, place, |_| radius_m)),
            Radius::Of(radii) => vectorized!(ends(starts, &mut to, middle, place, |i| radii[i])),
        }
    }

    /// Sets for each ray whether it is clear.
    pub(super) fn look_along(&mut self, fill: impl FnOnce(&mut ShadowRays)) -> &[bool] {
        self.ways.clear();
        fill(&mut self.ways);
        self.look();
        &self.clear
    }

    fn look(&mut self) {
        self.clear.clear();
        self.clear.resize(self.ways.len(), false);
        self.rays.trace_shadow_rays(&self.ways, &mut self.clear);
    }
}

#[inline(always)]
fn count(clear: &[bool], shares: &mut [f32]) {
    for (share, clear) in shares.iter_mut().zip(clear) {
        *share += f32::from(u8::from(*clear));
    }
}

/// [`across`] of many starts.
#[inline(always)]
fn ends(
    [x, y, z]: [&[f32]; 3],
    to: &mut [&mut [f32]; 3],
    middle: [f32; 3],
    place: [f32; 2],
    radius_m: impl Fn(usize) -> f32,
) {
    let count = x.len();
    let (y, z) = (&y[..count], &z[..count]);
    let [to_x, to_y, to_z] = to.each_mut().map(|lane| &mut lane[..count]);
    for i in 0..count {
        [to_x[i], to_y[i], to_z[i]] = across([x[i], y[i], z[i]], middle, place, radius_m(i));
    }
}

/// A sample in units of the radius on a disc about `middle`, perpendicular to the ray from `start`: as
/// [`disc_place`](super::shadow::disc_place).
#[inline(always)]
pub(super) fn across(start: [f32; 3], middle: [f32; 3], [u, v]: [f32; 2], radius_m: f32) -> [f32; 3] {
    let way = [0, 1, 2].map(|i| middle[i] - start[i]);
    let meters = (way[0] * way[0] + way[1] * way[1] + way[2] * way[2]).sqrt();
    // At the lamp the direction is undefined and any will do.
    let length = if meters == 0.0 { 1.0 } else { meters };
    let radius_m = if meters == 0.0 { 0.0 } else { radius_m };
    let [x, y, z] = way.map(|v| v / length);
    let sign = if z >= 0.0 { 1.0 } else { -1.0 };
    let a = -1.0 / (sign + z);
    let b = x * y * a;
    let first = [1.0 + sign * x * x * a, sign * b, -sign * x];
    let second = [b, sign + y * y * a, -y];
    [0, 1, 2].map(|i| middle[i] + radius_m * (u * first[i] + v * second[i]))
}

#[cfg(test)]
mod tests {
    use imaging::rays::Hit;

    use super::super::shadow::{disc_place, share_seen};
    use super::*;

    /// Everything with x above 0 is solid.
    struct Half;

    impl Rays for Half {
        fn hit(&self, origin: [f64; 3], direction: [f64; 3], from: f64, to: f64) -> Option<Hit> {
            let distance = -origin[0] / direction[0];
            (origin[0] < 0.0 && distance >= from && distance <= to).then_some(Hit {
                distance,
                normal: [-1.0, 0.0, 0.0],
                object: 0,
            })
        }
    }

    #[test]
    fn places_and_shares_are_those_of_the_reference() {
        for count in [1, 4, 16, 21] {
            let disc = Disc::new(count);
            let mut sight = Sight::new(&Half);
            let (middle, radius_m) = ([0.0, 0.5, 0.25], if count == 1 { 0.0 } else { 0.5 });
            let places: Vec<[f32; 3]> = (0..40)
                .map(|i| [-0.01 - 0.03 * i as f32, 0.1 * i as f32 - 2.0, 3.0])
                .collect();
            let mut starts = Starts::default();
            places.iter().for_each(|place| starts.push(*place));
            let (mut shares, mut each) = (Vec::new(), Vec::new());
            let radii = vec![radius_m as f32; starts.len()];
            sight.shares(
                &starts,
                middle,
                (&disc, Radius::Same(radius_m as f32)),
                &mut shares,
            );
            sight.shares(&starts, middle, (&disc, Radius::Of(&radii)), &mut each);
            assert_eq!(shares, each);
            for (start, share) in places.iter().zip(&shares) {
                let begin = imaging::rays::RayStart {
                    origin: start.map(f64::from),
                    from: 1e-5,
                };
                let exact = share_seen(&Half, begin, middle.map(f64::from), (radius_m, count));
                // A cap beyond all rim samples is not sampled.
                let cap = if count > FIRST { 2.0 / count as f64 } else { 0.0 };
                assert!(
                    (exact - f64::from(*share)).abs() < cap + 1e-6,
                    "{count} {start:?}: {share} for {exact}"
                );
            }
            assert!(count == 1 || shares.iter().any(|&share| share > 0.0 && share < 1.0));
        }
        let way = [1.0f64, 2.0, 2.0].map(|v| v / 3.0);
        let exact: Vec<[f64; 3]> = (0..4)
            .map(|k| disc_place([1.0, 2.0, 3.0], way, 2.0, (k, 4)))
            .collect();
        let fast: Vec<[f32; 3]> = (0..4)
            .map(|k| {
                across(
                    [0.0, 0.0, 1.0],
                    [1.0, 2.0, 3.0],
                    on_unit_disc(k, 4).map(|v| v as f32),
                    2.0,
                )
            })
            .collect();
        for (fast, exact) in fast.iter().zip(&exact) {
            assert!(
                (0..3).all(|i| (f64::from(fast[i]) - exact[i]).abs() < 1e-5),
                "{fast:?} {exact:?}"
            );
        }
    }
}
