//! Options that several commands or programs share.

pub mod engine;
pub mod import;
pub mod remote;
pub mod render;
pub mod seal;
pub mod styles;
pub mod worker;
