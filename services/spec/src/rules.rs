//! What a description cannot know by itself: whether the numbers of a water or a camera fit together. `optics` and `camera`
//! know.

use crate::camera::Camera;
use crate::daylight::Daylight;
use crate::water::{Optics, Water};

/// The rules of waters, handed in by the crate that knows them.
#[derive(Debug, Clone, Copy)]
pub struct WaterRules {
    /// What is wrong with a water that is looked at in this way.
    pub faults: fn(&Water, Sight) -> Vec<Fault>,
    /// What a user should know of these optics, though nothing is wrong.
    pub warning: fn(&Optics) -> Option<String>,
}

impl Default for WaterRules {
    /// Anything goes.
    fn default() -> Self {
        Self {
            faults: |_, _| Vec::new(),
            warning: |_| None,
        }
    }
}

/// The rules of cameras, handed in by the crate that knows them.
#[derive(Debug, Clone, Copy)]
pub struct CameraRules {
    /// What is wrong with a camera; the flag says whether the scene is rendered for it, else it is a picture.
    pub faults: fn(&Camera, bool) -> Vec<Fault>,
}

impl Default for CameraRules {
    /// Anything goes.
    fn default() -> Self {
        Self {
            faults: |_, _| Vec::new(),
        }
    }
}

/// What a water is looked at with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sight {
    /// Whether lamps light it.
    pub lamps: bool,
    /// The daylight over it.
    pub daylight: Daylight,
    /// Whether its light is traced by Monte Carlo.
    pub traced: bool,
    /// The largest cross-section of the view at 1 m, m²; absent if it is not known.
    pub solid: Option<f64>,
}

/// Something wrong, with the field that has to change.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// The field below the object that was checked, such as `["optics", "g_per_m"]`; empty: the object as a whole.
    pub path: Vec<&'static str>,
    /// Names field, value and limit.
    pub message: String,
    /// Whether it says that something is missing.
    pub missing: bool,
}
