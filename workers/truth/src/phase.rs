//! The phase function as a table of bins, so that sampling and evaluation agree exactly.

use std::f64::consts::PI;

use imaging::vector::{DVec3, vec3};
use optics::lamp::FournierForand;

/// Bins in the scattering angle, evenly spaced in its logarithm.
const BINS: usize = 1024;
/// Upper edge of the first bin, rad.
const FIRST: f64 = 1e-4;
/// The steepest Henyey–Greenstein function resolved by the bins.
const STEEPEST: f64 = 0.98;

/// Phase function, constant within each of 1024 bins of the scattering angle, normalized over the sphere.
///
/// Angles are `1 − cos`, since the cosine loses the digits of small ones.
#[derive(Debug, Clone, PartialEq)]
pub struct Phase {
    /// 1 − cos at the edges, from 0 to 2.
    edges: Vec<f64>,
    /// Cumulative share of the scattered light at each edge, from 0 to 1.
    shares: Vec<f64>,
    /// Density of each bin, 1/sr.
    densities: Vec<f64>,
    /// The scattering angles at the edges, rad.
    angles: Vec<f64>,
    /// Angles toward a point.
    outside: AngleTable,
    /// Angles toward an extended source on a line through it.
    inside: AngleTable,
}

/// A density of scattering angles, constant within each bin.
#[derive(Debug, Clone, PartialEq)]
struct AngleTable {
    /// The density of each bin, up to a factor.
    densities: Vec<f64>,
    /// Its integral up to each edge.
    integrals: Vec<f64>,
}

impl AngleTable {
    fn new(densities: Vec<f64>, angles: &[f64]) -> Self {
        let mut integrals = vec![0.0; BINS + 1];
        for k in 0..BINS {
            integrals[k + 1] = integrals[k] + densities[k] * (angles[k + 1] - angles[k]);
        }
        Self { densities, integrals }
    }
}

/// Scattering angles along a segment that a lamp illuminates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct AngleRange {
    /// Least and greatest angle, rad.
    pub(crate) ends: [f64; 2],
    /// Whether the line crosses the lamp: then the angle is that of its radius, and the light that of the cone it fills.
    pub(crate) is_inside: bool,
}

/// A scattering angle drawn from p between two angles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct DrawnAngle {
    /// The angle, rad.
    pub(crate) angle: f64,
    /// Its density, 1/rad.
    pub(crate) density: f64,
}

impl Phase {
    /// Henyey and Greenstein 1941, asymmetry g clamped to −0.98..=0.98.
    #[must_use]
    pub fn henyey_greenstein(g: f64) -> Self {
        let g = g.clamp(-STEEPEST, STEEPEST);
        Self::from_shares(|v| henyey_greenstein_within(g, v))
    }

    /// Fournier and Forand, as formulated by Fournier and Jonasz 1999.
    #[must_use]
    pub fn fournier_forand(law: FournierForand) -> Self {
        Self::from_shares(|v| law.within(v))
    }

    /// Tabulates a function for the share of light scattered within an angle, given as 1 − cos, up to a factor.
    fn from_shares(within: impl Fn(f64) -> f64) -> Self {
        let angles: Vec<f64> = (0..=BINS)
            .map(|k| match k {
                0 => 0.0,
                k => FIRST * (PI / FIRST).powf((k - 1) as f64 / (BINS - 1) as f64),
            })
            .collect();
        let mut edges: Vec<f64> = angles
            .iter()
            .map(|angle| 2.0 * (0.5 * angle).sin().powi(2))
            .collect();
        edges[BINS] = 2.0;
        let whole = within(2.0);
        let mut shares: Vec<f64> = edges.iter().map(|&v| within(v) / whole).collect();
        (shares[0], shares[BINS]) = (0.0, 1.0);
        let densities = (0..BINS).map(|k| {
            let (low, high) = (angles[k], angles[k + 1]);
            let width = 4.0 * PI * (0.5 * (low + high)).sin() * (0.5 * (high - low)).sin();
            (shares[k + 1] - shares[k]).max(0.0) / width
        });
        let densities: Vec<f64> = densities.collect();
        let cones = (0..BINS).map(|k| {
            if edges[k + 1] <= 1.0 {
                shares[k + 1] / (2.0 * PI * edges[k + 1])
            } else {
                densities[k]
            }
        });
        Self {
            inside: AngleTable::new(cones.collect(), &angles),
            outside: AngleTable::new(densities.clone(), &angles),
            densities,
            edges,
            shares,
            angles,
        }
    }

    /// p in 1/sr at a scattering angle of `1 − cos`.
    #[must_use]
    pub fn density(&self, versine: f64) -> f64 {
        self.densities[bin(&self.edges, versine)]
    }

