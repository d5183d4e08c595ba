//! Style networks: stability under noise, shifts, other crops and extreme sizes; speed of the tiers; scores of trained waters.

mod experiment;
mod johnson;
mod scores;
mod speed;
mod steadiness;

pub use experiment::{SPEED_PARAMETERS, run_speed, run_stability};
pub use scores::{PARAMETERS as SCORES_PARAMETERS, run as run_scores};
