//! The pipeline of one frame.

mod light;

use std::sync::Arc;

use ::camera::Parts;
use ::camera::geometry::Source;
use imaging::Rgb;
use optics::chain::Layers;
use optics::forward_scatter::KernelCache;
use optics::plan::{Given, Plan};
use optics::sediment::Layers as Clouds;
use optics::setting::Setting;
use optics::snow::peak;
use spec::{Camera, Exposure, Frame, FrameRecord, Scene};

use crate::content::Contents;
use crate::engine::Engine;
use crate::error::RenderError;
use crate::file::File;
use crate::frame_plan::FramePlan;
use crate::record;
use crate::source::SceneSource;
use crate::stage::above::LastTiles;
use crate::stage::camera::{self, Average, Cameras};
use crate::stage::files::{self, Pictures};
use crate::stage::light::Lit;
use crate::stage::scene::{self, Prepared};
use crate::stage::seen::Seen;
use crate::stage::snow::Shutter;
use crate::stage::style::{self, Networks};
use crate::stage::{Shot, enhance, glow, haze, labels, measure, snow, truth, water};
use crate::stopwatch::Stopwatch;

pub use light::WaterLight;

/// Caches that one worker thread reuses between frames. They never change a result.
pub struct Slot {
    pub(crate) networks: Networks,
    kernels: KernelCache,
    cameras: Cameras,
    tiles: LastTiles,
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
    /// Its sides, field of view and path.
    camera: Camera,
    /// What its lens looks into.
    view: Option<Source>,
    labeled: bool,
}

