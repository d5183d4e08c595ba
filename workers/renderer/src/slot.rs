//! The way of one frame.

use std::sync::Arc;

use imaging::transfer;
use optics::forward_scatter::KernelCache;
use spec::{Camera, Counts, Frame, Scene};

use crate::engine::Engine;
use crate::error::RenderError;
use crate::record::{self, Findings, Rendered};
use crate::source::SceneSource;
use crate::stage::files::{self, Products};
use crate::stage::scene::{self, Prepared};
use crate::stage::water::{self, Chosen};
use crate::stage::{enhance, haze, labels, lamps, measure, snow, style, turbidity};
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
        let lights = frame.haze();

        let prepared = watch.time("scene", || self.scene(frame, source))?;
        let radiance = &prepared.scene.radiance;
        let water = water::resolve(frame, &prepared)?;
        let patches = watch.time("turbidity", || {
            turbidity::patches(frame, &prepared, water.as_ref())
        })?;
        let lighting = lamps::lighting(frame, &prepared, water.as_ref(), patches.as_ref())?;
        let lit = lighting.as_ref().and_then(|lighting| {
            watch.time("lamps", || lamps::surfaces(&prepared, lighting, water.as_ref()))
        });
        let shown = lit.as_ref().map(|(lit, _)| lit);
        let chosen = watch.time("plan", || {
            water::choose(frame, &prepared, shown, (water, patches), &lights)
        });
        let shown = shown.unwrap_or(radiance);
        let mut layers = watch.time("water", || {
            water::run(&prepared, shown, &chosen, &mut self.kernels)
        })?;
        let glows = lighting.as_ref().is_some_and(|lighting| {
            let share = chosen.shares.lamps;
            watch.time("lamps", || {
                lamps::glow(frame, &prepared, lighting, share, &mut layers)
            })
        });
        let dark = lit.is_some_and(|(_, shines)| !shines) && !glows;
        let fallen = watch.time("snow", || {
            snow::run(frame, &prepared, &chosen, lighting.as_ref(), &mut layers)
        })?;
        let styled = watch.time("style", || {
            style::run(frame, &layers.scattered, &self.engine, &mut self.sessions)
        })?;
        let hazed = watch.time("haze", || haze::run(&styled.picture, &lights));
        let (rgb, clamped) = watch.time("encode", || transfer::encode_rgb8(&hazed));
        let enhanced = watch.time("enhance", || enhance::run(frame, &rgb))?;
        let clean = match measure::needs_clean(frame)? {
            true => Some(watch.time("encode", || transfer::encode_rgb8(radiance).0)),
            false => None,
        };
        let measurements = watch.time("metrics", || measure::run(frame, &rgb, clean.as_ref(), &enhanced))?;
        let described = watch.time("labels", || labels::describe(&prepared, &chosen, &layers));
        let products = Products {
            frame,
            prepared: &prepared,
            chosen: &chosen,
            layers: &layers,
            styled: &styled.picture,
            rgb: &rgb,
            enhanced: &enhanced,
            described: described.as_ref(),
            fallen: fallen.as_ref(),
        };
        let files = watch.time("files", || files::encode(&products))?;

        let counts = Counts {
            holes: prepared.holes,
            negative_radiance: prepared.negative_radiance,
            clamped,
            range_saturated: files.range_saturated,
        };
        let mut inputs = prepared.inputs.clone();
        inputs.extend(
            styled
                .model
                .iter()
                .map(|(name, digest)| (format!("style.{name}"), digest.clone())),
        );
        let ran = Some(&self.engine).filter(|_| styled.on_runtime);
        let ran = ran.and_then(|engine| engine.runtime().ok());
        let findings = Findings {
            frame,
            camera: Camera::of_picture(radiance.width(), radiance.height(), prepared.focal_px),
            chosen: &chosen,
            factors: chosen
                .patches
                .as_ref()
                .zip(prepared.scene.range.as_ref())
                .and_then(|(patches, range)| patches.factors(range)),
            fallen: fallen.as_ref(),
            measurements,
            counts,
            timings_ms: watch.stop(),
            warnings: warnings(frame, &prepared, &chosen)
                .into_iter()
                .chain(water::diffuse_in_disguise(frame))
                .chain(dark.then(|| "no lamp lights anything in view".to_owned()))
                .chain(enhance::warnings(&enhanced))
                .chain(files.warnings)
                .collect(),
            inputs,
            scene: described,
            onnx_runtime: ran.map(|runtime| runtime.version().to_owned()),
        };
        let rendered = record::finish(files.files, findings);
        self.kernels.recycle(layers);
        Ok(rendered)
    }

    /// What a frame would be rendered with: a list of stages, each with its variant and what bounds its error.
    ///
    /// # Errors
    /// [`RenderError`] of the scene or the water.
    pub fn plan(&mut self, frame: &Frame, source: &SceneSource) -> Result<serde_json::Value, RenderError> {
        let prepared = self.scene(frame, source)?;
        let water = water::resolve(frame, &prepared)?;
        let patches = turbidity::patches(frame, &prepared, water.as_ref())?;
        let lighting = lamps::lighting(frame, &prepared, water.as_ref(), patches.as_ref())?;
        let lit = lighting
            .as_ref()
            .and_then(|lighting| lamps::surfaces(&prepared, lighting, water.as_ref()));
        let lit = lit.as_ref().map(|(lit, _)| lit);
        let chosen = water::choose(frame, &prepared, lit, (water, patches), &frame.haze());
        Ok(record::plan(frame, &chosen, None))
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

fn warnings(frame: &Frame, prepared: &Prepared, chosen: &Chosen) -> Vec<String> {
    let mut warnings = Vec::new();
    if frame.water.optics.is_some() && chosen.water.is_none() {
        warnings.push("the scene has no range: the water's optics are skipped".to_owned());
    }
    if frame.has_lamps() && prepared.scene.range.is_none() {
        warnings.push("the scene has no range: the lamps are skipped".to_owned());
    }
    if frame.water.snow.is_some() && prepared.scene.range.is_none() {
        warnings.push("the scene has no range: the snow is skipped".to_owned());
    }
    let pixels = prepared
        .scene
        .range
        .as_ref()
        .map_or(0, |range| range.data().len() as u64);
    if pixels > 0 && prepared.holes == pixels {
        warnings.push("no pixel has a valid range".to_owned());
    }
    warnings
}
