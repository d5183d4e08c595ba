//! The exposure of a frame: its moments, the expected factor and the metered factor.

use imaging::Rgb;
use optics::plan::{ErrorBound, StageId, compose};
use spec::{Exposure, Frame, FrameRecord};

use super::state::{Slot, Taken};
use crate::context::FrameContext;
use crate::error::RenderError;
use crate::inputs::movement::Moment;
use crate::inputs::scene;
use crate::inputs::seen::Seen;
use crate::light::Light;
use crate::planning::plan_frame;
use crate::source::SceneSource;
use crate::stage::camera::{self, Average, Expected};
use crate::stopwatch::Stopwatch;
use crate::{pipeline, record};

/// Reserve of the second plan of a frame whose metered factor exceeds the expected one.
const AGAIN: f64 = 1.05;

/// Nodes of the airlight in a metered, thinned picture. Its rays are too far apart to share nodes, and its error is below the margin
/// for thinning: no factor of a site changed by 1e-3.
const METERING_NODES: usize = 16;

impl Slot {
    /// Plans, renders and exposes a frame. If the metered factor exceeds the expected one, plans for it and renders again within the
    /// bound of the first plan.
    pub(super) fn take(
        &mut self,
        context: &mut FrameContext<'_>,
        mut expected: Option<Expected>,
        watch: &mut Stopwatch,
    ) -> Result<(Taken, FrameRecord), RenderError> {
        let mut promised = None;
        loop {
            let engine = &self.networks.engine;
            context.plan = watch.time("plan", || plan_frame(context, expected, promised, engine))?;
            let mut record = record::begin(context);
            let light = pipeline::render(context, &mut self.kernels, &mut record, watch)?;
            let gathered = self.gather(context, expected, &light, &mut record, watch)?;
            let known = expected
                .filter(|expected| expected.metering.is_none())
                .map(|expected| expected.gain);
            let exposed = gathered
                .map(|picture| watch.time("camera", || camera::expose(context, picture, known, &mut record)));
            let gain = exposed.as_ref().map(|exposed| exposed.gain);
            let promise = context.plan.promised_error();
            match (expected, promise) {
                (Some(limit), Some(promise)) if limit.metering.is_some() && gain > Some(limit.gain) => {
                    expected = Some(Expected {
                        gain: AGAIN * gain.unwrap_or_default(),
                        ..limit
                    });
                    promised = Some(promise);
                    self.kernels.recycle(light.layers);
                }
                _ => {
                    record::finish_plan(&mut record, &context.plan);
                    let exposed = exposed.map(|exposed| exposed.picture);
                    let taken = Taken { light, exposed, gain };
                    return Ok((taken, record));
                }
            }
        }
    }

    /// The picture behind the lens; `None` for a pinhole.
    fn gather(
        &mut self,
        context: &mut FrameContext<'_>,
        expected: Option<Expected>,
        light: &Light,
        record: &mut FrameRecord,
        watch: &mut Stopwatch,
    ) -> Result<Option<Rgb<f32>>, RenderError> {
        let Some(taking) = &context.taking else {
            return Ok(None);
        };
        Ok(Some(if taking.moments.len() > 1 {
            watch.time("movement", || self.average_moments(context, expected, record))?
        } else {
            watch.time("camera", || camera::gather(context, &light.layers.scattered))
        }))
    }

    /// The mean of the pictures of all moments of a frame, row by row. Bands of rows take the labels of their moments.
    fn average_moments(
        &mut self,
        context: &mut FrameContext<'_>,
        expected: Option<Expected>,
        record: &mut FrameRecord,
    ) -> Result<Rgb<f32>, RenderError> {
        let Some(taking) = &context.taking else {
            return Err(RenderError::Panic("a pinhole has no moments".to_owned()));
        };
        let size = taking.parts.size;
        let mut average = Average::new(size);
        let mut seen: Option<Seen> = None;
        let mut worst = ErrorBound::EXACT;
        let mut rolls = false;
        self.visit_moments(context, expected, |slot, at, moment| {
            worst = worse(worst, error_of_light(at));
            let mut own = FrameRecord::default();
            let light = pipeline::render(at, &mut slot.kernels, &mut own, &mut Stopwatch::start())?;
            record::merge_warnings(record, own);
            let picture = camera::gather(at, &light.layers.scattered);
            average.add(&picture, &moment.rows, moment.weight);
            if moment.labels {
                let sampling = at.taking.as_ref().and_then(|taking| taking.sampling.as_deref());
                let labels = Seen::new(at.prepared, sampling);
                match &mut seen {
                    Some(seen) => seen.take_rows(&labels, &moment.rows),
                    None => seen = Some(labels),
                }
            }
            rolls |= moment.rows != (0..size.1);
            slot.kernels.recycle(light.layers);
            Ok(())
        })?;
        count_moments(context, worst);
        if let Some(seen) = &mut seen {
            seen.find_boxes();
        }
        // An even number of pictures has no middle one: the labels of the frame's pose are closer.
        if let Some(taking) = context.taking.as_mut().filter(|_| rolls) {
            taking.seen = seen;
        }
        Ok(average.finish())
    }