impl Slot {
    /// A slot with empty caches.
    #[must_use]
    pub fn new(engine: &Arc<Engine>) -> Self {
        Self {
            networks: Networks::new(engine),
            kernels: KernelCache::new(),
            cameras: Cameras::default(),
            tiles: LastTiles::default(),
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
        let within_noise = camera::with_tolerance(frame);
        let frame = within_noise.as_ref().unwrap_or(frame);
        let mut shot = self.resolve(frame, source, &mut watch)?;
        let mut record = record::begin(&shot);

        let mut layers = watch.time("water", || water::run(&shot, &mut self.kernels))?;
        glow::run(&shot, &mut layers, &mut record);
        let traced = if truth::is_asked(&shot) {
            watch.time("truth", || truth::run(&shot, &layers, &mut record))?
        } else {
            None
        };
        let snow = watch.time("snow", || snow::run(&shot, &mut layers, &mut record));
        // Those of a large frame are large, and are drawn by now.
        shot.lit.clouds = None;
        let taken = self.take(&mut shot, &layers, &mut record, &mut watch)?;
        let shot = &shot;
        let scattered = taken.as_ref().unwrap_or(&layers.scattered);
        let styled = watch.time("style", || self.networks.run(shot, scattered, &mut record))?;
        let hazed = watch.time("haze", || haze::run(shot, &styled));

        let cameras = &mut self.cameras;
        let mut developed = watch.time("encode", || camera::develop(shot, &hazed, cameras, &mut record));
        if faults::frame_point("rgb.wrong", frame.index) {
            developed.rgb.data_mut()[0] ^= 1;
        }
        record.counts.clamped = developed.clamped;
        let measured = developed.measured();
        let enhancements = watch.time("enhance", || enhance::run(shot, measured, &mut record))?;
        watch.time("metrics", || {
            measure::run(shot, measured, &enhancements, &mut record)
        })?;
        record.scene = watch.time("labels", || labels::describe(shot, &layers));

        let pictures = Pictures {
            layers: &layers,
            snow: snow.as_ref(),
            styled: &styled,
            rgb: &developed.rgb,
            deep: developed.deep.as_ref(),
            raw: developed.raw.as_ref(),
            enhancements: &enhancements,
            traced: traced.as_ref(),
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
    pub fn plan(&mut self, frame: &Frame, source: &SceneSource) -> Result<FramePlan, RenderError> {
        let within_noise = camera::with_tolerance(frame);
        let frame = within_noise.as_ref().unwrap_or(frame);
        let shot = self.resolve(frame, source, &mut Stopwatch::start())?;
        Ok(shot.frame_plan())
    }

    /// What the camera's optics make of the light; none of a pinhole.
    fn take(
        &mut self,
        shot: &mut Shot<'_>,
        layers: &Layers,
        record: &mut FrameRecord,
        watch: &mut Stopwatch,
    ) -> Result<Option<Rgb<f32>>, RenderError> {
        let Some(taking) = &shot.taking else {
            return Ok(None);
        };
        let moves = taking.moments.len() > 1;
        let exposure = taking.parts.exposure;
        let picture = if moves {
            watch.time("movement", || self.moving(shot))?
        } else {
            watch.time("camera", || camera::gather(shot, &layers.scattered))
        };
        let lagging = match exposure {
            Some(Exposure::Auto(metering)) if metering.lag_frames > 0.0 => {
                Some(watch.time("metering", || self.lagging(shot.frame))?)
            }
            _ => None,
        };
        Ok(Some(watch.time("camera", || {
            camera::expose(shot, picture, lagging, record)
        })))
    }

    /// The mean of the pictures of all moments of a frame, each row from its own. The labels of the frame become those of its
    /// bands.
    fn moving(&mut self, shot: &mut Shot<'_>) -> Result<Rgb<f32>, RenderError> {
        let frame = shot.frame;
        let Some(taking) = &shot.taking else {
            return Err(RenderError::Panic("a pinhole has no moments".to_owned()));
        };
        let (moments, view, size) = (taking.moments.clone(), taking.parts.source, taking.parts.size);
        let parts = taking.parts.clone();
        let place = scene::Place::of(frame)?;
        let mut average = Average::new(size);
        let mut seen: Option<Seen> = None;
        for moment in &moments {
            let prepared = Arc::new(place.prepare(frame, view, moment.later)?);
            let mut unheard = Stopwatch::start();
            let at =
                self.resolve_prepared(frame, prepared, Some(parts.clone()), moment.later, &mut unheard)?;
            let mut layers = water::run(&at, &mut self.kernels)?;
            let mut own = FrameRecord::default();
            glow::run(&at, &mut layers, &mut own);
            snow::run(&at, &mut layers, &mut own);
            average.add(
                &camera::gather(&at, &layers.scattered),
                &moment.rows,
                moment.weight,
            );
            if moment.labels {
                let sampling = at.taking.as_ref().and_then(|taking| taking.sampling.as_deref());
                let labels = Seen::new(&at.prepared, sampling);
                match &mut seen {
                    Some(seen) => seen.take_rows(&labels, &moment.rows),
                    None => seen = Some(labels),
                }
            }
            self.kernels.recycle(layers);
        }
        if let Some(seen) = &mut seen {
            seen.find_boxes();
        }
        // Half of an even exposure lies between two of its pictures: labels of the frame's own pose are nearer.
        let rolls = moments.iter().any(|moment| moment.rows != (0..size.1));
        if let Some(taking) = shot.taking.as_mut().filter(|_| rolls) {
            taking.seen = seen;
        }
        Ok(average.finish())
    }

    /// The exposure of a frame of a sequence that follows its metering slowly: metered at a sixteenth of the sides from as far
    /// back as matters, each frame with this one's water.
    fn lagging(&mut self, frame: &Frame) -> Result<f64, RenderError> {
        let mut gain = None;
        for small in camera::metered_frames(frame) {
            let mut unheard = Stopwatch::start();
            let shot = self.resolve(&small, &SceneSource::Local, &mut unheard)?;
            let mut layers = water::run(&shot, &mut self.kernels)?;
            let mut own = FrameRecord::default();
            glow::run(&shot, &mut layers, &mut own);
            snow::run(&shot, &mut layers, &mut own);
            gain = camera::followed(&shot, &camera::gather(&shot, &layers.scattered), gain);
            self.kernels.recycle(layers);
        }
        Ok(gain.unwrap_or(1.0))
    }

    /// Fetches the scene, resolves its setting, lights it and plans the remaining stages.
    fn resolve<'a>(
        &mut self,
        frame: &'a Frame,
        source: &SceneSource,
        watch: &mut Stopwatch,
    ) -> Result<Shot<'a>, RenderError> {
        let parts = camera::rendered_parts(frame)?;
        let view = parts.as_ref().and_then(|parts| parts.source);
        let prepared = watch.time("scene", || self.scene(frame, source, view))?;
        self.resolve_prepared(frame, prepared, parts, 0.0, watch)
    }

    /// Resolves the setting of a scene, so many frames after the frame's time, lights it and plans the remaining stages.
    fn resolve_prepared<'a>(
        &mut self,
        frame: &'a Frame,
        prepared: Arc<Prepared>,
        parts: Option<Parts>,
        later: f64,
        watch: &mut Stopwatch,
    ) -> Result<Shot<'a>, RenderError> {
        let setting = Setting::resolve(frame, &prepared.view()).map_err(RenderError::Setting)?;
        let parts = camera::seen_parts(frame, &prepared, parts)?;
        let shutter = Shutter::new(frame, parts.as_ref(), later);
        let lit = Lit::new(frame, &prepared, &setting, shutter, &mut self.tiles, watch);
        let style = style::traits(frame, &self.networks.engine)?;
        let ibla = enhance::forms(frame);
        let plan = watch.time("plan", || {
            Plan::new(&Given {
                frame,
                setting: &setting,
                stats: &lit.measure(&setting),
                above: lit.above.as_ref(),
                lamps: lit.lamps,
                casting: lit.casting.as_ref(),
                cloud_opacity: lit.clouds.as_ref().map_or(0.0, Clouds::most_opacity),
                snow_peak: peak(&lit.flakes),
                style,
                ibla: &ibla,
            })
        });
        let taking = camera::taking(frame, &prepared, parts, &mut self.cameras)?;
        Ok(Shot {
            frame,
            prepared,
            setting,
            lit,
            plan,
            taking,
        })
    }

    /// The scene of a frame; the last one is kept, since a job often shows one scene in many waters.
    fn scene(
        &mut self,
        frame: &Frame,
        source: &SceneSource,
        view: Option<Source>,
    ) -> Result<Arc<Prepared>, RenderError> {
        let Camera {
            width,
            height,
            hfov_deg,
            path,
            ..
        } = frame.camera;
        let key = SceneKey {
            scene: frame.scene.clone(),
            camera: Camera {
                path,
                ..Camera::pinhole(width, height, hfov_deg)
            },
            view,
            labeled: scene::needs_labels(frame),
        };
        if let Some((last, prepared)) = &self.last_scene
            && *last == key
        {
            return Ok(Arc::clone(prepared));
        }
        let prepared = Arc::new(scene::prepare(frame, source, view)?);
        self.last_scene = match frame.scene {
            Scene::Files { .. } => None,
            _ => Some((key, Arc::clone(&prepared))),
        };
        Ok(prepared)
    }
}
