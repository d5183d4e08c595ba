//! Frames whose light has to pass gates: waters from clear to opaque, plates before walls, slopes, noise and bright light.

use imaging::random::Stream;
use imaging::{Plane, Rgb};
use optics::medium::{Kernels, Medium};
use optics::water::Water;
use spec::{ForwardScatter, Optics, PhaseFunction, ScatterModel};

/// A frame and its plan's tolerance.
#[derive(Debug, Clone)]
pub(crate) struct Scene {
    pub(crate) name: String,
    pub(crate) radiance: Rgb<f32>,
    pub(crate) range: Plane<f32>,
    pub(crate) water: Water,
    pub(crate) tolerance: f64,
}

/// Coefficients of a gated water, 1/m and pixels.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Gated {
    pub(crate) absorption: f64,
    pub(crate) scattering: f64,
    /// G; derived if it is missing.
    pub(crate) g: Option<f64>,
    /// Two kernels by a phase function; else one kernel of these pixels per meter and at range 0.
    pub(crate) kernel: Kernel,
    pub(crate) focal_px: f64,
    pub(crate) layers: usize,
}

#[derive(Debug, Clone, Copy)]
pub(crate) enum Kernel {
    One { per_m: f64, offset: f64 },
    Two(PhaseFunction),
}

impl Gated {
    pub(crate) fn water(&self) -> Water {
        let (spread_px_per_m, spread_offset_px) = match self.kernel {
            Kernel::One { per_m, offset } => (Some([per_m; 3]), Some([offset; 3])),
            Kernel::Two(_) => (None, None),
        };
        let scatter = ForwardScatter {
            g_per_m: self.g.map(|g| [g; 3]),
            spread_px_per_m,
            spread_offset_px,
            ..ScatterModel::Jaffe.into()
        };
        let optics = Optics {
            absorption_per_m: Some([self.absorption; 3]),
            scattering_per_m: Some([self.scattering; 3]),
            veiling_light: Some([0.0; 3]),
            phase: match self.kernel {
                Kernel::One { .. } => PhaseFunction::default(),
                Kernel::Two(phase) => phase,
            },
            forward_scatter: Some(scatter),
            ..Optics::default()
        };
        let medium = Medium {
            kernels: match self.kernel {
                Kernel::One { .. } => Kernels::One,
                Kernel::Two(_) => Kernels::Two,
            },
            layers: Some(self.layers),
            ..optics.into()
        };
        Water::resolve(&medium, self.focal_px).expect("a consistent water")
    }
}

/// Random numbers of one scene, in order.
struct Draw {
    stream: Stream,
    index: u64,
    next: u64,
}

impl Draw {
    fn unit(&mut self) -> f64 {
        self.next += 1;
        self.stream.unit(self.index, self.next)
    }

    fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.unit()
    }

    /// Evenly spread logarithm.
    fn ratio(&mut self, least: f64, most: f64) -> f64 {
        least * (most / least).powf(self.unit())
    }

    fn below(&mut self, count: usize) -> usize {
        ((self.unit() * count as f64) as usize).min(count - 1)
    }

    fn happens(&mut self, chance: f64) -> bool {
        self.unit() < chance
    }
}

/// A frame so wide that occluded pixels are filled on coarse rows.
pub(crate) const WIDE: (usize, usize) = (640, 20);

