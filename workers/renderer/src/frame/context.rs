//! The context of a frame before rendering: description, scene, surroundings, camera and plan.

use std::borrow::Cow;

use ::camera::geometry::PortRefraction;
use imaging::rays::Rays;
use imaging::{Plane, Rgb};
use optics::layering::Layering;
use optics::plan::{Plan, SceneBounds, StageId, Variant};
use optics::setting::Setting;
use optics::visible_bounds::VisibleBounds;
use optics::water::Water;
use scenes::Labels;
use spec::{Frame, Intrinsics, LensRecord};

use crate::effects::{ESTIMATED, Effects};
use crate::error::RenderError;
use crate::inputs::camera::{self, Cameras, Taking};
use crate::inputs::caustics::{self, LastTiles, Pattern};
use crate::inputs::scene::Prepared;
use crate::inputs::shutter::Shutter;
use crate::inputs::{patches, rays};
use crate::stopwatch::Stopwatch;

/// The inputs of the stages of one moment of a frame. Stages do not change them.
pub(crate) struct FrameContext<'a> {
    pub(crate) frame: &'a Frame,
    pub(crate) prepared: &'a Prepared,
    pub(crate) setting: Setting,
    /// Paths through turbid patches; `None` in uniform water.
    patchy: Option<Plane<f32>>,
    /// Mean, least and greatest path relative to the range; `None` in uniform water and for frames without valid range.
    pub(crate) path_factors: Option<[f64; 3]>,
    /// The wave pattern; `None` without caustics and shafts.
    pub(crate) pattern: Option<Pattern>,
    /// Bounds of the picture, tile by tile; `None` without range.
    pub(crate) view: Option<VisibleBounds>,
    /// Occluders of the sun and lamps; `None` if neither casts shadows.
    pub(crate) occluders: Option<Box<dyn Rays + Sync + 'a>>,
    /// Focus and exposure for drawing particles.
    pub(crate) shutter: Shutter,
    /// The camera; `None` for a pinhole, which shows the scene unchanged.
    pub(crate) taking: Option<Taking>,
    /// Nodes of the airlight on each ray; `None` if its tolerance determines them.
    pub(crate) airlight_nodes: Option<usize>,
    /// The omitted effects, applied to all of the above.
    pub(crate) effects: Effects,
    pub(crate) plan: Plan,
}

/// Resources for building contexts that later frames may reuse.
#[derive(Default)]
pub(crate) struct Resources {
    pub(crate) cameras: Cameras,
    tiles: LastTiles,
}

impl<'a> FrameContext<'a> {
    /// The context of a frame without a plan yet, `later` frames of its path after its time.
    pub(crate) fn new(
        frame: &'a Frame,
        prepared: &'a Prepared,
        later: f64,
        resources: &mut Resources,
        watch: &mut Stopwatch,
    ) -> Result<Self, RenderError> {
        let setting = Setting::resolve(frame, &prepared.view()).map_err(RenderError::Setting)?;
        let taking = camera::taking(frame, prepared, &mut resources.cameras)?;
        let range = prepared.scene.range.as_ref();
        let patchy = watch.time("turbidity", || patches::find_paths(frame, range?, &setting));
        let view =
            range.map(|range| VisibleBounds::measure(&prepared.scene.radiance, range, &setting.eye.camera));
        Ok(Self {
            occluders: rays::occluders(frame, prepared, &setting),
            shutter: Shutter::new(frame, taking.as_ref().map(|taking| &taking.parts), later),
            frame,
            prepared,
            setting,
            path_factors: patchy
                .as_ref()
                .zip(range)
                .and_then(|(path, range)| patches::measure_paths(path, range)),
            patchy,
            pattern: None,
            airlight_nodes: None,
            effects: Effects::default(),
            view,
            taking,
            plan: Plan::default(),
        })
    }