    /// The share of the light scattered within an angle of `1 − cos`.
    #[must_use]
    pub fn share_within(&self, versine: f64) -> f64 {
        let k = bin(&self.edges, versine);
        let part = (versine - self.edges[k]) / (self.edges[k + 1] - self.edges[k]);
        self.shares[k] + part.clamp(0.0, 1.0) * (self.shares[k + 1] - self.shares[k])
    }

    /// p toward an extended source: inside the cone of half angle `1 − cos = cone` the mean over the cone, otherwise p.
    /// Without it the forward peak has unbounded variance.
    #[must_use]
    pub fn density_toward(&self, versine: f64, cone: f64) -> f64 {
        if versine < cone {
            self.share_within(cone) / (2.0 * PI * cone)
        } else {
            self.density(versine)
        }
    }

    /// `1 − cos` of a random scattering angle, from a random number in [0, 1).
    #[must_use]
    pub fn draw(&self, unit: f64) -> f64 {
        let k = bin(&self.shares, unit);
        let part = (unit - self.shares[k]) / (self.shares[k + 1] - self.shares[k]);
        self.edges[k] + part * (self.edges[k + 1] - self.edges[k])
    }

    /// A random angle of a range, from a random number in [0, 1): in proportion to p, or inside a source to the mean of p over the cone
    /// that it fills. `None` if the density is 0 in the whole range.
    #[must_use]
    pub(crate) fn draw_angle(&self, range: AngleRange, unit: f64) -> Option<DrawnAngle> {
        let table = if range.is_inside {
            &self.inside
        } else {
            &self.outside
        };
        let [low, high] = range.ends;
        let below = self.integral(table, low);
        let whole = self.integral(table, high) - below;
        if whole <= 0.0 {
            return None;
        }
        let sought = below + unit * whole;
        let k = bin(&table.integrals, sought);
        let angle = self.angles[k] + (sought - table.integrals[k]) / table.densities[k];
        (table.densities[k] > 0.0).then(|| DrawnAngle {
            angle: angle.clamp(low, high),
            density: table.densities[k] / whole,
        })
    }

    /// The integral of a table from 0 to an angle.
    fn integral(&self, table: &AngleTable, angle: f64) -> f64 {
        let k = bin(&self.angles, angle);
        table.integrals[k] + table.densities[k] * (angle - self.angles[k])
    }

    /// A random direction around a unit vector, from two random numbers.
    #[must_use]
    pub(crate) fn turn(&self, axis: DVec3, [angle, azimuth]: [f64; 2]) -> DVec3 {
        tilt(axis, self.draw(angle), azimuth)
    }

    /// b_b/b: the share of the light scattered backward.
    #[must_use]
    pub fn backscatter_fraction(&self) -> f64 {
        1.0 - self.share_within(1.0)
    }

    /// Mean cosine of the scattering angle.
    #[must_use]
    pub fn mean_cosine(&self) -> f64 {
        let bins = self.edges.windows(2).zip(self.shares.windows(2));
        bins.map(|(edge, share)| (share[1] - share[0]) * (1.0 - 0.5 * (edge[0] + edge[1])))
            .sum()
    }
}

/// The bin of a value between ascending edges.
fn bin(edges: &[f64], value: f64) -> usize {
    edges.partition_point(|&edge| edge <= value).clamp(1, BINS) - 1
}

/// Share within `1 − cos = v`; `(1 − g²)/(2g) (1/(1 − g) − 1/s)` without the cancellation.
fn henyey_greenstein_within(g: f64, v: f64) -> f64 {
    let s = ((1.0 - g) * (1.0 - g) + 2.0 * g * v).sqrt();
    (1.0 + g) * v / ((s + 1.0 - g) * s)
}

/// The unit vector at an angle of `1 − cos` from a unit vector, at an azimuth in turns (frame: Duff et al. 2017).
pub(crate) fn tilt(axis: DVec3, versine: f64, turns: f64) -> DVec3 {
    let sine = (versine * (2.0 - versine)).max(0.0).sqrt();
    let (sin, cos) = (2.0 * PI * turns).sin_cos();
    let sign = if axis.z >= 0.0 { 1.0 } else { -1.0 };
    let a = -1.0 / (sign + axis.z);
    let b = axis.x * axis.y * a;
    let first = vec3(1.0 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x);
    let second = vec3(b, sign + axis.y * axis.y * a, -axis.y);
    let turned = axis * (1.0 - versine) + first * (sine * cos) + second * (sine * sin);
    turned.normalized()
}

/// `1 − cos` of the angle between two unit vectors, accurate for small angles.
pub(crate) fn versine(a: DVec3, b: DVec3) -> f64 {
    let apart = a + -b;
    0.5 * apart.dot(apart)
}

#[cfg(test)]
mod tests {
    use super::*;
    use optics::lamp::{backscatter_fraction, henyey_greenstein};