/// Random scene number `index`, of a small frame if no size is given.
pub(crate) fn random_of_size(seed: u64, index: u64, size: Option<(usize, usize)>) -> Scene {
    let mut draw = Draw {
        stream: Stream::stage(seed, "gates"),
        index,
        next: 0,
    };
    let absorption = if draw.happens(0.3) {
        1e-6
    } else {
        draw.ratio(1e-3, 1.0)
    };
    let scattering = draw.ratio(0.02, 10.0);
    let attenuation = absorption + scattering;
    let g = match draw.below(4) {
        0 => Some(0.0),
        1 => Some(attenuation * draw.unit()),
        2 => Some(attenuation * draw.unit().powi(4)),
        _ => None,
    };
    let kernel = match draw.below(4) {
        0 => Kernel::Two(PhaseFunction::Ff),
        1 => Kernel::Two(PhaseFunction::Hg),
        2 => Kernel::One {
            per_m: draw.ratio(0.01, 30.0),
            offset: 0.0,
        },
        _ => Kernel::One {
            per_m: draw.ratio(0.01, 10.0),
            offset: draw.ratio(0.01, 20.0),
        },
    };
    let water = Gated {
        absorption,
        scattering,
        g,
        kernel,
        focal_px: draw.ratio(5.0, 600.0),
        layers: 2 + draw.below(3),
    };
    // Attenuation lengths before the nearest plate.
    let lengths = if draw.happens(0.4) {
        draw.between(2.0, 20.0)
    } else {
        draw.ratio(0.02, 22.0)
    };
    let nearest = (lengths / attenuation).clamp(0.05, 40.0);
    let tolerance = [3e-4, 3e-4, 3e-4, 3e-3, 1e-4, 3e-5][draw.below(6)];
    let small = (16 + draw.below(65), 16 + draw.below(49));
    let (width, height) = size.unwrap_or(small);
    let (radiance, range) = picture(&mut draw, (width, height), nearest);
    Scene {
        name: format!("{seed}/{index} {water:?}, {nearest:.3} m, {width}×{height}"),
        radiance,
        range,
        water: water.water(),
        tolerance,
    }
}

/// Plates before a wall, each brighter or darker than the others.
fn picture(draw: &mut Draw, (width, height): (usize, usize), nearest: f64) -> (Rgb<f32>, Plane<f32>) {
    let plates = 1 + draw.below(4);
    let mut steps = vec![nearest];
    for _ in 0..plates {
        let (last, most) = (steps[steps.len() - 1], [1.4, 3.0, 10.0][draw.below(3)]);
        steps.push(last * draw.ratio(1.26, most));
    }
    let wall = steps[plates];
    let slope = if draw.happens(0.5) {
        0.0
    } else {
        draw.ratio(1e-3, 0.5)
    };
    let rough = if draw.happens(0.7) {
        0.0
    } else {
        draw.ratio(1e-3, 0.3)
    };
    let noise = draw.stream;
    let mut range = Plane::from_fn(width, height, |x, y| {
        let place = (y * width + x) as u64;
        wall * (1.0 + slope * x as f64 / width as f64)
            * (1.0 + rough * noise.unit(draw.index + 1_000_000, place))
    });
    let mut layer = Plane::filled(width, height, plates);
    for plate in (0..plates).rev() {
        let (left, top) = (draw.below(width - 4), draw.below(height - 4));
        let (across, down) = (1 + draw.below(width - left), 1 + draw.below(height - top));
        // Some plates occlude all but a strip.
        let strip = 1 + draw.below(6);
        let (left, top, across, down) = if draw.happens(0.2) {
            (strip, 0, width - strip, height)
        } else {
            (left, top, across, down)
        };
        for y in top..(top + down).min(height) {
            for x in left..(left + across).min(width) {
                let at = y * width + x;
                range.data_mut()[at] = steps[plate] * (1.0 + 0.1 * slope * x as f64 / width as f64);
                layer.data_mut()[at] = plate;
            }
        }
    }
    if draw.happens(0.15) {
        let share = draw.between(0.0, 0.3);
        for (at, z) in range.data_mut().iter_mut().enumerate() {
            if noise.unit(draw.index + 2_000_000, at as u64) < share {
                *z = f64::NAN;
            }
        }
    }
    let bright = if draw.happens(0.3) {
        draw.ratio(1.0, 100.0)
    } else {
        1.0
    };
    let lights: Vec<f64> = (0..=plates)
        .map(|_| match draw.below(3) {
            0 => 0.0,
            1 => 1.0,
            _ => draw.unit(),
        })
        .collect();
    let texture = draw.below(4);
    let radiance = Rgb::from_fn(width, height, |x, y| {
        let place = (y * width + x) as u64;
        let value = bright
            * lights[layer.pixel(x, y)]
            * match texture {
                0 => 1.0,
                1 => noise.unit(draw.index + 3_000_000, place),
                2 => f64::from(u8::from(noise.unit(draw.index + 3_000_000, place) < 0.1)),
                _ => ((x + y) % 2) as f64,
            };
        [value as f32, (0.5 * value) as f32, (0.1 * value) as f32]
    });
    (radiance, range.map(|&z| z as f32))
}

