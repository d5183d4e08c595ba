//! One frame from its description to stored bytes, and the worker that does it for a service.
//!
//! [`Slot::render`] is the way of one frame: scene, water, style, haze, encoding, enhancement, measurement. The same
//! code runs for a service ([`worker`]) and without one ([`local`]), so both give the same bytes.

mod assessment;
mod attempt;
mod content;
mod context;
mod effects;
mod engine;
mod error;
mod file;
mod inputs;
mod light;
pub mod local;
mod pipeline;
mod planning;
mod preview;
mod provenance;
mod record;
mod slot;
mod source;
mod stage;
mod stopwatch;
mod vocabulary;
pub mod worker;

pub use content::{Content, Contents};
pub use engine::Engine;
pub use error::RenderError;
pub use file::{EXTENSIONS, File, extension};
pub use provenance::{CODE_VERSION, cpu_features};
pub use slot::{LinearPicture, Rendered, Slot, WaterLight};
pub use source::{SceneBytes, SceneSource};
pub use stage::truth::{Round, Traced, Tracing};
pub use vocabulary::vocabulary;
