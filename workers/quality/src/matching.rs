//! Point features of a picture and their matches between the frames of a path.

pub(crate) mod descriptor;
pub(crate) mod fast;
pub(crate) mod features;
pub(crate) mod harris;
pub(crate) mod motion;
pub(crate) mod nearest;
pub(crate) mod orientation;
pub(crate) mod patch_mask;
pub(crate) mod pyramid;
pub(crate) mod track;
