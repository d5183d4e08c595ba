//! Renders frames of the campaign and compares them with their references and the bounds of their plans.

use std::sync::Arc;

use imaging::{Rgb, transfer};
use optics::plan::{Plan, StageId};
use renderer::{Engine, LinearPicture, SceneSource, Slot};
use spec::{Fidelity, Frame, Job, Tone, Vocabulary};
use style::Library;

use super::case::Case;

/// Linear light of white, the largest in an exposed picture.
const WHITE: f64 = 1.0;

/// Effects without a bound, which would void the bound of nearly every frame.
const UNBOUNDED: [StageId; 6] = [
    StageId::SunShadow,
    StageId::AmbientAccess,
    StageId::Caustics,
    StageId::Shafts,
    StageId::LampShadows,
    StageId::VeilOcclusion,
];

/// Renders frames of the campaign.
pub struct Studio {
    slot: Slot,
    vocabulary: Vocabulary,
}

/// The bound of a plan for its frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Promise {
    /// The largest error of the linear light after exposure.
    pub bound: f64,
    /// Whether the plan has a reason for a bound above the tolerance.
    pub exceeds: bool,
    /// Whether a stage has no bound, which voids the bound of the frame.
    pub is_open: bool,
}

/// Comparison of a frame with its reference.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// The bound of the plan.
    pub promise: Promise,
    /// The largest error of the linear light after exposure.
    pub error: f64,
    /// Share of the samples with an error above the bound, such as edges in a stage without a bound.
    pub above: f64,
    /// Column, row and channel of that error.
    pub place: [usize; 3],
    /// Largest difference of 8-bit codes with the fidelity `picture`; `None` if that plan exceeds its tolerance.
    pub picture_codes: Option<u8>,
}

/// The bound of a plan; `None` without a tolerance.
fn promise(plan: &Plan) -> Option<Promise> {
    let promise = plan.promise()?;
    Some(Promise {
        bound: promise.bound,
        exceeds: promise.exceeds.is_some(),
        is_open: !promise.unbounded.is_empty(),
    })
}

impl Studio {
    /// A studio with the embedded style models only.
    ///
    /// # Panics
    /// The embedded style models are damaged.
    #[must_use]
    pub fn new() -> Self {
        let library = Library::embedded().expect("the embedded style models");
        Self {
            vocabulary: renderer::vocabulary(&library, true),
            slot: Slot::new(&Arc::new(Engine::new(library, None))).excluding(&UNBOUNDED),
        }
    }

    /// The frame of a case; `None` if the description is invalid.
    pub(super) fn resolve(&self, case: &Case) -> Option<Frame> {
        let job = Job::parse(case.job.to_string().as_bytes(), &self.vocabulary).ok()?;
        job.resolve(0).ok()
    }

    /// Renders a frame and its reference; `None` if one of them fails.
    pub(super) fn measure(&mut self, frame: &Frame, case: &Case) -> Option<Measured> {
        let source = case.source();
        let exact = self.light(frame, Fidelity::Reference, &source)?.radiance;
        let fast = self.light(frame, frame.fidelity, &source)?;
        let shown = self.light(frame, Fidelity::Picture, &source)?;
        let (error, place) = largest_error(&fast.radiance, &exact);
        let picture_codes = promise(&shown.plan)
            .filter(|promise| !promise.exceeds && !promise.is_open)
            .map(|_| code_difference(&shown.radiance, &exact, frame.camera.tone));
        let promise = promise(&fast.plan)?;
        Some(Measured {
            promise,
            error,
            above: share_above(&fast.radiance, &exact, promise.bound),
            place,
            picture_codes,
        })
    }

    fn light(&mut self, frame: &Frame, fidelity: Fidelity, source: &SceneSource) -> Option<LinearPicture> {
        let frame = Frame {
            fidelity,
            ..frame.clone()
        };
        self.slot.linear(&frame, source).ok()
    }
}

impl Default for Studio {
    fn default() -> Self {
        Self::new()
    }
}

/// The largest difference of two pictures and its column, row and channel; infinite for a NaN.
fn largest_error(fast: &Rgb<f32>, exact: &Rgb<f32>) -> (f64, [usize; 3]) {
    let width = fast.width().max(1);
    let mut largest = (0.0, [0; 3]);
    for (channel, (fast, exact)) in fast.planes().iter().zip(exact.planes()).enumerate() {
        for (at, (&fast, &exact)) in fast.data().iter().zip(exact.data()).enumerate() {
            let error = sample_error(fast, exact);
            if error > largest.0 {
                largest = (error, [at % width, at / width, channel]);
            }
        }
    }
    largest
}

/// The error of a sample; infinite for a NaN.
fn sample_error(fast: f32, exact: f32) -> f64 {
    if fast.is_nan() || exact.is_nan() {
        return f64::INFINITY;
    }
    (f64::from(fast).min(WHITE) - f64::from(exact).min(WHITE)).abs()
}

/// Share of the samples with an error above a bound.
fn share_above(fast: &Rgb<f32>, exact: &Rgb<f32>, bound: f64) -> f64 {
    let planes = fast.planes().iter().zip(exact.planes());
    let pairs = planes.flat_map(|(fast, exact)| fast.data().iter().zip(exact.data()));
    let (mut count, mut above) = (0usize, 0usize);
    for (&fast, &exact) in pairs {
        count += 1;
        above += usize::from(sample_error(fast, exact) > bound);
    }
    above as f64 / count.max(1) as f64
}

/// The largest difference of 8-bit codes.
fn code_difference(fast: &Rgb<f32>, exact: &Rgb<f32>, tone: Tone) -> u8 {
    let pairs = codes(fast, tone).into_iter().zip(codes(exact, tone));
    pairs.map(|(fast, exact)| fast.abs_diff(exact)).max().unwrap_or(0)
}

/// 8-bit codes of a picture without noise and white balance.
fn codes(light: &Rgb<f32>, tone: Tone) -> Vec<u8> {
    let exponent = match tone {
        Tone::Srgb => return transfer::encode_rgb8(light).0.data().to_vec(),
        Tone::Linear => 1.0,
        Tone::Gamma(gamma) => 1.0 / gamma,
    };
    let samples = light.planes().iter().flat_map(|plane| plane.data());
    samples
        .map(|&v| (255.0 * f64::from(v).clamp(0.0, WHITE).powf(exponent) + 0.5) as u8)
        .collect()
}
