//! The way of one frame.

use std::sync::Arc;

use imaging::transfer;
use optics::forward_scatter::KernelCache;
use optics::plan::{Given, Plan};
use optics::setting::Setting;
use spec::{Frame, Scene};

use crate::engine::Engine;
use crate::error::RenderError;
use crate::record::{self, Rendered};
use crate::source::SceneSource;
use crate::stage::files::{self, Products};
use crate::stage::light::Lit;
use crate::stage::scene::{self, Prepared};
use crate::stage::{enhance, haze, labels, measure, snow, style, water};
use crate::stopwatch::Stopwatch;

/// What one worker thread reuses from frame to frame. Nothing in it changes a result.
pub struct Slot {
    engine: Arc<Engine>,
    kernels: KernelCache,
    sessions: style::Sessions,
    last_scene: Option<(SceneKey, Arc<Prepared>)>,
}

/// What a prepared scene depends on; files of this machine may change and have none.
#[derive(PartialEq)]
struct SceneKey {
    scene: Scene,
    camera: spec::Camera,
    labelled: bool,
}

impl Slot {
    /// A slot with empty caches.
    #[must_use]
    pub fn new(engine: &Arc<Engine>) -> Self {
        Self {
            engine: Arc::clone(engine),
            kernels: KernelCache::new(),
            sessions: style::Sessions::default(),
            last_scene: None,
        }
    }

    /// Renders a frame: the same bytes whatever the slot has rendered before.
    ///
    /// # Errors
    /// [`RenderError`], which says whether trying again can help.
    pub fn render(&mut self, frame: &Frame, source: &SceneSource) -> Result<Rendered, RenderError> {
        let mut watch = Stopwatch::start();
        let prepared = watch.time("scene", || self.scene(frame, source))?;
        let setting = Setting::resolve(frame, &prepared.view()).map_err(RenderError::Setting)?;
        let lit = Lit::new(frame, &prepared, &setting, &mut watch);
        let plan = watch.time("plan", || self.choose(frame, &setting, &lit))?;
        let mut layers = watch.time("water", || water::run(&lit, &setting, &plan, &mut self.kernels))?;
        let glows = water::glow(&prepared, &setting, &plan, &mut layers, &mut watch);
        let fallen = watch.time("snow", || snow::run(&prepared, &setting, &plan, &mut layers));
        let styled = watch.time("style", || {
            style::run(
                frame,
                plan.style.form,
                &layers.scattered,
                &self.engine,
                &mut self.sessions,
            )
        })?;
        let hazed = watch.time("haze", || haze::run(frame, &plan, &styled.picture));
        let (rgb, clamped) = watch.time("encode", || transfer::encode_rgb8(&hazed));
        let enhanced = watch.time("enhance", || enhance::run(frame, &rgb))?;
        let measurements = measure::run(frame, &rgb, &prepared.scene.radiance, &enhanced, &mut watch)?;
        let described = watch.time("labels", || labels::describe(&prepared, &setting, &lit, &layers));
        let products = Products {
            frame,
            prepared: &prepared,
            setting: &setting,
            lit: &lit,
            plan: &plan,
            layers: &layers,
            glows,
            fallen: fallen.as_ref(),
            styled: &styled,
            rgb: &rgb,
            clamped,
            enhanced: &enhanced,
            measurements,
            described,
        };
        let files = watch.time("files", || files::encode(&products))?;
        let rendered = record::finish(products, files, watch.stop());
        self.kernels.recycle(layers);
        Ok(rendered)
    }

    /// What a frame would be rendered with.
    ///
    /// # Errors
    /// [`RenderError`] of the scene, the water or the style.
    pub fn plan(&mut self, frame: &Frame, source: &SceneSource) -> Result<Plan, RenderError> {
        let prepared = self.scene(frame, source)?;
        let setting = Setting::resolve(frame, &prepared.view()).map_err(RenderError::Setting)?;
        let lit = Lit::new(frame, &prepared, &setting, &mut Stopwatch::start());
        self.choose(frame, &setting, &lit)
    }

    fn choose(&self, frame: &Frame, setting: &Setting, lit: &Lit<'_>) -> Result<Plan, RenderError> {
        let stats = lit.measure(setting);
        Ok(Plan::new(&Given {
            frame,
            setting,
            stats: &stats,
            table_max_255: style::table_max_255(frame, &self.engine)?,
        }))
    }

    /// The scene of a frame; the last one is kept, since a job often shows one scene in many waters.
    fn scene(&mut self, frame: &Frame, source: &SceneSource) -> Result<Arc<Prepared>, RenderError> {
        let key = SceneKey {
            scene: frame.scene.clone(),
            camera: frame.camera,
            labelled: scene::needs_labels(frame),
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
