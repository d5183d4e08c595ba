//! Other pictures that a frame needs: that of its right camera, and the previous one of its path.

use std::mem::swap;
use std::sync::Arc;

use quality::{MetricId, Needs};
use spec::{ArtifactKind, Frame, FrameRecord};

use super::state::{Slot, Taken};
use crate::context::FrameContext;
use crate::error::RenderError;
use crate::sequence::{Developing, Held, Track, right_frame};
use crate::source::SceneSource;
use crate::stage::camera::{self, Developed};
use crate::stage::haze;
use crate::stopwatch::Stopwatch;

impl Slot {
    /// The picture of the previous frame on the path: a cached one, or rendered again without artifacts, enhancements and metrics,
    /// with the same result. `None` for the first frame of a path and for a frame without a path.
    ///
    /// # Errors
    /// As [`Slot::render`], for the previous frame.
    pub fn previous(
        &mut self,
        frame: &Frame,
        source: &SceneSource,
    ) -> Result<Option<Arc<Held>>, RenderError> {
        let Some(previous) = frame.previous().map_err(RenderError::Resolve)? else {
            return Ok(None);
        };
        if let Some(held) = self.history.find(&previous) {
            return Ok(Some(held));
        }
        let (held, _) = self.picture(&previous, source, |context, developed| {
            Held::new(context, &developed.rgb).map(Arc::new)
        })?;
        if let Some(held) = &held {
            self.history.insert(previous, Arc::clone(held));
        }
        Ok(held)
    }

    /// Keeps the picture of a frame if pictures of earlier frames were ever requested.
    pub(super) fn keep(&mut self, frame: &Frame, context: &FrameContext<'_>, developed: &Developed) {
        let is_needed = self.history.is_used() && frame.camera.path.is_some();
        if is_needed && self.history.find(frame).is_none() {
            let held = Held::new(context, &developed.rgb).map(Arc::new);
            held.into_iter()
                .for_each(|held| self.history.insert(frame.clone(), held));
        }
    }

    /// The picture of a frame, which is kept, and as many earlier ones of its path as the metrics need. `None` if they need
    /// none, and for a scene without a pose.
    pub(super) fn track(
        &mut self,
        frame: &Frame,
        (context, developed): (&FrameContext<'_>, &Developed),
        source: &SceneSource,
    ) -> Result<Option<Track>, RenderError> {
        let most = count_previous(&frame.metrics);
        let held = (most > 0).then(|| Held::new(context, &developed.rgb)).flatten();
        let Some(own) = held.map(Arc::new) else {
            return Ok(None);
        };
        self.history.insert(frame.clone(), Arc::clone(&own));
        let mut pictures = vec![own];
        let mut newest = frame.clone();
        while pictures.len() <= most
            && let Some(held) = self.previous(&newest, source)?
            && let Some(previous) = newest.previous().map_err(RenderError::Resolve)?
        {
            pictures.push(held);
            newest = previous;
        }
        Ok(Some(Track::new(pictures)))
    }

    /// The picture of the right camera, if an artifact needs them. Adds warnings that the left picture does not have.
    pub(super) fn take_right(
        &mut self,
        context: &FrameContext<'_>,
        (taken, developed): (&Taken, &Developed),
        record: &mut FrameRecord,
        watch: &mut Stopwatch,
    ) -> Result<Option<Developed>, RenderError> {
        let left = Developing {
            gain: taken.gain,
            balance: developed.balance,
        };
        let is_asked = context.frame.artifacts.contains(&ArtifactKind::RgbRight);
        let right = is_asked.then(|| right_frame(context.frame, &left)).flatten();
        let Some(right) = right else {
            return Ok(None);
        };
        self.exchange_caches();
        let taken = watch.time("right", || {
            self.picture(&right, &SceneSource::Local, |_, developed| developed)
        });
        self.exchange_caches();
        let (developed, own) = taken?;
        let warnings = own.warnings.into_iter();
        let new: Vec<String> = warnings.filter(|text| !record.warnings.contains(text)).collect();
        record
            .warnings
            .extend(new.into_iter().map(|text| format!("rgb_right: {text}")));
        Ok(Some(developed))
    }

    fn exchange_caches(&mut self) {
        swap(&mut self.resources, &mut self.right.resources);
        swap(&mut self.last_scene, &mut self.right.last_scene);
    }

    /// Renders a frame up to its codes, then calls `finish`.
    fn picture<T>(
        &mut self,
        frame: &Frame,
        source: &SceneSource,
        finish: impl FnOnce(&FrameContext<'_>, Developed) -> T,
    ) -> Result<(T, FrameRecord), RenderError> {
        let watch = &mut Stopwatch::start();
        let frame = &*camera::complete(frame);
        let prepared = self.scene(frame, source)?;
        let mut context = FrameContext::new(frame, &prepared, 0.0, &mut self.resources, watch)?;
        let expected = self.expect_exposure(&context)?;
        self.choose_effects(&mut context, expected, watch)?;
        let (taken, mut record) = self.take(&mut context, expected, watch)?;
        let exposed = taken.exposed.as_ref().unwrap_or(&taken.light.layers.scattered);
        let styled = self.networks.run(&context, exposed, &mut record)?;
        let hazed = haze::run(&context, &styled);
        let developed = camera::develop(&context, &hazed, &mut self.resources.cameras, &mut record);
        let result = finish(&context, developed);
        drop(hazed);
        drop(styled);
        self.kernels.recycle(taken.light.layers);
        Ok((result, record))
    }
}

/// The most previous frames that one of the metrics compares with.
fn count_previous(metrics: &[String]) -> usize {
    let needs = metrics.iter().filter_map(|name| MetricId::parse(name));
    let counts = needs.map(|metric| match metric.info().needs {
        Needs::PreviousFrames(frames) => frames,
        Needs::Nothing | Needs::PictureInAir | Needs::Illumination => 0,
    });
    counts.max().unwrap_or(0)
}
