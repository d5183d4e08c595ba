//! The pipeline of one frame.

use std::sync::Arc;

use imaging::{Rgb, transfer};
use optics::forward_scatter::KernelCache;
use optics::plan::{Given, Plan};
use optics::setting::Setting;
use optics::snow::peak;
use spec::{Camera, Frame, FrameRecord, Scene};

use crate::content::Contents;
use crate::engine::Engine;
use crate::error::RenderError;
use crate::file::File;
use crate::record;
use crate::source::SceneSource;
use crate::stage::files::{self, Pictures};
use crate::stage::light::Lit;
use crate::stage::scene::{self, Prepared};
use crate::stage::style::{self, Networks};
use crate::stage::{Shot, enhance, glow, haze, labels, measure, snow, water};
use crate::stopwatch::Stopwatch;

/// Caches that one worker thread reuses between frames. They never change a result.
pub struct Slot {
    pub(crate) networks: Networks,
    kernels: KernelCache,
    last_scene: Option<(SceneKey, Arc<Prepared>)>,
}

/// A rendered frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Rendered {
    /// The artifacts that the frame asks for.
    pub files: Vec<File>,
    /// Everything known about the image.
    pub record: FrameRecord,
}

/// The linear light of a frame before haze and encoding.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearPicture {
    /// Linear light, white = 1.
    pub radiance: Rgb<f32>,
    /// The plan by which it was rendered.
    pub plan: Plan,
}

/// What a prepared scene depends on. Scenes from local files are not kept: the files may change.
#[derive(PartialEq)]
struct SceneKey {
    scene: Scene,
    camera: Camera,
    labeled: bool,
}

impl Slot {
    /// A slot with empty caches.
    #[must_use]
    pub fn new(engine: &Arc<Engine>) -> Self {
        Self {
            networks: Networks::new(engine),
            kernels: KernelCache::new(),
            last_scene: None,
        }
    }

    /// Renders a frame: the same bytes whatever the slot has rendered before.
    ///
    /// # Errors
    /// [`RenderError`], which says whether trying again can help.
    pub fn render(&mut self, frame: &Frame, source: &SceneSource) -> Result<Rendered, RenderError> {
        let (files, record) = self.run(frame, source, files::encode)?;
        Ok(Rendered { files, record })
    }

    /// Renders a frame without encoding its artifacts.
    ///
    /// # Errors
    /// As [`Slot::render`].
    pub fn contents(&mut self, frame: &Frame, source: &SceneSource) -> Result<Contents, RenderError> {
        let (artifacts, record) = self.run(frame, source, files::contents)?;
        Ok(Contents { artifacts, record })
    }

    /// Renders a frame up to its haze, to be compared with another rendering in linear light.
    ///
    /// # Errors
    /// As [`Slot::render`].
    pub fn linear(&mut self, frame: &Frame, source: &SceneSource) -> Result<LinearPicture, RenderError> {
        let picture = |shot: &Shot<'_>, pictures: &Pictures<'_>, _: &mut FrameRecord| {
            Ok(LinearPicture {
                radiance: pictures.styled.clone(),
                plan: shot.plan.clone(),
            })
        };
        Ok(self.run(frame, source, picture)?.0)
    }

    /// Runs all stages and gives what they made to the last one.
    fn run<T>(
        &mut self,
        frame: &Frame,
        source: &SceneSource,
        last: impl FnOnce(&Shot<'_>, &Pictures<'_>, &mut FrameRecord) -> Result<T, RenderError>,
    ) -> Result<(T, FrameRecord), RenderError> {
        let mut watch = Stopwatch::start();
        let shot = &self.resolve(frame, source, &mut watch)?;
        let mut record = record::begin(shot);

        let mut layers = watch.time("water", || water::run(shot, &mut self.kernels))?;
        glow::run(shot, &mut layers, &mut record);
        let snow = watch.time("snow", || snow::run(shot, &mut layers, &mut record));
        let scattered = &layers.scattered;
        let styled = watch.time("style", || self.networks.run(shot, scattered, &mut record))?;
        let hazed = watch.time("haze", || haze::run(shot, &styled));

        let (mut rgb, clamped) = watch.time("encode", || transfer::encode_rgb8(&hazed));
        if faults::frame_point("rgb.wrong", frame.index) {
            rgb.data_mut()[0] ^= 1;
        }
        record.counts.clamped = clamped;
        let enhancements = watch.time("enhance", || enhance::run(shot, &rgb, &mut record))?;
        watch.time("metrics", || measure::run(shot, &rgb, &enhancements, &mut record))?;
        record.scene = watch.time("labels", || labels::describe(shot, &layers));

        let pictures = Pictures {
            layers: &layers,
            snow: snow.as_ref(),
            styled: &styled,
            rgb: &rgb,
            enhancements: &enhancements,
        };
        let made = watch.time("files", || last(shot, &pictures, &mut record))?;
        record.timings_ms = watch.stop();
        self.kernels.recycle(layers);
        Ok((made, record))
    }

    /// Plans a frame without rendering it.
    ///
    /// # Errors
    /// [`RenderError`] from the scene, the water or the style.
    pub fn plan(&mut self, frame: &Frame, source: &SceneSource) -> Result<Plan, RenderError> {
        Ok(self.resolve(frame, source, &mut Stopwatch::start())?.plan)
    }

    /// Fetches the scene, resolves its setting, lights it and plans the remaining stages.
    fn resolve<'a>(
        &mut self,
        frame: &'a Frame,
        source: &SceneSource,
        watch: &mut Stopwatch,
    ) -> Result<Shot<'a>, RenderError> {
        let prepared = watch.time("scene", || self.scene(frame, source))?;
        let setting = Setting::resolve(frame, &prepared.view()).map_err(RenderError::Setting)?;
        let lit = Lit::new(frame, &prepared, &setting, watch);
        let table_max_255 = style::table_max_255(frame, &self.networks.engine)?;
        let plan = watch.time("plan", || {
            Plan::new(&Given {
                frame,
                setting: &setting,
                stats: &lit.measure(&setting),
                lamps: lit.lamps,
                snow_peak: peak(&lit.flakes),
                table_max_255,
            })
        });
        Ok(Shot {
            frame,
            prepared,
            setting,
            lit,
            plan,
        })
    }

    /// The scene of a frame; the last one is kept, since a job often shows one scene in many waters.
    fn scene(&mut self, frame: &Frame, source: &SceneSource) -> Result<Arc<Prepared>, RenderError> {
        let key = SceneKey {
            scene: frame.scene.clone(),
            camera: frame.camera,
            labeled: scene::needs_labels(frame),
        };
        if let Some((last, prepared)) = &self.last_scene
            && *last == key
        {
            return Ok(Arc::clone(prepared));
        }
        let prepared = Arc::new(scene::prepare(frame, source)?);
        self.last_scene = match frame.scene {
            Scene::Files { .. } => None,
            _ => Some((key, Arc::clone(&prepared))),
        };
        Ok(prepared)
    }
}
