//! Adversarial frames for the bound of forward scatter: the worst interpolation error between kernels, concentrated in one pixel.

use imaging::{Plane, Rgb};
use optics::forward_scatter::{Nodes, gather_reference};
use optics::plan::{Plan, SceneBounds, StageId, Variant};
use optics::water::{Scatter, Water};
use spec::{Fidelity, ForwardScatter, Optics, ScatterModel};

/// Kernel scales that a pixel may take.
const CHOICES: usize = 96;
/// Light of the row that shows all ranges, so that the plan knows of them.
const DIM: f32 = 1e-6;

/// Parameters of an attack.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Attack {
    /// Scatter (`jaffe`) or gather (`simplified`).
    pub(crate) model: ScatterModel,
    /// Columns and rows.
    pub(crate) size: (usize, usize),
    /// The pixel whose error is maximized.
    pub(crate) target: (usize, usize),
    /// Least and greatest kernel scale, pixels.
    pub(crate) widths_px: (f64, f64),
    /// The error that the plan is made for.
    pub(crate) tolerance: f64,
    /// Whether the target becomes too bright.
    pub(crate) brighter: bool,
}

/// A frame against a plan.
#[derive(Debug, Clone)]
pub(crate) struct Frame {
    /// Linear light.
    pub(crate) radiance: Rgb<f32>,
    /// Meters along the ray.
    pub(crate) range: Plane<f32>,
    /// Water with attenuation and without absorption, or clear water.
    pub(crate) water: Water,
}

impl Attack {
    /// The frame; `None` if the plan does not interpolate.
    ///
    /// # Panics
    /// When the water is refused.
    #[must_use]
    pub(crate) fn frame(&self) -> Option<Frame> {
        let water = self.water();
        let choices: Vec<f64> = (0..CHOICES)
            .map(|j| {
                let place = |gamma: f64| (gamma + 0.3).ln();
                let (low, high) = (place(self.widths_px.0), place(self.widths_px.1));
                ((low + (high - low) * j as f64 / (CHOICES - 1) as f64).exp() - 0.3).max(self.widths_px.0)
            })
            .collect();
        let (width, height) = self.size;
        let dim_row = if self.target.1 == 0 { height - 1 } else { 0 };
        let dim = |x: usize| choices[x * (CHOICES - 1) / (width - 1)] as f32;
        let first = Plane::from_fn(width, height, |x, y| if y == dim_row { dim(x) } else { dim(0) });
        let even = Rgb::from_fn(width, height, |x, _| [f32::from(u8::from(x > 0)); 3]);
        let nodes = self.nodes(&even, &first, &water)?;
        let errors: Vec<Plane<f64>> = choices.iter().map(|&gamma| self.errors(gamma, &nodes)).collect();
        let sign = if self.brighter { 1.0 } else { -1.0 };
        let (radiance, range) = match self.model {
            ScatterModel::Simplified => {
                // One scale for the target, the one whose errors of one sign sum to most.
                let sum =
                    |errors: &Plane<f64>| errors.data().iter().map(|e| (sign * e).max(0.0)).sum::<f64>();
                let worst = (0..CHOICES).max_by(|&a, &b| sum(&errors[a]).total_cmp(&sum(&errors[b])))?;
                let range = Plane::from_fn(width, height, |x, y| match (x, y) {
                    place if place == self.target => choices[worst] as f32,
                    (x, y) if y == dim_row => dim(x),
                    _ => dim(0),
                });
                let lit = |x, y| f32::from(u8::from(sign * errors[worst].pixel(x, y) > 0.0));
                (Rgb::from_fn(width, height, |x, y| [lit(x, y); 3]), range)
            }
            _ => {
                let worst = |x: usize, y: usize| {
                    let error = |j: &usize| sign * errors[*j].pixel(x, y);
                    (0..CHOICES)
                        .max_by(|a, b| error(a).total_cmp(&error(b)))
                        .map(|j| (j, error(&j)))
                };
                let range = Plane::from_fn(width, height, |x, y| match worst(x, y) {
                    Some((j, _)) if y != dim_row => choices[j] as f32,
                    _ => dim(x),
                });
                let lit = |x, y| match worst(x, y) {
                    Some((_, error)) if y != dim_row && error > 0.0 => 1.0,
                    _ => DIM,
                };
                (Rgb::from_fn(width, height, |x, y| [lit(x, y); 3]), range)
            }
        };
        Some(Frame {
            radiance,
            range,
            water,
        })
    }

    fn water(&self) -> Water {
        let gathers = self.model == ScatterModel::Simplified;
        let optics = Optics {
            beam_attenuation_per_m: Some([if gathers { 0.0 } else { 1000.0 }; 3]),
            veiling_light: Some([0.0; 3]),
            forward_scatter: Some(ForwardScatter {
                g_per_m: Some([0.0; 3]),
                spread_px_per_m: Some([1.0; 3]),
                spread_offset_px: Some([0.0; 3]),
                ..self.model.into()
            }),
            ..Optics::default()
        };
        let water = Water::resolve(&optics.into(), 500.0).expect("a water without contradictions");
        assert!(*water.scatter() != Scatter::None);
        water
    }

    /// Interpolation nodes of the plan for such ranges.
    fn nodes(&self, radiance: &Rgb<f32>, range: &Plane<f32>, water: &Water) -> Option<Nodes> {
        let stats = SceneBounds::measure(radiance, range, water);
        let plan = Plan::for_water(&stats, water, Fidelity::Tolerance(self.tolerance));
        match plan.variant(StageId::ForwardScatter(1)).clone() {
            Variant::Interpolated(nodes @ Nodes::Chebyshev { .. }) => Some(nodes),
            _ => None,
        }
    }

    /// Change of the target's light by interpolation, for every pixel as if it had this scale.
    fn errors(&self, gamma: f64, nodes: &Nodes) -> Plane<f64> {
        let place = |gamma: f64| (gamma + 0.3).ln();
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
        let mut error = self.kernel(gamma).data().to_vec();
        for k in 0..count {
            let (kernel, share) = (self.kernel(nodes.gamma(k)), share(k));
            error
                .iter_mut()
                .zip(kernel.data())
                .for_each(|(error, kernel)| *error -= share * kernel);
        }
        Plane::new(self.size.0, self.size.1, error.into_iter().map(|e| -e).collect()).expect("the frame")
    }

    fn kernel(&self, gamma: f64) -> Plane<f64> {
        let (width, height) = self.size;
        let point = Plane::from_fn(width, height, |x, y| f64::from(u8::from((x, y) == self.target)));
        gather_reference(&point, &Plane::filled(width, height, gamma))
    }
}
