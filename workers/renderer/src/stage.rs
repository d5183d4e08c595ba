//! The stages of a frame, one file each. The order in which they run is that of [`crate::Slot::render`].

pub(crate) mod enhance;
pub(crate) mod files;
pub(crate) mod glow;
pub(crate) mod haze;
pub(crate) mod labels;
pub(crate) mod light;
pub(crate) mod measure;
mod range_file;
pub(crate) mod scene;
pub(crate) mod snow;
pub(crate) mod style;
pub(crate) mod water;

use std::sync::Arc;

use optics::plan::Plan;
use optics::setting::Setting;
use spec::Frame;

use light::Lit;
use scene::Prepared;

/// The inputs of the stages; none of them changes it.
pub(crate) struct Shot<'a> {
    pub(crate) frame: &'a Frame,
    pub(crate) prepared: Arc<Prepared>,
    pub(crate) setting: Setting,
    pub(crate) lit: Lit,
    pub(crate) plan: Plan,
}