    #[test]
    fn the_table_of_henyey_and_greenstein_is_their_function() {
        for g in [-0.4, 0.0, 0.5, 0.924] {
            let phase = Phase::henyey_greenstein(g);
            for degrees in [1.0, 10.0, 45.0, 90.0, 150.0, 179.0] {
                let cos = f64::to_radians(degrees).cos();
                let ratio = phase.density(1.0 - cos) / henyey_greenstein(g, cos);
                assert!((ratio - 1.0).abs() < 0.02, "g {g} at {degrees}: {ratio}");
            }
            assert!((phase.mean_cosine() - g).abs() < 1e-4, "{g}");
            assert!(
                (phase.backscatter_fraction() - backscatter_fraction(g)).abs() < 1e-4,
                "{g}"
            );
        }
    }

    #[test]
    fn angles_are_drawn_as_often_as_the_density_says() {
        let phase = Phase::fournier_forand(FournierForand::of_backscatter(0.0183));
        let draws = 200_000;
        let cuts = [1e-3f64, 0.01, 0.1, 0.5, 1.5].map(|angle| 1.0 - angle.cos());
        let dice = imaging::random::Stream::stage(1, "truth");
        let mut within = [0.0; 5];
        for i in 0..draws {
            let drawn = phase.draw(dice.unit(0, i));
            cuts.iter()
                .zip(&mut within)
                .for_each(|(cut, n)| *n += f64::from(u8::from(drawn < *cut)));
        }
        for (cut, within) in cuts.into_iter().zip(within) {
            let (expected, n) = (phase.share_within(cut), draws as f64);
            let error = (expected * (1.0 - expected) / n).sqrt();
            assert!((within / n - expected).abs() < 4.0 * error, "{cut}");
        }
        // The bins add up to the sphere.
        let sphere: f64 = (0..BINS)
            .map(|k| phase.densities[k] * 2.0 * PI * (phase.edges[k + 1] - phase.edges[k]))
            .sum();
        assert!((sphere - 1.0).abs() < 1e-9, "{sphere}");
    }

    #[test]
    fn angles_of_a_range_are_drawn_as_often_as_their_density_says() {
        let phase = Phase::fournier_forand(FournierForand::of_backscatter(0.0183));
        let draws = 20_000;
        for is_inside in [false, true] {
            let range = AngleRange {
                ends: [0.02, 1.3],
                is_inside,
            };
            // The mean of 1/density over the angles below a limit is the width of their interval.
            let mut widths = [0.0; 3];
            for i in 0..draws {
                let unit = (i as f64 + 0.5) / draws as f64;
                let drawn = phase.draw_angle(range, unit).expect("a positive density");
                for (limit, width) in [0.1, 0.6, 1.3].into_iter().zip(&mut widths) {
                    *width += f64::from(u8::from(drawn.angle <= limit)) / (drawn.density * draws as f64);
                }
            }
            for (limit, width) in [0.1, 0.6, 1.3].into_iter().zip(widths) {
                assert!((width / (limit - 0.02) - 1.0).abs() < 2e-3, "{limit}: {width}");
            }
        }
    }

    #[test]
    fn the_table_of_fournier_and_forand_keeps_its_backscatter_and_mean_cosine() {
        for fraction in [0.005, 0.01, 0.0183, 0.03] {
            let table = Phase::fournier_forand(FournierForand::of_backscatter(fraction));
            assert!(
                (table.backscatter_fraction() - fraction).abs() < 2e-4,
                "{fraction}"
            );
        }
        let average = Phase::fournier_forand(FournierForand::of_backscatter(0.0183));
        assert!((average.mean_cosine() - 0.930).abs() < 1e-3);
    }

    #[test]
    fn a_wide_source_sees_the_mean_over_its_cone() {
        let phase = Phase::henyey_greenstein(0.95);
        let cone = 1.0 - 0.02f64.cos();
        let steps = 20_000;
        let mean: f64 = (0..steps)
            .map(|i| phase.density(cone * (i as f64 + 0.5) / steps as f64))
            .sum::<f64>()
            / steps as f64;
        assert!((phase.density_toward(0.0, cone) / mean - 1.0).abs() < 1e-3);
        assert_eq!(phase.density_toward(0.5, cone), phase.density(0.5));
    }

    #[test]
    fn turned_directions_keep_their_angle_and_length() {
        for axis in [vec3(0.0, 0.0, 1.0), vec3(0.0, 0.0, -1.0), vec3(0.6, -0.8, 0.0)] {
            for v in [1e-9, 0.3, 1.999] {
                let turned = tilt(axis, v, 0.3);
                assert!((turned.length() - 1.0).abs() < 1e-14);
                assert!((versine(axis, turned) / v - 1.0).abs() < 1e-6, "{v}");
            }
        }
    }
}
