//! The sensor after the linear model of EMVA 1288: electrons, noise, codes.
//!
//! A pixel that white fills to `S0 p_w` electrons collects `μ = x S0 p_w (1 + prnu N) + dark`. Of them a whole number arrives:
//! Poisson, in closed form below [`POISSON_SWITCH`] electrons and a normal number with the skewness of Poisson's above (Cornish
//! and Fisher). Offset, read and row noise are added, and the converter rounds:
//! `dn = clamp(floor(v K gain + black + 1/2), 0, 2^bits - 1)`, `K = (2^bits - 1 - black)/S0`.
//!
//! Every random number has an address: the seed of the camera and the name of the noise, the frame (0 for what is fixed to the
//! camera), and the pixel. Sensitivity, dark current and offset are the camera's own and the same in every frame.
//!
//! The sensor computes in f64 in both forms. The fast one takes its logarithms and cosines from short series and keeps the
//! fixed pattern in f32: at most one pixel in ten thousand differs, by one electron.

mod arrival;
mod counting;
mod noise;
mod pattern;
mod read;
mod reference;

pub use pattern::Pattern;
pub use read::read;
pub use reference::read_reference;

use imaging::Plane;
use spec::Cfa;

/// From this many electrons on, Poisson's distribution is taken for a skewed normal one.
pub const POISSON_SWITCH: f64 = 30.0;
/// Most electrons that are counted one by one.
pub(crate) const MOST_COUNTED: usize = 200;
/// The dark current of a hot pixel over that of its neighbors.
pub(crate) const HOT: f64 = 1000.0;

/// A sensor, every number known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensor {
    /// Electrons that a pixel holds.
    pub full_well_e: f64,
    /// Share of the full well that white fills, the light level included.
    pub white_at: f64,
    /// Spread of the sensitivity.
    pub prnu: f64,
    /// Spread of the dark current.
    pub dcnu: f64,
    /// Spread of the offset, electrons.
    pub dsnu_e: f64,
    /// Dark current, electrons a second.
    pub dark_e_per_s: f64,
    /// Share of hot pixels.
    pub hot_share: f64,
    /// Seconds in which dark current gathers.
    pub exposure_s: f64,
    /// Read noise, electrons.
    pub read_noise_e: f64,
    /// Noise that a row shares, electrons.
    pub row_noise_e: f64,
    /// Whether electrons are whole.
    pub shot: bool,
    /// Bits of the converter.
    pub bits: u8,
    /// Code of no light.
    pub black_dn: u16,
    /// Analog gain, at least 1.
    pub gain: f64,
    /// Colors of the pixels.
    pub cfa: Cfa,
}

/// What makes the noise of a frame its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Chance {
    /// The camera's seed.
    pub seed: u64,
    /// The frame.
    pub frame: u64,
}

/// The codes of a sensor.
#[derive(Debug, Clone, PartialEq)]
pub enum Raw {
    /// One code for each pixel, of the color that its filter lets through.
    Mosaic(Plane<u16>),
    /// Three sensors: R, G, B.
    Planes([Plane<u16>; 3]),
}

impl Sensor {
    /// Codes for an electron: `K gain`.
    #[must_use]
    pub fn dn_per_e(&self) -> f64 {
        (self.most_dn() - f64::from(self.black_dn)) / self.full_well_e * self.gain
    }

    /// The largest code.
    #[must_use]
    pub fn most_dn(&self) -> f64 {
        f64::from((1u32 << self.bits) - 1)
    }

    /// Electrons of white.
    #[must_use]
    pub fn white_e(&self) -> f64 {
        self.full_well_e * self.white_at
    }

    /// Light of a code above black: `1/(K gain S0 p_w)`.
    #[must_use]
    pub fn light_per_dn(&self) -> f64 {
        1.0 / (self.dn_per_e() * self.white_e())
    }

    /// A third of the smallest noise of a pixel, as light: errors below it cannot be seen. 0 of a sensor without noise.
    #[must_use]
    pub fn tolerance(&self) -> f64 {
        let dark = self.dark_e_per_s * self.exposure_s;
        (dark + self.read_noise_e * self.read_noise_e).sqrt() / (3.0 * self.white_e())
    }

    /// The noise of a pixel that light x falls on, as light.
    #[must_use]
    pub fn noise_at(&self, x: f64) -> f64 {
        let mu = x * self.white_e() + self.dark_e_per_s * self.exposure_s;
        let shot = if self.shot { mu } else { 0.0 };
        let fixed = self.dsnu_e * self.dsnu_e + (self.prnu * mu) * (self.prnu * mu);
        let read = self.read_noise_e * self.read_noise_e + self.row_noise_e * self.row_noise_e;
        (shot + fixed + read).sqrt() / self.white_e()
    }
}

/// The color of a pixel behind its filter: 0, 1, 2 for R, G, B. Of three sensors none.
#[must_use]
pub fn color_of(cfa: Cfa, x: usize, y: usize) -> Option<usize> {
    let colors = match cfa {
        Cfa::Rggb => [0, 1, 1, 2],
        Cfa::Bggr => [2, 1, 1, 0],
        Cfa::Grbg => [1, 0, 2, 1],
        Cfa::Gbrg => [1, 2, 0, 1],
        Cfa::None => return None,
    };
    Some(colors[2 * (y % 2) + x % 2])
}
