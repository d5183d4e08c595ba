//! Trains a style water from photos on a CPU: content pictures generated on the fly, losses without a pretrained
//! network, hand-written gradients, and a score on new scenes.
//!
//! Pure: a training is a function of photos, seed and number of steps. The number of threads changes no bit.

pub mod content;
mod contrast;
mod layer;
pub mod loss;
pub mod network;
mod optimizer;
mod photo;
pub mod real;
mod score;
pub mod tensor;
mod trainer;
mod transfer;
mod veil;

pub use contrast::{ContrastKept, contrast_kept};
pub use photo::{MAX_SIDE_PX, MIN_SIDE_PX, MIN_SPREAD, Photo, PhotoError};
pub use score::{Score, new_scenes, score, score_over};
pub use trainer::{Best, Trainer};
