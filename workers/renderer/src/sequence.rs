//! Relations between pictures of one scene: the motion to the next frame of a path, the right camera of a stereo pair, and the
//! previous picture.
//!
//! Only the camera moves. Procedural worlds are static within a pass over a path, including animals, plants and bubbles. The motion
//! excludes marine snow, sediment, caustics, lamplight and shadows, which move over surfaces.

mod held;
mod history;
mod motion;
mod stereo;
mod track;
mod viewpoint;

pub use held::Held;
pub(crate) use history::History;
pub(crate) use motion::{Motions, find_motions};
pub(crate) use stereo::{Developing, right_frame};
pub(crate) use track::Track;
pub use viewpoint::{RelativePose, Viewpoint};