    /// Plans all moments of a frame and adds the worst of them to its plan.
    pub(super) fn plan_moments(
        &mut self,
        context: &mut FrameContext<'_>,
        expected: Option<Expected>,
    ) -> Result<(), RenderError> {
        if context
            .taking
            .as_ref()
            .is_none_or(|taking| taking.moments.len() < 2)
        {
            return Ok(());
        }
        let mut worst = ErrorBound::EXACT;
        self.visit_moments(context, expected, |_, at, _| {
            worst = worse(worst, error_of_light(at));
            Ok(())
        })?;
        count_moments(context, worst);
        Ok(())
    }

    /// Calls `visit` with the planned context of each moment of a frame.
    fn visit_moments(
        &mut self,
        context: &FrameContext<'_>,
        expected: Option<Expected>,
        mut visit: impl FnMut(&mut Self, &FrameContext<'_>, &Moment) -> Result<(), RenderError>,
    ) -> Result<(), RenderError> {
        let Some(taking) = &context.taking else {
            return Ok(());
        };
        let place = scene::Place::read(context.frame)?;
        for moment in &taking.moments {
            let prepared = place.prepare(context.frame, taking.parts.source, moment.later)?;
            let unused = &mut Stopwatch::start();
            let mut at = FrameContext::new(
                context.frame,
                &prepared,
                moment.later,
                &mut self.resources,
                unused,
            )?;
            at.apply(
                context.effects.clone(),
                &mut self.resources,
                &mut Stopwatch::start(),
            );
            at.plan = plan_frame(&at, expected, None, &self.networks.engine)?;
            visit(self, &at, moment)?;
        }
        Ok(())
    }

    /// The expected exposure of a frame; `None` without an exposure.
    pub(super) fn expect_exposure(
        &mut self,
        context: &FrameContext<'_>,
    ) -> Result<Option<Expected>, RenderError> {
        let exposure = context.taking.as_ref().and_then(|taking| taking.parts.exposure);
        Ok(Some(match exposure {
            None => return Ok(None),
            Some(Exposure::Fixed(gain)) => Expected::known(gain),
            Some(Exposure::Auto(metering)) if metering.lag_frames > 0.0 => {
                Expected::known(self.meter_sequence(context.frame)?)
            }
            Some(Exposure::Auto(metering)) => {
                let prepared = camera::thin_scene(context.prepared);
                let frame = camera::thin_frame(context.frame, prepared.scene.radiance.size());
                let light = self.render_thin(&frame, &prepared)?;
                Expected::metered(camera::expect_factor(context, &light, &metering), &metering)
            }
        }))
    }

    fn render_thin(&mut self, frame: &Frame, prepared: &scene::Prepared) -> Result<Rgb<f32>, RenderError> {
        let unused = &mut Stopwatch::start();
        let mut context = FrameContext::new(frame, prepared, 0.0, &mut self.thin.resources, unused)?;
        // In a thinned picture a slope has edges, too.
        context.setting.leave_out(StageId::Occlusion);
        context.airlight_nodes = Some(METERING_NODES);
        context.plan = plan_frame(&context, None, None, &self.networks.engine)?;
        let unused = &mut FrameRecord::default();
        let light = pipeline::render(&context, &mut self.thin.kernels, unused, &mut Stopwatch::start())?;
        Ok(light.layers.scattered)
    }

    /// The exposure of a frame in a sequence with lagging exposure: metered at a sixteenth of the sides over all relevant earlier
    /// frames, each with this frame's water.
    fn meter_sequence(&mut self, frame: &Frame) -> Result<f64, RenderError> {
        let mut gain = None;
        for small in camera::metered_frames(frame) {
            let prepared = self.scene(&small, &SceneSource::Local)?;
            let unused = &mut Stopwatch::start();
            let mut context = FrameContext::new(&small, &prepared, 0.0, &mut self.thin.resources, unused)?;
            context.setting.leave_out(StageId::Occlusion);
            context.plan = plan_frame(&context, None, None, &self.networks.engine)?;
            let own = &mut FrameRecord::default();
            let light = pipeline::render(&context, &mut self.thin.kernels, own, &mut Stopwatch::start())?;
            gain = camera::follow(&context, &camera::gather(&context, &light.layers.scattered), gain);
            self.thin.kernels.recycle(light.layers);
        }
        Ok(gain.unwrap_or(1.0))
    }
}

/// Error bound of the light in front of the camera.
fn error_of_light(context: &FrameContext<'_>) -> ErrorBound {
    let before = context
        .plan
        .stages
        .iter()
        .filter(|stage| stage.id < StageId::Movement);
    compose(before).into_iter().fold(ErrorBound::EXACT, worse)
}

fn worse(one: ErrorBound, other: ErrorBound) -> ErrorBound {
    ErrorBound {
        absolute: one.absolute.max(other.absolute),
        relative: one.relative.max(other.relative),
    }
}

/// Adds the excess of the worst moment of a frame over its pose.
fn count_moments(context: &mut FrameContext<'_>, worst: ErrorBound) {
    let before = context
        .plan
        .stages
        .iter()
        .filter(|stage| stage.id < StageId::Movement);
    let own = compose(before)
        .into_iter()
        .fold(worst, |least, error| ErrorBound {
            absolute: least.absolute.min(error.absolute),
            relative: least.relative.min(error.relative),
        });
    let stages = &mut context.plan.stages;
    if let Some(movement) = stages.iter_mut().find(|stage| stage.id == StageId::Movement) {
        let more = ErrorBound {
            absolute: worst.absolute - own.absolute,
            relative: worst.relative - own.relative,
        };
        movement.bound = movement.bound.map(|bound| bound.plus(more));
    }
}
