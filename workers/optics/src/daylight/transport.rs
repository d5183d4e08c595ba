//! Daylight in open water by radiative transfer: the radiance in every direction at a depth.
//!
//! The sea is flat, its bottom level and Lambertian or infinitely deep, and nothing depends on the azimuth but the sun, whose light
//! is kept apart until it is scattered once. Radiance L in the direction μ that one looks in (cosine from the vertical, 1 up) obeys
//!
//! ```text
//! L(s) along a ray: dL/ds = −c L + S,   c = a + w b,   S(z, μ) = b ∫ p(μ, μ') L(z, μ') dμ'
//! ```
//!
//! with p the phase function without its forward peak and w its share ([`WideScattering`]): what is scattered by less than 25° counts as
//! not scattered. The equation is iterated by order of scattering on 28 Gauss–Legendre directions, whose intervals end at the horizon and
//! at the critical angle, and on layers between the surface and the bottom, or 5 attenuation lengths below the camera.

mod exchange;

use std::f64::consts::{PI, TAU};

use super::model::{CRITICAL_COSINE, fresnel};
use super::sun::SunLight;

use exchange::sky_irradiance;
pub(super) use exchange::{DIRECTIONS, Exchange, FIRST_UP, azimuth_mean};

/// Layers above and below the camera.
const ABOVE: usize = 24;
const BELOW: usize = 24;
const LAYERS: usize = ABOVE + BELOW + 1;
/// Attenuation lengths below the camera that take part.
const DEEPEST: f64 = 5.0;
/// Orders of scattering end when the last changes no radiance by more than this share of the largest.
const ENOUGH: f64 = 1e-4;
const MOST_ORDERS: usize = 200;

type Field = [[f64; DIRECTIONS]; LAYERS];

/// The sea above the camera.
#[derive(Debug, Clone, Copy)]
pub(super) struct Above {
    /// Depth of the camera, m.
    pub(super) depth: f64,
    pub(super) sun: Option<SunLight>,
    /// The bottom: its distance below the camera, m, and its reflectance.
    pub(super) bottom: Option<(f64, f64)>,
}

/// Daylight at the camera where the irradiance of sun and sky just below the surface is 1.
#[derive(Debug, Clone)]
pub(super) struct Radiance {
    /// c = a + w b, 1/m.
    pub(super) attenuation: f64,
    /// Downwelling irradiance.
    pub(super) irradiance: f64,
    /// Irradiance of the sun at right angles to it.
    pub(super) sun: f64,
    /// Radiance of an even sky in the water before the surface reflects a part of it.
    pub(super) sky: f64,
    /// Radiance in each direction without the direct sun.
    pub(super) total: [f64; DIRECTIONS],
    /// S at the camera without singly scattered sunlight.
    pub(super) source: [f64; DIRECTIONS],
    /// The part of S that comes from singly scattered sunlight.
    pub(super) twice: [f64; DIRECTIONS],
    /// The same light scattered along the whole ray, up to the surface or down to the bottom.
    pub(super) path: [f64; DIRECTIONS],
    /// Radiance below the surface in the mirrored direction, for directions that look up.
    pub(super) mirrored: [f64; DIRECTIONS],
}

impl Exchange {
    /// The light at the camera in water of this absorption and scattering.
    pub(super) fn solve(&self, absorption: f64, scattering: f64, above: Above) -> Radiance {
        Solver::new(self, absorption, scattering, above).run()
    }
}

/// `(1 − e^{−k z})/k`, the length of a ray as its light arrives.
pub(super) fn effective_length(rate: f64, length: f64) -> f64 {
    let x = rate * length;
    if x.abs() < 1e-6 {
        length * (1.0 - 0.5 * x)
    } else {
        -(-x).exp_m1() / rate
    }
}

/// The path of light through a layer whose source is linear in depth, from the far end to the near one.
#[derive(Clone, Copy)]
struct Pass {
    /// Share of the light at the far end.
    through: f64,
    /// Factors of the source at the far and the near end, m.
    source: [f64; 2],
}

impl Pass {
    fn new(attenuation: f64, length: f64) -> Self {
        let x = attenuation * length;
        if x < 1e-6 {
            return Self {
                through: 1.0,
                source: [0.5 * length; 2],
            };
        }
        let through = (-x).exp();
        let far = (1.0 - (1.0 + x) * through) / x;
        let near = (1.0 - through) - far;
        Self {
            through,
            source: [far / attenuation, near / attenuation],
        }
    }

