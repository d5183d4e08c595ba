//! Formats of sequences with times, as the tools of robotics read them.

pub(crate) mod body;
pub(crate) mod depth;
mod euroc;
mod kitti;
pub(crate) mod layout;
mod orb_slam;
mod sequence;
pub(crate) mod timed_frame;
mod tum;
