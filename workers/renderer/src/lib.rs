//! Renders one frame from its description to stored bytes, and runs the worker that does so for a service.
//!
//! [`Slot::render`] is the pipeline of one frame: scene, water, style, haze, encoding, enhancement, measurement. The same code runs
//! for a service ([`worker`]) and without one ([`local`]), so the bytes are equal.

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
mod plausibility;
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