    /// Removes effects, and finds the wave pattern if it is visible. Without this call a context has all effects of a calm sea.
    pub(crate) fn apply(&mut self, effects: Effects, resources: &mut Resources, watch: &mut Stopwatch) {
        for id in ESTIMATED.into_iter().filter(|id| !effects.runs(*id)) {
            self.setting.leave_out(id);
        }
        let has_pattern = effects.runs(StageId::Caustics) || effects.runs(StageId::Shafts);
        let range = self.prepared.scene.range.as_ref();
        let daylight = self.setting.water.as_ref().and_then(Water::daylight);
        let is_daylit = has_pattern && daylight.is_some();
        self.pattern = range.filter(|_| is_daylit).and_then(|range| {
            watch.time("above", || {
                caustics::find_pattern(self.frame, &self.setting, range, &mut resources.tiles)
            })
        });
        self.effects = effects;
    }

    /// The occluders of the sun and lamps.
    pub(crate) fn rays(&self) -> Option<&dyn Rays> {
        self.occluders.as_deref().map(|rays| rays as &dyn Rays)
    }

    /// Whether a stage runs in f64.
    pub(crate) fn runs_reference(&self, id: StageId) -> bool {
        *self.plan.variant(id) == Variant::Reference
    }

    /// The layers of the frame, between which near objects occlude scattered light; `None` without occlusion.
    pub(crate) fn find_layers(&self) -> Option<Layering> {
        let around = self.setting.around.as_ref()?;
        SceneBounds::find_layers(self.path()?, around)
    }

    /// Meters of mean water before each pixel: its range, or its path through patches; `None` without range.
    pub(crate) fn path(&self) -> Option<&Plane<f32>> {
        self.patchy.as_ref().or(self.prepared.scene.range.as_ref())
    }

    /// A layer of the scene as the camera's picture shows it.
    pub(crate) fn view<'l>(&self, layer: &'l Rgb<f32>) -> Cow<'l, Rgb<f32>> {
        match self.taking.as_ref().and_then(|taking| taking.sampling.as_ref()) {
            Some(sampling) => Cow::Owned(sampling.picture(layer)),
            None => Cow::Borrowed(layer),
        }
    }

    /// Labels of the scene as the camera's picture shows them.
    pub(crate) fn view_labels<'l, T: Copy>(&self, labels: &'l Plane<T>) -> Cow<'l, Plane<T>> {
        match self.taking.as_ref().and_then(|taking| taking.sampling.as_ref()) {
            Some(sampling) => Cow::Owned(sampling.labels(labels)),
            None => Cow::Borrowed(labels),
        }
    }

    /// The camera of the picture; for a camera behind a port, its intrinsics in air.
    pub(crate) fn intrinsics(&self) -> Intrinsics {
        match &self.taking {
            Some(taking) => taking.parts.lens.camera,
            None => self.prepared.view().camera,
        }
    }

    /// The refraction of that camera, or `None` for a pinhole.
    pub(crate) fn lens(&self) -> Option<LensRecord> {
        let taking = self.taking.as_ref()?;
        taking.sampling.as_ref()?;
        let refraction = taking.parts.lens.refraction;
        Some(LensRecord {
            model: "brown-conrady".to_owned(),
            distortion: taking.parts.lens.distortion,
            flat_port_n_w: match refraction {
                PortRefraction::Flat { index } => Some(index),
                PortRefraction::None => None,
            },
        })
    }

    /// The range of every pixel of the picture.
    pub(crate) fn range(&self) -> Option<&Plane<f32>> {
        match self.taking.as_ref().and_then(|taking| taking.seen.as_ref()) {
            Some(seen) => seen.range.as_ref(),
            None => self.prepared.scene.range.as_ref(),
        }
    }

    /// The instance of every pixel of the picture.
    pub(crate) fn instances(&self) -> Option<&Plane<u16>> {
        match self.taking.as_ref().and_then(|taking| taking.seen.as_ref()) {
            Some(seen) => seen.instances.as_ref(),
            None => self.prepared.scene.instances.as_ref(),
        }
    }

    /// The labels of the picture.
    pub(crate) fn labels(&self) -> Option<&Labels> {
        match self.taking.as_ref().and_then(|taking| taking.seen.as_ref()) {
            Some(seen) => seen.labels.as_ref(),
            None => self.prepared.labels.as_ref(),
        }
    }
}
