//! Frames made against the bound of gated forward scatter: each pixel of a wall has the range and the light that add most to the
//! interpolation error of one pixel next to a plate.

use imaging::dct::Dct2;
use imaging::{Plane, Rgb};
use optics::forward_scatter::{Nodes, widest_px};
use optics::kernel::Transfer;
use optics::plan::{Plan, SceneBounds, StageId, Variant};
use spec::{Fidelity, PhaseFunction};

use crate::scenes::{Gated, Kernel, Scene};

/// Ranges that a pixel of the wall may have.
const CHOICES: usize = 24;
/// Farthest over nearest range of the wall: farther neighbors would be behind an edge.
const DEPTH: f64 = 1.24;
/// Light of negligible pixels that still make the plan include their ranges.
const DIM: f32 = 1e-6;

/// Parameters of an attack.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Attack {
    pub(crate) water: Gated,
    pub(crate) gate_m: f64,
    pub(crate) wall_m: f64,
    pub(crate) tolerance: f64,
    /// Whether the target becomes too bright.
    pub(crate) is_brighter: bool,
}

const SIZE: (usize, usize) = (48, 40);
/// A pixel in front of the plate, and a plate that leaves most of the frame open.
const TARGET: (usize, usize) = (17, 20);

fn is_plate(x: usize, y: usize) -> bool {
    (18..26).contains(&x) && (8..32).contains(&y)
}

/// A kernel of the water with its light and the nodes of its plan.
struct Part<'a> {
    nodes: &'a Nodes,
    gamma: fn(&Attack, f64) -> f64,
    light: fn(&Attack, f64) -> f64,
}

impl Attack {
    /// The frame; `None` if the plan does not interpolate behind the plate.
    pub(crate) fn scene(&self) -> Option<Scene> {
        let choices: Vec<f64> = (0..CHOICES)
            .map(|j| self.wall_m * DEPTH.powf(j as f64 / (CHOICES - 1) as f64))
            .collect();
        // The lowest row shows all ranges.
        let dim = |x: usize| choices[x * (CHOICES - 1) / (SIZE.0 - 1)];
        let range_of = |wall: &dyn Fn(usize, usize) -> f64| {
            Plane::from_fn(SIZE.0, SIZE.1, |x, y| {
                let meters = match (x, y) {
                    (x, y) if is_plate(x, y) => self.gate_m,
                    (x, y) if y + 1 == SIZE.1 => dim(x),
                    (x, y) => wall(x, y),
                };
                meters as f32
            })
        };
        let scene = |radiance: Rgb<f32>, range: Plane<f32>| Scene {
            name: format!("{self:?}"),
            radiance,
            range,
            water: self.water.water(),
            tolerance: self.tolerance,
        };
        let even = Rgb::from_fn(SIZE.0, SIZE.1, |x, y| [f32::from(u8::from(!is_plate(x, y))); 3]);
        let first = scene(even, range_of(&|_, _| choices[0]));
        let errors = self.errors(&first, &choices)?;
        let sign = if self.is_brighter { 1.0 } else { -1.0 };
        let worst = |x: usize, y: usize| {
            let error = |j: usize| sign * errors[j].pixel(x, y);
            let j = (0..CHOICES)
                .max_by(|&a, &b| error(a).total_cmp(&error(b)))
                .unwrap_or(0);
            (j, error(j))
        };
        let radiance = Rgb::from_fn(SIZE.0, SIZE.1, |x, y| {
            let counts = !is_plate(x, y) && y + 1 < SIZE.1 && worst(x, y).1 > 0.0;
            [if counts { 1.0 } else { DIM }; 3]
        });
        Some(scene(radiance, range_of(&|x, y| choices[worst(x, y).0])))
    }