/// A plate before a slanted wall in water that almost only scatters.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Slant {
    pub(crate) scattering: f64,
    pub(crate) kernel: Kernel,
    pub(crate) focal_px: f64,
    /// Ranges of the plate and of the near end of the wall, meters.
    pub(crate) gate_m: f64,
    pub(crate) wall_m: f64,
    /// Radiance of the wall, between half of it and all of it.
    pub(crate) light: f64,
}

impl Slant {
    pub(crate) fn scene(&self) -> Scene {
        let water = Gated {
            absorption: 1e-6,
            scattering: self.scattering,
            g: Some(0.0),
            kernel: self.kernel,
            focal_px: self.focal_px,
            layers: 3,
        };
        let (width, height) = (64, 48);
        let is_plate = |x: usize, y: usize| (20..40).contains(&x) && (10..40).contains(&y);
        let stream = Stream::stage(1, "slant");
        Scene {
            name: format!("{self:?}"),
            radiance: Rgb::from_fn(width, height, |x, y| {
                let light = self.light * (0.5 + 0.5 * stream.unit(x as u64, y as u64));
                [if is_plate(x, y) { 0.0 } else { light as f32 }; 3]
            }),
            range: Plane::from_fn(width, height, |x, y| {
                let slant = 1.0 + 0.3 * x as f64 / width as f64;
                (if is_plate(x, y) {
                    self.gate_m
                } else {
                    self.wall_m * slant
                }) as f32
            }),
            water: water.water(),
            tolerance: 3e-4,
        }
    }
}

/// Bright rows of a wall around a plate, so far apart that coarse rows confuse them with other patterns, under wide kernels.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stripes {
    pub(crate) scattering: f64,
    /// Kernel scale, pixels per meter.
    pub(crate) per_m: f64,
    /// Rows from one bright row to the next.
    pub(crate) period: f64,
    pub(crate) tolerance: f64,
}

impl Stripes {
    pub(crate) fn scene(&self) -> Scene {
        let water = Gated {
            absorption: 1e-6,
            scattering: self.scattering,
            g: Some(0.0),
            kernel: Kernel::One {
                per_m: self.per_m,
                offset: 0.0,
            },
            focal_px: 60.0,
            layers: 2,
        };
        let (width, height) = (40, 82);
        let is_plate = |x: usize, y: usize| (12..26).contains(&x) && (20..60).contains(&y);
        let is_bright = |y: usize| ((y as f64 / self.period).fract() * self.period) < 1.0;
        Scene {
            name: format!("{self:?}"),
            radiance: Rgb::from_fn(width, height, |_, y| [if is_bright(y) { 1.0 } else { 0.0 }; 3]),
            range: Plane::from_fn(width, height, |x, y| match (is_plate(x, y), y % 2) {
                (true, _) => 2.4,
                (false, 0) => 3.1,
                (false, _) => 4.6,
            }),
            water: water.water(),
            tolerance: self.tolerance,
        }
    }
}

/// Plates at close ranges. The gate of the nearer cut is the farther one, so light from the other gate is divided by the response
/// of a path longer than its actual one.
pub(crate) fn gates_in_reverse_order(scattering: f64) -> Scene {
    let water = Gated {
        absorption: 1e-6,
        scattering,
        g: Some(0.0),
        kernel: Kernel::Two(PhaseFunction::Ff),
        focal_px: 60.0,
        layers: 3,
    };
    let (width, height) = (64, 48);
    let range = |x: usize, y: usize| match (x, y) {
        (4..24, 4..44) => 2.05,
        (28..32, 4..10) => 2.99,
        (40..52, 10..40) => 2.3,
        (52..60, 10..40) => 2.95,
        _ => 9.0 + 0.02 * x as f32,
    };
    let stream = Stream::stage(1, "reverse");
    Scene {
        name: format!("{water:?}"),
        radiance: Rgb::from_fn(width, height, |x, y| [stream.unit(x as u64, y as u64) as f32; 3]),
        range: Plane::from_fn(width, height, range),
        water: water.water(),
        tolerance: 3e-4,
    }
}
