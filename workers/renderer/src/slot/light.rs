//! The light of a frame in its water, for comparison with another model.

use std::sync::Arc;

use imaging::Rgb;
use optics::setting::Setting;
use spec::{Frame, FrameRecord};
use truth::PhaseModel;

use super::state::Slot;
use crate::context::FrameContext;
use crate::error::RenderError;
use crate::light::Light;
use crate::pipeline;
use crate::planning::plan_frame;
use crate::source::SceneSource;
use crate::stage::camera;
use crate::stage::truth::{self as traced, Round, Traced, Tracing};
use crate::stopwatch::Stopwatch;

/// The light of a frame in the water before snow, style and haze.
#[derive(Debug, Clone, PartialEq)]
pub struct WaterLight {
    /// The surroundings.
    pub setting: Setting,
    /// The phase function of the truth.
    pub law: PhaseModel,
    /// Unscattered light of surfaces.
    pub direct: Rgb<f32>,
    /// Scattered light of surfaces and lamps, and the veil if the truth has daylight.
    pub scattered: Rgb<f32>,
}

impl Slot {
    /// The light of a frame in its water without snow; with the veil of daylight if `has_daylight`.
    ///
    /// # Errors
    /// As [`Slot::render`].
    pub fn water_light(
        &mut self,
        frame: &Frame,
        source: &SceneSource,
        has_daylight: bool,
    ) -> Result<WaterLight, RenderError> {
        self.light(frame, source, |context, light| {
            Ok(WaterLight {
                scattered: traced::scattered(&light, has_daylight),
                law: traced::law(context),
                direct: light.layers.direct,
                setting: context.setting.clone(),
            })
        })
    }

    /// Traces a frame round by round. Returns `None` if the scene has no range or the first round was not traced.
    ///
    /// # Errors
    /// As [`Slot::render`].
    pub fn trace(
        &mut self,
        frame: &Frame,
        source: &SceneSource,
        tracing: &Tracing,
        round: Round<'_>,
    ) -> Result<Option<Traced>, RenderError> {
        self.light(frame, source, |context, light| {
            traced::trace(context, &light, tracing, round)
        })
    }

    /// Renders the light of a frame before its camera, then calls `finish`.
    fn light<T>(
        &mut self,
        frame: &Frame,
        source: &SceneSource,
        finish: impl FnOnce(&FrameContext<'_>, Light) -> Result<T, RenderError>,
    ) -> Result<T, RenderError> {
        let frame = &*camera::complete(frame);
        let prepared = Arc::clone(&self.scene(frame, source)?);
        let watch = &mut Stopwatch::start();
        let mut context = FrameContext::new(frame, &prepared, 0.0, &mut self.resources, watch)?;
        let expected = self.expect_exposure(&context)?;
        self.choose_effects(&mut context, expected, watch)?;
        context.plan = plan_frame(&context, expected, None, &self.networks.engine)?;
        let light = pipeline::render(&context, &mut self.kernels, &mut FrameRecord::default(), watch)?;
        finish(&context, light)
    }
}
