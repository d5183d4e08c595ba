//! Rules that need domain knowledge: whether the numbers of a water or a camera are consistent. `optics` and `camera`
//! implement them.

use crate::camera::Camera;
use crate::daylight::Daylight;
use crate::water::{Optics, Water};

/// The rules of waters, implemented by `optics`.
#[derive(Debug, Clone, Copy)]
pub struct WaterRules {
    /// Returns the faults of a water under the given conditions.
    pub faults: fn(&Water, WaterConditions) -> Vec<Fault>,
    /// Returns a warning about valid optics.
    pub warning: fn(&Optics) -> Option<String>,
}

impl Default for WaterRules {
    /// Accepts everything.
    fn default() -> Self {
        Self {
            faults: |_, _| Vec::new(),
            warning: |_| None,
        }
    }
}

/// The rules of cameras, implemented by `camera`.
#[derive(Debug, Clone, Copy)]
pub struct CameraRules {
    /// Returns the faults of a camera; the flag distinguishes rendered scenes from uploaded images.
    pub faults: fn(&Camera, bool) -> Vec<Fault>,
    /// Returns the readout time of a rolling shutter, s; 0 for a global one.
    pub readout_s: fn(&Camera) -> f64,
}

impl Default for CameraRules {
    /// Accepts everything.
    fn default() -> Self {
        Self {
            faults: |_, _| Vec::new(),
            readout_s: |_| 0.0,
        }
    }
}

/// Conditions for checking a water.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WaterConditions {
    /// Whether lamps light it.
    pub lamps: bool,
    /// Daylight above it.
    pub daylight: Daylight,
    /// Whether its light is traced by Monte Carlo.
    pub traced: bool,
    /// The maximum cross-section of the view at 1 m, m²; `None` if unknown.
    pub solid: Option<f64>,
}

/// A fault with the field to change.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// Path below the checked object, such as `["optics", "g_per_m"]`; empty for the whole object.
    pub path: Vec<&'static str>,
    /// Message with field, value and limit.
    pub message: String,
    /// Whether a value is missing.
    pub missing: bool,
}
