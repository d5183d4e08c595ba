//! Comparison of a frame with its reference and the bound of its plan.

use imaging::{Rgb, transfer};
use optics::plan::{ErrorBound, Plan, StageId};
use spec::{Fidelity, Frame, Tone};

use super::case::Case;
use crate::studio::Studio;

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

/// A studio without effects that have no bound.
pub(super) fn bounded_studio() -> Studio {
    Studio::without_effects(&UNBOUNDED)
}

/// The bound of a plan for its frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Promise {
    /// The largest error of the linear light after exposure.
    pub(super) bound: f64,
    /// Whether the plan has a reason for a bound above the tolerance.
    pub(super) exceeds: bool,
    /// Whether a stage has no bound, which voids the bound of the frame.
    pub(super) is_open: bool,
}

/// Comparison of a frame with its reference.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Measured {
    /// The bound of the plan.
    pub(super) promise: Promise,
    /// The largest error of the linear light after exposure.
    pub(super) error: f64,
    /// Share of the samples with an error above the bound, such as edges in a stage without a bound.
    pub(super) above: f64,
    /// Column, row and channel of that error.
    pub(super) place: [usize; 3],
    /// The same frame with the fidelity `picture`; `None` if that plan exceeds its tolerance or has a stage without a bound.
    pub(super) picture: Option<PictureError>,
}

/// The error of a frame with the fidelity `picture`, whose promise grows with the light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PictureError {
    /// Largest difference of 8-bit codes.
    pub(super) codes: u8,
    /// Largest error of a sample over its bound, which grows with the sample.
    pub(super) ratio: f64,
}

/// The bound of a plan; `None` without a tolerance.
fn read_promise(plan: &Plan) -> Option<Promise> {
    let promise = plan.promise()?;
    Some(Promise {
        bound: promise.bound,
        exceeds: promise.exceeds.is_some(),
        is_open: !promise.unbounded.is_empty(),
    })
}

impl Measured {
    /// Renders a frame and its reference; `None` if one of them fails.
    pub(super) fn measure(studio: &mut Studio, frame: &Frame, case: &Case) -> Option<Self> {
        let source = case.source();
        let exact = studio.linear(frame, Fidelity::Reference, &source).ok()?.radiance;
        let fast = studio.linear(frame, frame.fidelity, &source).ok()?;
        let shown = studio.linear(frame, Fidelity::Picture, &source).ok()?;
        let (error, place) = find_largest_error(&fast.radiance, &exact);
        let picture = read_promise(&shown.plan)
            .filter(|promise| !promise.exceeds && !promise.is_open)
            .and_then(|_| {
                Some(PictureError {
                    codes: compare_codes(&shown.radiance, &exact, frame.camera.tone),
                    ratio: find_largest_ratio(&shown.radiance, &exact, shown.plan.promised_error()?),
                })
            });
        let promise = read_promise(&fast.plan)?;
        Some(Self {
            promise,
            error,
            above: share_above(&fast.radiance, &exact, promise.bound),
            place,
            picture,
        })
    }
}

/// The largest difference of two pictures and its column, row and channel; infinite for a NaN.
fn find_largest_error(fast: &Rgb<f32>, exact: &Rgb<f32>) -> (f64, [usize; 3]) {
    let width = fast.width().max(1);
    let mut largest = (0.0, [0; 3]);
    for (channel, (fast, exact)) in fast.planes().iter().zip(exact.planes()).enumerate() {
        for (index, (&fast, &exact)) in fast.data().iter().zip(exact.data()).enumerate() {
            let error = sample_error(fast, exact);
            if error > largest.0 {
                largest = (error, [index % width, index / width, channel]);
            }
        }
    }
    largest
}

/// The largest error of a sample over its bound.
fn find_largest_ratio(fast: &Rgb<f32>, exact: &Rgb<f32>, bound: ErrorBound) -> f64 {
    let planes = fast.planes().iter().zip(exact.planes());
    let pairs = planes.flat_map(|(fast, exact)| fast.data().iter().zip(exact.data()));
    let ratios = pairs.map(|(&fast, &exact)| {
        let light = f64::from(exact).clamp(0.0, WHITE);
        sample_error(fast, exact) / bound.bound_sample(light)
    });
    ratios.fold(0.0, f64::max)
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
    let errors: Vec<f64> = pairs.map(|(&fast, &exact)| sample_error(fast, exact)).collect();
    let above = errors.iter().filter(|error| **error > bound).count();
    above as f64 / errors.len().max(1) as f64
}

/// The largest difference of 8-bit codes.
fn compare_codes(fast: &Rgb<f32>, exact: &Rgb<f32>, tone: Tone) -> u8 {
    let pairs = encode(fast, tone).into_iter().zip(encode(exact, tone));
    pairs.map(|(fast, exact)| fast.abs_diff(exact)).max().unwrap_or(0)
}

/// 8-bit codes of a picture without noise and white balance.
fn encode(light: &Rgb<f32>, tone: Tone) -> Vec<u8> {
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
