//! The pipeline of one frame.

pub(crate) mod costs;
mod distance;
mod effects;
mod exposure;
mod kept;
mod sequence;
mod state;

use std::sync::Arc;

use imaging::Rgb;
use optics::forward_scatter::KernelCache;
use optics::plan::{Plan, StageId};
use spec::{Camera, Frame, FrameRecord, Scene};

use crate::content::Contents;
use crate::context::{FrameContext, Resources};
use crate::engine::Engine;
use crate::error::RenderError;
use crate::file::File;
use crate::inputs::camera::rendered_parts;
use crate::inputs::scene::{self, Prepared};
use crate::planning::plan_frame;
use crate::plausibility;
use crate::sequence::{History, find_motions};
use crate::source::SceneSource;
use crate::stage::files::{self, Pictures};
use crate::stage::measure::{self, Measured};
use crate::stage::networks::PictureNetworks;
use crate::stage::style::Networks;
use crate::stage::{camera, enhance, haze, labels, model_error, truth};
use crate::stopwatch::Stopwatch;
use costs::{CostScale, StageCost, list_costs};
use state::{RightCaches, SceneKey, Taken, Thin};

pub use distance::FrameTruth;
pub use state::Slot;

/// A rendered frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Rendered {
    /// The requested artifacts.
    pub files: Vec<File>,
    /// Everything known about the image.
    pub record: FrameRecord,
}

/// The linear light of a frame before haze and encoding.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearPicture {
    /// Linear light, white = 1.
    pub radiance: Rgb<f32>,
    /// The plan of the frame.
    pub plan: Plan,
}

/// The contents of a frame, and the costs of its plan.
pub(crate) struct PlannedContents {
    pub(crate) contents: Contents,
    pub(crate) costs: Vec<StageCost>,
}

impl Slot {
    /// A slot with empty caches.
    #[must_use]
    pub fn new(engine: &Arc<Engine>) -> Self {
        Self {
            networks: Networks::new(engine),
            picture_networks: PictureNetworks::new(engine),
            kernels: KernelCache::new(),
            resources: Resources::default(),
            thin: Thin::default(),
            last_scene: None,
            right: RightCaches::default(),
            history: History::default(),
            excluded: Vec::new(),
            kept_effects: None,
            costs: CostScale::default(),
        }
    }

    /// Excludes these effects from all further frames of any fidelity: for comparisons of the remaining stages. Effects that every
    /// frame has are not excluded.
    pub fn exclude(&mut self, effects: Vec<StageId>) {
        self.excluded = effects;
    }

    /// Renders a frame. Its bytes do not depend on earlier frames of the slot.
    ///
    /// # Errors
    /// [`RenderError`]; its `retryable` reports whether a retry may succeed.
    pub fn render(&mut self, frame: &Frame, source: &SceneSource) -> Result<Rendered, RenderError> {
        let (files, record) = self.run(frame, source, files::encode)?;
        Ok(Rendered { files, record })
    }

    /// Renders a frame with its artifacts like [`Slot::render`], also if its scene is cached, and returns only its plan: to measure
    /// the time of a whole frame.
    ///
    /// # Errors
    /// As [`Slot::render`].
    pub fn render_for_plan(&mut self, frame: &Frame, source: &SceneSource) -> Result<Plan, RenderError> {
        self.last_scene = None;
        let (plan, _) = self.run(frame, source, |context, pictures, record| {
            files::encode(context, pictures, record)?;
            Ok(context.plan.clone())
        })?;
        Ok(plan)
    }

    /// Renders a frame without encoding its artifacts.
    ///
    /// # Errors
    /// As [`Slot::render`].
    pub fn contents(&mut self, frame: &Frame, source: &SceneSource) -> Result<Contents, RenderError> {
        let (artifacts, record) = self.run(frame, source, files::contents)?;
        Ok(Contents { artifacts, record })
    }

    /// Renders a frame up to its haze, for comparison with another rendering in linear light.
    ///
    /// # Errors
    /// As [`Slot::render`].
    pub fn linear(&mut self, frame: &Frame, source: &SceneSource) -> Result<LinearPicture, RenderError> {
        let (picture, _) = self.run(frame, source, |context, pictures, _| {
            Ok(LinearPicture {
                radiance: pictures.styled.clone(),
                plan: context.plan.clone(),
            })
        })?;
        Ok(picture)
    }

    /// Runs the pipeline, then calls `finish`.
    fn run<T>(
        &mut self,
        frame: &Frame,
        source: &SceneSource,
        finish: impl FnOnce(&FrameContext<'_>, &Pictures<'_>, &mut FrameRecord) -> Result<T, RenderError>,
    ) -> Result<(T, FrameRecord), RenderError> {
        let mut watch = Stopwatch::start();
        let completed = &*camera::complete(frame);
        let prepared = watch.time("scene", || self.scene(completed, source))?;
        self.run_prepared((frame, completed), (&prepared, source), watch, finish)
    }

    /// Renders a frame of a scene that the caller prepared, without encoding its artifacts. `watch` has the time so far.
    pub(crate) fn contents_of(
        &mut self,
        frame: &Frame,
        prepared: &Prepared,
        watch: Stopwatch,
    ) -> Result<PlannedContents, RenderError> {
        let completed = &*camera::complete(frame);
        let scene = (prepared, &SceneSource::Local);
        let ((artifacts, costs), record) =
            self.run_prepared((frame, completed), scene, watch, |context, pictures, record| {
                let artifacts = files::contents(context, pictures, record)?;
                Ok((artifacts, list_costs(&context.plan)))
            })?;
        let contents = Contents { artifacts, record };
        Ok(PlannedContents { contents, costs })
    }

