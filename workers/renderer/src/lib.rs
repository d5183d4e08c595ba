//! Renders one frame from its description to stored bytes, and runs the worker that does so for a service.
//!
//! [`Slot::render`] is the pipeline of one frame: scene, water, style, haze, encoding, enhancement, measurement. The same code runs
//! for a service ([`worker`]) and without one ([`local`]), so the bytes are equal.

mod assessment;
mod attempt;
mod error;
mod frame;
pub mod local;
mod output;
mod pipeline;
mod planning;
mod plausibility;
mod resources;
mod sequence;
mod slot;
mod stage;
mod stopwatch;
mod stream;
pub mod worker;

pub use comparable::ComparableFrame;
pub use content::{Content, Contents};
pub use effects::ESTIMATED as CHOSEN_EFFECTS;
pub use engine::Engine;
pub use error::RenderError;
pub use file::{EXTENSIONS, File, extension};
use frame::{comparable, content, context, daylight_bounds, effects, inputs, light, preview};
use output::{file, provenance, record};
pub use provenance::{CODE_VERSION, cpu_features};
use resources::{engine, source, vocabulary};
pub use sequence::{Held, RelativePose, Viewpoint};
pub use slot::{FrameTruth, LinearPicture, Rendered, Slot};
pub use source::{SceneBytes, SceneSource};
pub use stage::networks::PictureNetworks;
pub use stage::truth::Round;
pub use stream::{
    ChannelOrder, DepthSamples, InputError, PictureSamples, Stream, StreamDepth, StreamError, StreamFrame,
    StreamInput, StreamJob, StreamMask, StreamOptions, StreamParts, StreamPicture, Vary,
};
pub use vocabulary::vocabulary;
