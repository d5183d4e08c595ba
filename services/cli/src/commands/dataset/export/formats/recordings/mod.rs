//! Recordings of ROS 2 messages.

mod cdr;
mod container;
pub(crate) mod mcap;
mod messages;
mod schemas;
mod topics;
