//! The sensor after the linear model of EMVA 1288: electrons, noise, codes.
//!
//! White fills a pixel to `S0 p_w` electrons; light x collects `μ = x S0 p_w (1 + prnu N) + dark`. The arriving number
//! is an integer: Poisson, in closed form below [`POISSON_SWITCH`] electrons and a normal number with Poisson's
//! skewness above (Cornish and Fisher). Offset, read and row noise are added, and the converter rounds: `dn =
//! clamp(floor(v K gain + black + 1/2), 0, 2^bits - 1)`, `K = (2^bits - 1 - black)/S0`.
//!
//! Every random number has an address: the seed of the camera and the name of the noise, the frame (0 for the fixed
//! pattern), and the pixel. Sensitivity, dark current and offset belong to the camera and are the same in every frame.
//!
//! Both variants compute in f64. The fast one uses short series for logarithms and cosines and stores the fixed pattern
//! in f32: at most one pixel in ten thousand differs, by one electron.

mod arrival;
mod counting;
mod model;
mod noise;
mod pattern;
mod read;
mod reference;

pub use pattern::FixedPattern;
pub use read::read;
pub use reference::read_reference;

pub use model::{Chance, POISSON_SWITCH, Raw, SensorModel, color_of};
