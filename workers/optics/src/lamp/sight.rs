//! How much of a lamp is seen from many places at once, in f32.

use imaging::rays::{Rays, Ways};

use super::shadow::on_unit_disc;

/// Places of a disc that are looked for first, on its rim: where all of them are seen, or none, the others are taken to be, too. What
/// covers a part of a disc but no place of its rim is thinner than the disc.
const FIRST: usize = 5;

/// Looks through a scene; keeps what it allocates.
pub(super) struct Sight<'a> {
    rays: &'a dyn Rays,
    ways: Ways,
    clear: Vec<bool>,
    undecided: Vec<usize>,
}

/// A disc about a lamp, across the way to it: its places in units of its radius, outermost first.
pub(super) struct Disc {
    places: Vec<[f32; 2]>,
}

impl Disc {
    /// A disc of so many places; a single one is its middle.
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
            ways: Ways::default(),
            clear: Vec::new(),
            undecided: Vec::new(),
        }
    }

    /// Sets for each start which share of a disc about `middle` is seen from it; `radius_m` is that of the disc for each start.
    pub(super) fn shares(
        &mut self,
        starts: &[[f32; 3]],
        middle: [f32; 3],
        (disc, radius_m): (&Disc, impl Fn(usize) -> f32),
        shares: &mut Vec<f32>,
    ) {
        let first = FIRST.min(disc.places.len());
        let (rim, rest) = disc.places.split_at(first);
        let all = |start: usize| (start, starts[start]);
        shares.clear();
        shares.resize(starts.len(), 0.0);
        self.count((0..starts.len()).map(all), middle, rim, &radius_m, shares);
        if rest.is_empty() {
            let unit = 1.0 / first as f32;
            shares.iter_mut().for_each(|share| *share *= unit);
            return;
        }
        let whole = first as f32;
        let mut undecided = std::mem::take(&mut self.undecided);
        undecided.clear();
        undecided.extend((0..starts.len()).filter(|&i| shares[i] > 0.0 && shares[i] < whole));
        self.count(
            undecided.iter().map(|&start| all(start)),
            middle,
            rest,
            &radius_m,
            shares,
        );
        let mut is_open = undecided.iter().copied().peekable();
        for (i, share) in shares.iter_mut().enumerate() {
            *share *= match is_open.next_if_eq(&i) {
                Some(_) => 1.0 / disc.places.len() as f32,
                None => 1.0 / whole,
            };
        }
        self.undecided = undecided;
    }

    /// Adds to the share of each start how many of these places are seen from it.
    fn count(
        &mut self,
        starts: impl Iterator<Item = (usize, [f32; 3])> + Clone,
        middle: [f32; 3],
        places: &[[f32; 2]],
        radius_m: &impl Fn(usize) -> f32,
        shares: &mut [f32],
    ) {
        // Ways to the same place of the disc, from neighbors, lie beside each other.
        for &place in places {
            self.ways.clear();
            for (i, start) in starts.clone() {
                self.ways.push(start, across(start, middle, place, radius_m(i)));
            }
            self.look();
            for ((i, _), clear) in starts.clone().zip(&self.clear) {
                shares[i] += f32::from(u8::from(*clear));
            }
        }
    }

    /// Sets for each way whether it is clear.
    pub(super) fn look_along(&mut self, fill: impl FnOnce(&mut Ways)) -> &[bool] {
        self.ways.clear();
        fill(&mut self.ways);
        self.look();
        &self.clear
    }

    fn look(&mut self) {
        self.clear.clear();
        self.clear.resize(self.ways.len(), false);
        self.rays.look(&self.ways, &mut self.clear);
    }
}

/// A place in units of the radius on a disc about `middle`, across the way to it from `start`: as
/// [`disc_place`](super::shadow::disc_place).
pub(super) fn across(start: [f32; 3], middle: [f32; 3], [u, v]: [f32; 2], radius_m: f32) -> [f32; 3] {
    let way = [0, 1, 2].map(|i| middle[i] - start[i]);
    let meters = way.iter().map(|v| v * v).sum::<f32>().sqrt();
    if radius_m == 0.0 || meters == 0.0 {
        return middle;
    }
    let [x, y, z] = way.map(|v| v / meters);
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
            let starts: Vec<[f32; 3]> = (0..40)
                .map(|i| [-0.01 - 0.03 * i as f32, 0.1 * i as f32 - 2.0, 3.0])
                .collect();
            let mut shares = Vec::new();
            sight.shares(&starts, middle, (&disc, |_| radius_m as f32), &mut shares);
            for (start, share) in starts.iter().zip(&shares) {
                let begin = imaging::rays::Start {
                    origin: start.map(f64::from),
                    from: 1e-5,
                };
                let exact = share_seen(&Half, begin, middle.map(f64::from), (radius_m, count));
                // A cap beyond all places of the rim is not looked for.
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