    /// For each range the interpolation error at the target of unit light in each pixel.
    fn errors(&self, scene: &Scene, choices: &[f64]) -> Option<Vec<Plane<f64>>> {
        let bounds = SceneBounds::measure(&scene.radiance, &scene.range, &scene.water);
        let plan = Plan::for_water(&bounds, &scene.water, Fidelity::Tolerance(self.tolerance));
        let Variant::Layered(layers) = plan.variant(StageId::ForwardScatter(0)) else {
            return None;
        };
        let kernels = layers.get(1)?;
        let narrow = kernels.narrow.as_ref().map(|nodes| Part {
            nodes,
            gamma: |attack, z| attack.gammas(z)[0],
            light: |attack, z| attack.spread(z)[0],
        });
        let wide = kernels.wide.as_ref().map(|nodes| Part {
            nodes,
            gamma: |attack, z| attack.gammas(z)[1],
            light: |attack, z| attack.spread(z)[1],
        });
        let parts: Vec<Part<'_>> = narrow.into_iter().chain(wide).collect();
        let seen = self.seen_from_gate();
        let error = |&z: &f64| {
            let mut sum = vec![0.0; seen.len()];
            for part in &parts {
                let error = interpolation_error(part.nodes, (part.gamma)(self, z));
                let light = (part.light)(self, z);
                for (sum, (seen, error)) in sum.iter_mut().zip(seen.iter().zip(&error)) {
                    *sum += light * seen * error;
                }
            }
            Dct2::new(SIZE.0, SIZE.1).inverse(&mut sum);
            Plane::new(SIZE.0, SIZE.1, sum).expect("the size of the frame")
        };
        Some(choices.iter().map(error).collect())
    }

    /// Spectrum of the target's response to light behind the gate. Kernels are even, so the operators apply in reverse order.
    fn seen_from_gate(&self) -> Vec<f64> {
        let [narrow, wide] = self.gammas(self.gate_m).map(grid);
        let (spread, direct) = (
            self.spread(self.gate_m),
            (-self.attenuation() * self.gate_m).exp(),
        );
        let response = |i: usize| direct + spread[0] * narrow[i] + spread[1] * wide[i];
        let mut transform = Dct2::new(SIZE.0, SIZE.1);
        let mut light = vec![0.0; SIZE.0 * SIZE.1];
        light[TARGET.1 * SIZE.0 + TARGET.0] = 1.0;
        transform.forward(&mut light);
        light.iter_mut().enumerate().for_each(|(i, v)| *v *= response(i));
        transform.inverse(&mut light);
        for (i, light) in light.iter_mut().enumerate() {
            if is_plate(i % SIZE.0, i / SIZE.0) {
                *light = 0.0;
            }
        }
        transform.forward(&mut light);
        light.iter_mut().enumerate().for_each(|(i, v)| *v /= response(i));
        light
    }

    fn attenuation(&self) -> f64 {
        self.water.absorption + self.water.scattering
    }

    fn gammas(&self, z: f64) -> [f64; 2] {
        let (path, focal) = (self.water.scattering * z, self.water.focal_px);
        let gammas = match self.water.kernel {
            Kernel::One { per_m, offset } => [offset + per_m * z; 2],
            Kernel::Two(PhaseFunction::Ff) => {
                [focal * (0.0015 + 0.0007 * path), focal * (0.035 + 0.010 * path)]
            }
            Kernel::Two(PhaseFunction::Hg) => [focal * 0.0045, focal * (0.040 + 0.010 * path)],
        };
        gammas.map(|gamma| gamma.min(widest_px(SIZE.0, SIZE.1)))
    }

    /// Light that the narrow and the wide kernel spread.
    fn spread(&self, z: f64) -> [f64; 2] {
        let path = self.water.scattering * z;
        let wide = match self.water.kernel {
            Kernel::One { .. } => 0.0,
            Kernel::Two(PhaseFunction::Ff) => (0.63 + 0.065 * path).min(1.0),
            Kernel::Two(PhaseFunction::Hg) => (0.84 + 0.02 * path).min(1.0),
        };
        let g = self.water.g.expect("G is given");
        let spread = (-g * z).exp() - (-self.attenuation() * z).exp();
        [spread * (1.0 - wide), spread * wide]
    }
}

fn grid(gamma: f64) -> Vec<f64> {
    Transfer::new(gamma).grid(SIZE.0, SIZE.1)
}

/// The interpolated kernel, less the kernel.
fn interpolation_error(nodes: &Nodes, gamma: f64) -> Vec<f64> {
    let origin = match nodes {
        Nodes::Chebyshev { origin, .. } => *origin,
        Nodes::Exact(_) => 0.0,
    };
    let place = |gamma: f64| (gamma - origin + 0.3).ln();
    let count = nodes.terms();
    let share = |k: usize| {
        let others = (0..count).filter(|&other| other != k);
        others
            .map(|other| {
                let other = place(nodes.gamma(other));
                (place(gamma) - other) / (place(nodes.gamma(k)) - other)
            })
            .product::<f64>()
    };
    let mut error: Vec<f64> = grid(gamma).into_iter().map(|h| -h).collect();
    for k in 0..count {
        let share = share(k);
        let kernel = grid(nodes.gamma(k));
        error
            .iter_mut()
            .zip(&kernel)
            .for_each(|(error, h)| *error += share * h);
    }
    error
}
