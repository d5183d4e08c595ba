//! Distance of a frame's light from its Monte Carlo truth, with any choice of effects.

use std::sync::Arc;

use ::camera::exposure::metered;
use imaging::Rgb;
use spec::{Exposure, FrameRecord};
use truth::{Distance, Goal};

use super::state::Slot;
use crate::comparable::ComparableFrame;
use crate::context::FrameContext;
use crate::error::RenderError;
use crate::light::Light;
use crate::pipeline;
use crate::planning::plan_frame;
use crate::source::SceneSource;
use crate::stage::camera;
use crate::stage::truth::{self as traced, BLOCK_PX, Round, Traced, Tracing};
use crate::stopwatch::Stopwatch;

/// The truth of a frame, for comparison with renderings of it.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameTruth {
    traced: Traced,
    /// The factor from light to codes.
    pub gain: f64,
    /// Paths of each pixel and channel.
    pub paths: u64,
    /// Root mean square of the standard errors of its blocks, relative to the mean light.
    pub noise: f64,
    /// Light that only the truth or only the chain has.
    pub differences: Vec<&'static str>,
}

impl Slot {
    /// Traces the light of a frame up to the error `target` of the median block relative to the mean, with at most `most_paths` of
    /// each pixel. `round` traces the paths, for example on several threads. Returns `None` if it stopped in the first round.
    ///
    /// # Errors
    /// As [`Slot::render`], and light without a truth.
    pub fn trace_truth(
        &mut self,
        comparable: &ComparableFrame,
        target: f64,
        most_paths: u64,
        round: Round<'_>,
    ) -> Result<Option<FrameTruth>, RenderError> {
        if self
            .scene(&comparable.frame, &SceneSource::Local)?
            .scene
            .range
            .is_none()
        {
            return Err(RenderError::NoRange);
        }
        self.render_light(comparable, |context, light| {
            let tracing = Tracing {
                goal: Goal {
                    target,
                    block: BLOCK_PX,
                    most_paths,
                },
                law: traced::law(context),
                seed: context.frame.seed,
                limit: "paths_max",
            };
            let traced = traced::trace(context, &light, &tracing, round)?;
            Ok(traced.map(|traced| FrameTruth {
                gain: find_gain(context, &add_light(&light, traced.has_sea)),
                paths: traced.report.paths,
                noise: measure(&traced, &light, 1.0).noise,
                differences: list_differences(context, traced.has_sea),
                traced,
            }))
        })
    }

    /// The distance of a frame's light, rendered with its fidelity and the effects of this slot, from its truth.
    ///
    /// # Errors
    /// As [`Slot::render`].
    pub fn measure_distance(
        &mut self,
        comparable: &ComparableFrame,
        truth: &FrameTruth,
    ) -> Result<Distance, RenderError> {
        self.render_light(comparable, |_, light| {
            Ok(measure(&truth.traced, &light, truth.gain))
        })
    }

    /// Renders the light of a frame before its camera, then calls `finish`.
    fn render_light<T>(
        &mut self,
        comparable: &ComparableFrame,
        finish: impl FnOnce(&FrameContext<'_>, Light) -> Result<T, RenderError>,
    ) -> Result<T, RenderError> {
        let frame = &*camera::complete(&comparable.frame);
        let prepared = Arc::clone(&self.scene(frame, &SceneSource::Local)?);
        let watch = &mut Stopwatch::start();
        let mut context = FrameContext::new(frame, &prepared, 0.0, &mut self.resources, watch)?;
        let expected = self.expect_exposure(&context)?;
        self.choose_effects(&mut context, expected, watch)?;
        context.plan = plan_frame(&context, expected, None, &self.networks.engine)?;
        let light = pipeline::render(&context, &mut self.kernels, &mut FrameRecord::default(), watch)?;
        finish(&context, light)
    }
}

fn measure(traced: &Traced, light: &Light, gain: f64) -> Distance {
    let light = add_light(light, traced.has_sea);
    Distance::new(&light, &traced.truth.estimate, BLOCK_PX, gain)
}

/// The light of the chain that the truth models.
fn add_light(light: &Light, has_sea: bool) -> Rgb<f32> {
    let direct = &light.layers.direct;
    let scattered = traced::scattered(light, has_sea);
    Rgb::from_fn(direct.width(), direct.height(), |x, y| {
        [0, 1, 2].map(|i| direct.planes()[i].pixel(x, y) + scattered.planes()[i].pixel(x, y))
    })
}

/// The exposure of a picture without fall-off.
fn find_gain(context: &FrameContext<'_>, light: &Rgb<f32>) -> f64 {
    let exposure = context.taking.as_ref().and_then(|taking| taking.parts.exposure);
    match exposure {
        None => 1.0,
        Some(Exposure::Fixed(gain)) => gain,
        Some(Exposure::Auto(metering)) => metered(light, None, &metering),
    }
}

/// Light that only one side of the comparison has.
fn list_differences(context: &FrameContext<'_>, has_sea: bool) -> Vec<&'static str> {
    let water = context.setting.water.as_ref();
    let is_constant = !has_sea && water.is_some_and(|water| water.veiling_light() != [0.0; 3]);
    let waves = "waves: the truth has a calm sea, so caustics and shafts count as distance";
    let veil = "the constant veil of the water, which has no truth";
    let differences = [(has_sea, waves), (is_constant, veil)];
    let differences = differences.into_iter().filter(|(applies, _)| *applies);
    differences.map(|(_, text)| text).collect()
}
