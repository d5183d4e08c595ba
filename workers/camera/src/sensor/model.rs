//! The sensor: its properties, its random numbers, and its raw codes.

use imaging::Plane;
use spec::Cfa;

/// From this many electrons on, a skewed normal distribution approximates Poisson's.
pub const POISSON_SWITCH: f64 = 30.0;

/// Largest counted number of electrons.
pub(crate) const MOST_COUNTED: usize = 200;

/// Dark current of a hot pixel relative to its neighbors.
pub(crate) const HOT: f64 = 1000.0;

/// SensorModel parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensorModel {
    /// Full well, electrons.
    pub full_well_e: f64,
    /// Share of the full well at white, including the light level.
    pub white_at: f64,
    /// Relative spread of the sensitivity.
    pub prnu: f64,
    /// Relative spread of the dark current.
    pub dcnu: f64,
    /// Spread of the offset, electrons.
    pub dsnu_e: f64,
    /// Dark current, electrons per second.
    pub dark_e_per_s: f64,
    /// Share of hot pixels.
    pub hot_share: f64,
    /// Exposure time, s.
    pub exposure_s: f64,
    /// Read noise, electrons.
    pub read_noise_e: f64,
    /// Row noise, electrons.
    pub row_noise_e: f64,
    /// Whether shot noise is simulated.
    pub shot: bool,
    /// Bits of the converter.
    pub bits: u8,
    /// Black level.
    pub black_dn: u16,
    /// Analog gain, at least 1.
    pub gain: f64,
    /// Colors of the pixels.
    pub cfa: Cfa,
}

/// Address of the random numbers of a frame.
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
    /// One code per pixel, in the color of its filter.
    Mosaic(Plane<u16>),
    /// Three sensors: R, G, B.
    Planes([Plane<u16>; 3]),
}

impl SensorModel {
    /// Codes per electron: `K gain`.
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

    /// A third of the smallest pixel noise in units of light: smaller errors are invisible. 0 for a sensor without
    /// noise.
    #[must_use]
    pub fn tolerance(&self) -> f64 {
        let dark = self.dark_e_per_s * self.exposure_s;
        (dark + self.read_noise_e * self.read_noise_e).sqrt() / (3.0 * self.white_e())
    }

    /// Pixel noise at light x, in units of light.
    #[must_use]
    pub fn noise_at(&self, x: f64) -> f64 {
        let mu = x * self.white_e() + self.dark_e_per_s * self.exposure_s;
        let shot = if self.shot { mu } else { 0.0 };
        let fixed = self.dsnu_e * self.dsnu_e + (self.prnu * mu) * (self.prnu * mu);
        let read = self.read_noise_e * self.read_noise_e + self.row_noise_e * self.row_noise_e;
        (shot + fixed + read).sqrt() / self.white_e()
    }
}

/// The color of a pixel's filter: 0, 1, 2 for R, G, B. `None` for three sensors.
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
