//! The light of a frame in its water, to be held against another model.

use imaging::Rgb;
use optics::chain::Layers;
use optics::setting::Setting;
use spec::{Frame, FrameRecord};
use truth::Law;

use super::Slot;
use crate::error::RenderError;
use crate::source::SceneSource;
use crate::stage::truth::{self as traced, Round, Traced, Tracing};
use crate::stage::{Shot, glow, water};
use crate::stopwatch::Stopwatch;

/// The light of a frame in the water before snow, style and haze.
#[derive(Debug, Clone, PartialEq)]
pub struct WaterLight {
    /// The surroundings.
    pub setting: Setting,
    /// How the water scatters in the truth.
    pub law: Law,
    /// Light of surfaces that arrives unscattered.
    pub direct: Rgb<f32>,
    /// Light that arrives scattered: of surfaces and of lamps, and the veil where the truth has daylight.
    pub scattered: Rgb<f32>,
}

impl Slot {
    /// The light of a frame in its water, as far as a truth has it: with the veil of daylight where `has_daylight`.
    ///
    /// # Errors
    /// As [`Slot::render`].
    pub fn water_light(
        &mut self,
        frame: &Frame,
        source: &SceneSource,
        has_daylight: bool,
    ) -> Result<WaterLight, RenderError> {
        let (shot, layers) = self.lit(frame, source)?;
        Ok(WaterLight {
            scattered: traced::scattered(&shot, &layers, has_daylight),
            law: traced::law(&shot),
            direct: layers.direct,
            setting: shot.setting,
        })
    }

    /// Traces a frame, whatever its artifacts, round by round; none of a scene without a range, and where the first round is not
    /// traced.
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
        let (shot, layers) = self.lit(frame, source)?;
        traced::trace(&shot, &layers, tracing, round)
    }

    fn lit<'a>(&mut self, frame: &'a Frame, source: &SceneSource) -> Result<(Shot<'a>, Layers), RenderError> {
        let shot = self.resolve(frame, source, &mut Stopwatch::start())?;
        let mut layers = water::run(&shot, &mut self.kernels)?;
        glow::run(&shot, &mut layers, &mut FrameRecord::default());
        Ok((shot, layers))
    }
}