    fn apply(&self, [far, near]: [f64; 2], light: f64) -> f64 {
        light * self.through + far * self.source[0] + near * self.source[1]
    }
}

struct Solver<'a> {
    exchange: &'a Exchange,
    attenuation: f64,
    scattering: f64,
    above: Above,
    /// Distance of the lowest layer below the camera, m, and its reflectance if it is the bottom.
    lowest: f64,
    reflectance: Option<f64>,
    depths: [f64; LAYERS],
    sky: f64,
    /// Irradiance of the sun at right angles to it, just below the surface.
    sun: f64,
    /// Mean phase function between each direction and the sun.
    sunny: [f64; DIRECTIONS],
    /// How light passes between each layer and the one below it in each direction.
    passes: [[Pass; DIRECTIONS]; LAYERS - 1],
    /// Light that no order adds to: the sky through the surface, and singly scattered sunlight.
    first: Field,
}

impl<'a> Solver<'a> {
    fn new(exchange: &'a Exchange, absorption: f64, scattering: f64, above: Above) -> Self {
        let attenuation = (absorption + exchange.wide.share * scattering).max(1e-9);
        let deepest = DEEPEST / attenuation;
        let bottom = above.bottom.filter(|(below, _)| *below < deepest);
        let lowest = bottom.map_or(deepest, |(below, _)| below);
        let below = lowest / BELOW as f64;
        let depths: [f64; LAYERS] = std::array::from_fn(|k| {
            if k <= ABOVE {
                above.depth * k as f64 / ABOVE as f64
            } else {
                above.depth + below * (k - ABOVE) as f64
            }
        });
        let share = above.sun.map_or(0.0, |sun| sun.share);
        let mut solver = Self {
            exchange,
            attenuation,
            scattering,
            above,
            lowest,
            reflectance: bottom.map(|(_, reflectance)| reflectance),
            depths,
            sky: (1.0 - share) / sky_irradiance(&exchange.directions),
            sun: above.sun.map_or(0.0, |sun| sun.share / sun.rise),
            sunny: exchange.directions.map(|direction| {
                let mean =
                    |sun: SunLight| azimuth_mean(direction.rise, sun.rise, |x| exchange.wide.density(x));
                above.sun.map_or(0.0, mean)
            }),
            passes: std::array::from_fn(|k| {
                let meters = (depths[k] - depths[k + 1]).abs();
                exchange
                    .directions
                    .map(|direction| Pass::new(attenuation, meters / direction.rise.abs()))
            }),
            first: [[0.0; DIRECTIONS]; LAYERS],
        };
        solver.first = solver.first_light();
        solver
    }

    fn first_light(&self) -> Field {
        self.depths.map(|depth| {
            let sunlit = self.sunlit_layer(depth);
            std::array::from_fn(|j| self.sky_at(depth, self.exchange.directions[j].rise) + sunlit[j])
        })
    }

    /// Singly scattered sunlight in every direction.
    fn sunlit_layer(&self, depth: f64) -> [f64; DIRECTIONS] {
        std::array::from_fn(|j| self.sunlight_at(depth, self.exchange.directions[j].rise, self.sunny[j]))
    }

    fn sky_at(&self, depth: f64, rise: f64) -> f64 {
        if rise <= CRITICAL_COSINE {
            return 0.0;
        }
        self.sky * (1.0 - fresnel(rise)) * (-self.attenuation * depth / rise).exp()
    }

    fn sun_at(&self, depth: f64) -> f64 {
        let rise = self.above.sun.map_or(1.0, |sun| sun.rise);
        self.sun * (-self.attenuation * depth / rise).exp()
    }

    /// Sunlight scattered once along a ray, for this phase function between the ray and the sun.
    fn sunlight_at(&self, depth: f64, rise: f64, density: f64) -> f64 {
        let Some(sun) = self.above.sun else { return 0.0 };
        let rate = self.attenuation * (1.0 - rise / sun.rise);
        let length = if rise > 0.0 {
            effective_length(rate, depth / rise)
        } else if self.reflectance.is_some() {
            effective_length(rate, (self.depths[LAYERS - 1] - depth) / -rise)
        } else {
            1.0 / rate
        };
        self.scattering * density * self.sun_at(depth) * length
    }

    /// S of light.
    fn source(&self, light: &Field) -> Field {
        light.map(|layer| self.scatter(&layer))
    }

    fn scatter(&self, light: &[f64; DIRECTIONS]) -> [f64; DIRECTIONS] {
        self.exchange.kernel.map(|row| {
            let sum: f64 = row.iter().zip(light).map(|(kernel, light)| kernel * light).sum();
            self.scattering * sum
        })
    }

