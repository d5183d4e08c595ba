//! Measures the variants of a stage on a scene.

use imaging::Rgb;
use optics::medium::Medium;
use optics::water::Water;
use spec::{ForwardScatter, Optics, ScatterModel};

use super::scenes::{ChartScene, focal_px};
use crate::measurement::{Measurement, Times, difference, time};

/// The default tolerance of a job.
pub(super) const DEFAULT_TOLERANCE: f64 = 3e-4;
/// Tolerances of the planned variants.
pub(super) const TOLERANCES: [f64; 6] = [1.0 / 255.0, 1e-3, DEFAULT_TOLERANCE, 1e-4, 1e-5, 1e-6];

/// A stage on a scene, and the measurements of its variants.
pub(super) struct Bench<'a> {
    stage: &'static str,
    pub(super) scene: &'a ChartScene,
    pub(super) runs: usize,
    measured: Vec<Measurement>,
}

impl<'a> Bench<'a> {
    pub(super) fn new(stage: &'static str, scene: &'a ChartScene, runs: usize) -> Self {
        let measured = Vec::new();
        Self {
            stage,
            scene,
            runs,
            measured,
        }
    }

    /// Measures a variant against the reference.
    pub(super) fn measure(
        &mut self,
        variant: &str,
        terms: Option<usize>,
        exact: &Rgb<f32>,
        work: impl FnMut() -> Rgb<f32>,
    ) {
        let (times, picture) = time(self.runs, work);
        self.push(variant, terms, times, &picture, exact);
    }

    /// Adds a measured variant.
    pub(super) fn push(
        &mut self,
        variant: &str,
        terms: Option<usize>,
        times: Times,
        picture: &Rgb<f32>,
        exact: &Rgb<f32>,
    ) {
        self.measured.push(Measurement {
            stage: self.stage,
            variant: variant.to_owned(),
            terms,
            case: self.scene.name.clone(),
            size: picture.size(),
            times,
            difference: Some(difference(picture, exact)),
            is_default: false,
            is_pareto: false,
        });
    }

    /// The measurements, with the default variant marked.
    pub(super) fn finish(mut self, default: &str) -> Vec<Measurement> {
        for measured in &mut self.measured {
            measured.is_default = measured.variant == default;
        }
        self.measured
    }
}

/// A coastal water with strong forward scatter, seen by a camera of 80° across.
pub(super) fn coastal(width: usize, model: ScatterModel) -> Option<Water> {
    let request = Medium::from(Optics {
        preset: Some("jerlov-1C".to_owned()),
        forward_scatter: Some(ForwardScatter::from(model)),
        ..Optics::default()
    });
    Water::resolve(&request, focal_px(width)).ok()
}
