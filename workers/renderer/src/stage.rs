//! The stages of a frame, one file each. The order in which they run is that of [`crate::Slot::render`].

pub(crate) mod above;
pub(crate) mod camera;
pub(crate) mod enhance;
pub(crate) mod files;
pub(crate) mod glow;
pub(crate) mod haze;
pub(crate) mod labels;
pub(crate) mod light;
pub(crate) mod measure;
mod range_file;
pub(crate) mod rays;
pub(crate) mod scene;
pub(crate) mod sediment;
pub(crate) mod seen;
pub(crate) mod snow;
pub(crate) mod style;
mod surroundings;
pub(crate) mod truth;
pub(crate) mod water;

use std::borrow::Cow;
use std::sync::Arc;

use imaging::{Plane, Rgb};
use optics::plan::Plan;
use optics::setting::Setting;
use spec::{Frame, Intrinsics, LensRecord};

use crate::frame_plan::FramePlan;
use ::camera::geometry::Refraction;
use camera::Taking;
use light::Lit;
use scene::Prepared;
use scenes::Labels;

/// The inputs of the stages; none of them changes it.
pub(crate) struct Shot<'a> {
    pub(crate) frame: &'a Frame,
    pub(crate) prepared: Arc<Prepared>,
    pub(crate) setting: Setting,
    pub(crate) lit: Lit,
    pub(crate) plan: Plan,
    /// The camera; none of a pinhole, which shows the scene as it is.
    pub(crate) taking: Option<Taking>,
}

impl Shot<'_> {
    /// The plan of the whole frame.
    pub(crate) fn frame_plan(&self) -> FramePlan {
        let camera = self.taking.as_ref().map(|taking| &taking.plan);
        FramePlan::new(&self.plan, camera, truth::line(self))
    }

    /// A layer of the scene as the camera's picture shows it.
    pub(crate) fn view<'a>(&self, layer: &'a Rgb<f32>) -> Cow<'a, Rgb<f32>> {
        match self.taking.as_ref().and_then(|taking| taking.sampling.as_ref()) {
            Some(sampling) => Cow::Owned(sampling.picture(layer)),
            None => Cow::Borrowed(layer),
        }
    }

    /// Labels of the scene as the camera's picture shows them.
    pub(crate) fn view_labels<'a, T: Copy>(&self, labels: &'a Plane<T>) -> Cow<'a, Plane<T>> {
        match self.taking.as_ref().and_then(|taking| taking.sampling.as_ref()) {
            Some(sampling) => Cow::Owned(sampling.labels(labels)),
            None => Cow::Borrowed(labels),
        }
    }

    /// The camera of the picture: in air, of one behind a port.
    pub(crate) fn intrinsics(&self) -> Intrinsics {
        match &self.taking {
            Some(taking) => taking.parts.lens.camera,
            None => self.prepared.view().camera,
        }
    }

    /// What bends the rays of that camera; none of a pinhole.
    pub(crate) fn lens(&self) -> Option<LensRecord> {
        let taking = self.taking.as_ref()?;
        taking.sampling.as_ref()?;
        let refraction = taking.parts.lens.refraction;
        Some(LensRecord {
            model: "brown-conrady".to_owned(),
            distortion: taking.parts.lens.distortion,
            flat_port_n_w: match refraction {
                Refraction::Flat { index } => Some(index),
                Refraction::None => None,
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