    /// Light of a source along every ray: downward rays begin deep below, upward ones at the surface, which mirrors what arrives there.
    fn gather(&self, source: &Field, mirrored: &[f64; DIRECTIONS], bottom: Option<f64>) -> Field {
        let mut light = [[0.0; DIRECTIONS]; LAYERS];
        for j in 0..FIRST_UP {
            let rise = self.exchange.directions[j].rise;
            light[LAYERS - 1][j] =
                bottom.unwrap_or(source[LAYERS - 1][j] / (self.attenuation * (1.0 - rise)));
            for k in (0..LAYERS - 1).rev() {
                let sources = [source[k + 1][j], source[k][j]];
                light[k][j] = self.passes[k][j].apply(sources, light[k + 1][j]);
            }
        }
        for j in FIRST_UP..DIRECTIONS {
            let rise = self.exchange.directions[j].rise;
            light[0][j] = fresnel(rise) * mirrored[j];
            for k in 1..LAYERS {
                let sources = [source[k - 1][j], source[k][j]];
                light[k][j] = self.passes[k - 1][j].apply(sources, light[k - 1][j]);
            }
        }
        light
    }

    /// Upwelling light at the surface in the mirror image of every direction that looks up.
    fn mirror(&self, light: &Field) -> [f64; DIRECTIONS] {
        let directions = &self.exchange.directions;
        std::array::from_fn(|j| {
            let rise = -directions[j].rise;
            if rise > 0.0 {
                return 0.0;
            }
            // Directions rise with their number.
            let next = directions[1..FIRST_UP - 1].partition_point(|direction| direction.rise < rise) + 1;
            let [low, high] = [next - 1, next].map(|k| directions[k].rise);
            let share = (rise - low) / (high - low);
            let [below, above] = [light[0][next - 1], light[0][next]];
            (below + (above - below) * share).max(0.0)
        })
    }

    /// Radiance of the bottom.
    fn bottom_light(&self, light: &Field) -> Option<f64> {
        Some(self.reflectance? / PI * self.irradiance(light, LAYERS - 1))
    }

    /// Downwelling irradiance of a layer.
    fn irradiance(&self, light: &Field, layer: usize) -> f64 {
        let directions = self.exchange.directions.iter().zip(&light[layer]);
        let diffuse = directions
            .filter(|(direction, _)| direction.rise > 0.0)
            .map(|(direction, light)| light * direction.rise * direction.weight);
        let direct = self
            .above
            .sun
            .map_or(0.0, |sun| sun.rise * self.sun_at(self.depths[layer]));
        TAU * diffuse.sum::<f64>() + direct
    }

    fn run(self) -> Radiance {
        let mut rest = [[0.0; DIRECTIONS]; LAYERS];
        let mut all = self.first;
        for _ in 0..MOST_ORDERS {
            let next = self.gather(&self.source(&all), &self.mirror(&all), self.bottom_light(&all));
            let change = largest(
                next.iter()
                    .flatten()
                    .zip(rest.iter().flatten())
                    .map(|(a, b)| (a - b).abs()),
            );
            rest = next;
            all = std::array::from_fn(|k| std::array::from_fn(|j| self.first[k][j] + rest[k][j]));
            if change <= ENOUGH * largest(rest.iter().flatten().copied()) {
                break;
            }
        }
        self.at_camera(&all, &rest)
    }

    fn at_camera(&self, all: &Field, rest: &Field) -> Radiance {
        let depth = self.above.depth;
        let directions = &self.exchange.directions;
        Radiance {
            attenuation: self.attenuation,
            // Kilometers down the last digits run out.
            irradiance: self.irradiance(all, ABOVE).max(f64::MIN_POSITIVE),
            sun: self.sun_at(depth),
            sky: self.sky,
            total: all[ABOVE],
            source: self.scatter(&all[ABOVE]),
            twice: self.scatter(&self.sunlit_layer(depth)),
            path: std::array::from_fn(|j| {
                let rise = directions[j].rise;
                let (end, meters) = if rise > 0.0 {
                    (rest[0][j], depth / rise)
                } else {
                    (
                        self.reflectance.map_or(0.0, |_| rest[LAYERS - 1][j]),
                        self.lowest / -rise,
                    )
                };
                let from_end = end * (-self.attenuation * meters).exp();
                (rest[ABOVE][j] - from_end).max(0.0)
            }),
            mirrored: self.mirror(all),
        }
    }
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, f64::max)
}