    fn run_prepared<T>(
        &mut self,
        (described, frame): (&Frame, &Frame),
        (prepared, source): (&Prepared, &SceneSource),
        mut watch: Stopwatch,
        finish: impl FnOnce(&FrameContext<'_>, &Pictures<'_>, &mut FrameRecord) -> Result<T, RenderError>,
    ) -> Result<(T, FrameRecord), RenderError> {
        let mut context = FrameContext::new(frame, prepared, 0.0, &mut self.resources, &mut watch)?;
        let expected = watch.time("plan", || self.expect_exposure(&context))?;
        self.choose_effects(&mut context, expected, &mut watch)?;
        let (taken, mut record) = self.take(&mut context, expected, &mut watch)?;
        let Taken { light, exposed, .. } = &taken;
        let context = &context;
        record
            .warnings
            .extend(effects::find_overrun(context, &self.costs));
        model_error::run(context, &light.layers, &mut record);
        let traced = if truth::is_asked(context) {
            watch.time("truth", || truth::run(context, light, &mut record))?
        } else {
            None
        };
        let exposed = exposed.as_ref().unwrap_or(&light.layers.scattered);
        let styled = watch.time("style", || self.networks.run(context, exposed, &mut record))?;
        let hazed = watch.time("haze", || haze::run(context, &styled));

        let cameras = &mut self.resources.cameras;
        let mut developed = watch.time("encode", || {
            camera::develop(context, &hazed, cameras, &mut record)
        });
        if faults::frame_point("rgb.wrong", frame.index) {
            developed.rgb.data_mut()[0] ^= 1;
        }
        record.counts.clamped += developed.clamped;
        let warnings = plausibility::list_warnings(context, &developed.rgb, record.counts.clamped);
        record.warnings.extend(warnings);
        let networks = &mut self.picture_networks;
        let enhancements = watch.time("enhance", || {
            enhance::run(context, &developed.rgb, networks, &mut record)
        })?;
        let track = watch.time("previous", || {
            self.track(described, (context, &developed), source)
        })?;
        watch.time("metrics", || {
            let inputs = Measured {
                layers: &light.layers,
                rgb: &developed.rgb,
                enhancements: &enhancements,
                track: track.as_ref(),
            };
            measure::run(context, &inputs, &mut self.picture_networks, &mut record)
        })?;
        self.picture_networks.record(frame, &mut record);
        record.scene = watch.time("labels", || labels::describe(context, &light.layers));

        let motions = find_motions(context, &mut watch)?;
        let right = self.take_right(context, (&taken, &developed), &mut record, &mut watch)?;
        self.keep(described, context, &developed);

        let pictures = Pictures {
            layers: &light.layers,
            snow: light.mask.as_ref(),
            styled: &styled,
            developed: &developed,
            enhancements: &enhancements,
            traced: traced.as_ref(),
            right: right.as_ref(),
            motions: &motions,
        };
        let made = watch.time("files", || finish(context, &pictures, &mut record))?;
        record.timings_ms = watch.stop();
        drop(styled);
        self.kernels.recycle(taken.light.layers);
        Ok((made, record))
    }

    /// Plans a frame without rendering it.
    ///
    /// # Errors
    /// [`RenderError`] from the scene, the water or the style.
    pub fn plan(&mut self, frame: &Frame, source: &SceneSource) -> Result<Plan, RenderError> {
        let frame = &*camera::complete(frame);
        let prepared = self.scene(frame, source)?;
        let unused = &mut Stopwatch::start();
        let mut context = FrameContext::new(frame, &prepared, 0.0, &mut self.resources, unused)?;
        let expected = self.expect_exposure(&context)?;
        self.choose_effects(&mut context, expected, unused)?;
        context.plan = plan_frame(&context, expected, None, &self.networks.engine)?;
        self.plan_moments(&mut context, expected)?;
        Ok(context.plan)
    }

    /// The scene of a frame. The last one is cached, since a job often shows one scene in many waters.
    fn scene(&mut self, frame: &Frame, source: &SceneSource) -> Result<Arc<Prepared>, RenderError> {
        let source_view = rendered_parts(frame)?.and_then(|parts| parts.source);
        let Camera {
            width,
            height,
            hfov_deg,
            path,
            view,
            ..
        } = frame.camera;
        let key = SceneKey {
            scene: frame.scene.clone(),
            camera: Camera {
                path,
                view,
                ..Camera::pinhole(width, height, hfov_deg)
            },
            depth_m: frame.water.depth_m,
            view: source_view,
            labeled: scene::needs_labels(frame),
            right_m: frame.right_m,
        };
        if let Some((last, prepared)) = &self.last_scene
            && *last == key
        {
            return Ok(Arc::clone(prepared));
        }
        let prepared = Arc::new(scene::prepare(frame, source, source_view)?);
        self.last_scene = match frame.scene {
            Scene::Files { .. } => None,
            _ => Some((key, Arc::clone(&prepared))),
        };
        Ok(prepared)
    }
}
