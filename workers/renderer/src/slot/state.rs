//! The state of a slot.

use std::sync::Arc;

use ::camera::geometry::SourcePicture;
use imaging::Rgb;
use optics::forward_scatter::KernelCache;
use optics::plan::StageId;
use spec::{Camera, Scene};

use super::costs::CostScale;
use super::kept::KeptEffects;
use crate::context::Resources;
use crate::inputs::scene::Prepared;
use crate::light::Light;
use crate::sequence::History;
use crate::stage::networks::PictureNetworks;
use crate::stage::style::Networks;

/// Caches that one worker thread reuses between frames. They never change a result.
pub struct Slot {
    pub(crate) networks: Networks,
    pub(super) picture_networks: PictureNetworks,
    pub(super) kernels: KernelCache,
    pub(super) resources: Resources,
    /// Caches for the thinned pictures used to meter exposures.
    pub(super) thin: Thin,
    pub(super) last_scene: Option<(SceneKey, Arc<Prepared>)>,
    /// The caches of right cameras, exchanged with those above while one renders.
    pub(super) right: RightCaches,
    /// Pictures of the last frames.
    pub(super) history: History,
    /// Effects that no frame of this slot has.
    pub(super) excluded: Vec<StageId>,
    /// `None` if effects are chosen for each frame.
    pub(super) kept_effects: Option<KeptEffects>,
    /// The costs of plans on this machine; those of the reference machine unless calibrated.
    pub(super) costs: CostScale,
}

/// Everything that a prepared scene depends on. Scenes from local files are not cached because the files may change.
#[derive(PartialEq)]
pub(super) struct SceneKey {
    pub(super) scene: Scene,
    /// Its sides, field of view, view and path.
    pub(super) camera: Camera,
    /// Depth of the camera, m; limits the height of piles.
    pub(super) depth_m: Option<f64>,
    pub(super) view: Option<SourcePicture>,
    pub(super) labeled: bool,
    /// Of [`spec::Frame::right_m`].
    pub(super) right_m: f64,
}

/// Caches of right cameras: their sensor and their view differ from those of left ones.
#[derive(Default)]
pub(super) struct RightCaches {
    pub(super) resources: Resources,
    pub(super) last_scene: Option<(SceneKey, Arc<Prepared>)>,
}

/// Caches for thinned pictures, separate from those of frames.
#[derive(Default)]
pub(super) struct Thin {
    pub(super) resources: Resources,
    pub(super) kernels: KernelCache,
}

/// The light of a frame, and the exposed picture; `None` for a pinhole, whose picture equals the light.
pub(super) struct Taken {
    pub(super) light: Light,
    pub(super) exposed: Option<Rgb<f32>>,
    /// The factor of the exposure; `None` for a pinhole.
    pub(super) gain: Option<f64>,
}
