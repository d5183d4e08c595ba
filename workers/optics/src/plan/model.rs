//! What is known of the physics itself: how far the model of each stage was measured to be from radiative transfer, and in what
//! water. The bounds of a plan say how near its numbers are to the model; this says how near the model is to the truth.
//!
//! [`MEASURED`] is the one table. A stage takes the first of its rows that holds; where none does, its error is not measured.

mod lamps;

use spec::VeilForm;

use super::SceneStats;
use crate::daylight::Daylight;
use crate::lamp::Lighting;
use crate::turbidity::Field;
use crate::water::{Scatter, Water};

/// What is said of a stage where nothing was measured.
const NOT_MEASURED: &str = "not measured";
/// b Z up to which the light beside and over edges was measured.
const EDGES_UP_TO: f64 = 4.0;
/// K z and b/a between which radiance by direction was measured, with a little more on both sides.
const SKY_DEPTHS: std::ops::RangeInclusive<f64> = 0.3..=4.0;
const SKY_RATIOS: std::ops::RangeInclusive<f64> = 0.25..=6.0;

/// What measurements depend on.
pub(super) struct Conditions<'a> {
    pub(super) water: &'a Water,
    pub(super) lighting: Option<&'a Lighting>,
    pub(super) patches: Option<&'a Field>,
    pub(super) stats: &'a SceneStats,
}

/// A measurement: the stage, and what was found, where it holds.
struct Row {
    stage: &'static str,
    found: fn(&Conditions<'_>) -> Option<String>,
}

/// Every measurement. Ratios are model over truth; docs/truth.md says how they were made.
const MEASURED: &[Row] = &[
    Row {
        stage: "attenuation",
        found: unscattered,
    },
    Row {
        stage: "veil",
        found: veil_by_direction,
    },
    Row {
        stage: "forward_scatter",
        found: two_kernels,
    },
    Row {
        stage: "forward_scatter",
        found: one_kernel,
    },
    Row {
        stage: "lamps",
        found: lamps::surfaces,
    },
    Row {
        stage: "lamps",
        found: lamps::followed_surfaces,
    },
    Row {
        stage: "glow",
        found: lamps::glow,
    },
    Row {
        stage: "glow",
        found: lamps::followed_glow,
    },
];

/// The stages whose light is physics. Style, haze and enhancement have no truth.
const PHYSICAL: &[&str] = &[
    "scene_light",
    "surfaces",
    "sun_shadow",
    "ambient_access",
    "caustics",
    "turbidity",
    "lamps",
    "attenuation",
    "veil",
    "forward_scatter",
    "glow",
    "sediment",
    "snow",
];

/// The model error of each stage of a frame, by the stage's name.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct ModelErrors(Vec<(&'static str, String)>);

impl ModelErrors {
    pub(super) fn measured(conditions: &Conditions<'_>) -> Self {
        let found = |stage: &'static str| {
            let mut rows = MEASURED.iter().filter(|row| row.stage == stage);
            let found = rows.find_map(|row| (row.found)(conditions));
            (stage, found.unwrap_or_else(|| NOT_MEASURED.to_owned()))
        };
        Self(PHYSICAL.iter().map(|stage| found(stage)).collect())
    }

    /// What to say of a line of a plan; nothing of a stage without a truth.
    pub(super) fn of(&self, line: &str) -> Option<String> {
        let stage = line.split('.').next();
        let found = self.0.iter().find(|(name, _)| stage == Some(*name));
        found.map(|(_, error)| error.clone())
    }
}

/// Light that arrives unscattered falls as e^{−cZ} in the truth, too; daylight's veil was compared with nothing.
fn unscattered(conditions: &Conditions<'_>) -> Option<String> {
    let is_constant = !conditions.water.daylight().is_some_and(Daylight::varies);
    let veil = is_constant && conditions.water.veiling_light() != [0.0; 3];
    let veil = if veil { "; veil: not measured" } else { "" };
    conditions
        .patches
        .is_none()
        .then(|| format!("unscattered light: none{veil}"))
}

/// Radiance by direction was held against Monte Carlo at some depths of some waters under an even sky.
fn veil_by_direction(conditions: &Conditions<'_>) -> Option<String> {
    let daylight = conditions.water.daylight().filter(|daylight| daylight.varies())?;
    let (a, b) = conditions.water.absorption.zip(conditions.water.scattering)?;
    let is_derived = |field| conditions.water.derived().contains(&field);
    let is_like = |i: usize| {
        let depth = daylight.fields()[i].decay * daylight.depth();
        SKY_DEPTHS.contains(&depth) && SKY_RATIOS.contains(&(b[i] / a[i]))
    };
    let known = ["horizon", "p", "q"].into_iter().all(is_derived) && (0..3).all(is_like);
    let brightness = match daylight.veil_form() {
        VeilForm::Physical => "",
        VeilForm::Constant | VeilForm::Field => "; brightness of the horizon: a convention",
    };
    (known && conditions.patches.is_none()).then(|| {
        format!(
            "radiance of open water by direction 0.89-1.20 of the truth, measured in two waters under an even sky{brightness}"
        )
    })
}

/// One kernel for each range: too narrow in its tail, and blind to what stands before it.
fn one_kernel(conditions: &Conditions<'_>) -> Option<String> {
    let Scatter::Jaffe {
        source: spec::ScatterSource::Radiance,
        tail: None,
        layers: None,
        ..
    } = conditions.water.scatter()
    else {
        return None;
    };
    edges_were_measured(conditions).then(|| {
        "light beside an edge 0.27-1.5 of the truth, light over a nearer object 1.6-5.1 times the truth"
            .to_owned()
    })
}

/// Two kernels for each range, blind to what stands before it or stopped by it.
fn two_kernels(conditions: &Conditions<'_>) -> Option<String> {
    let Scatter::Jaffe {
        source: spec::ScatterSource::Radiance,
        tail: Some(_),
        layers,
        ..
    } = conditions.water.scatter()
    else {
        return None;
    };
    // How much leaks over near objects without gates was measured of one kernel alone.
    let over = layers.map_or("", |_| ", light over a nearer object 0.92-1.27 of the truth");
    edges_were_measured(conditions).then(|| format!("light beside an edge 0.80-1.18 of the truth{over}"))
}

/// Whether the farthest surface is no farther than light at edges was measured, in even water.
fn edges_were_measured(conditions: &Conditions<'_>) -> bool {
    let known = conditions.water.scattering().zip(conditions.stats.range_m);
    known.is_some_and(|(b, (_, farthest))| {
        let thickest = b.into_iter().fold(0.0, f64::max) * farthest;
        thickest <= EDGES_UP_TO && conditions.patches.is_none()
    })
}

impl<'a> Conditions<'a> {
    pub(super) fn of_water(water: &'a Water, stats: &'a SceneStats) -> Self {
        Self {
            water,
            lighting: None,
            patches: None,
            stats,
        }
    }
}
