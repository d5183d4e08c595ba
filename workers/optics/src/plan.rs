//! What a frame needs for a tolerance: every stage with its form, its share of the tolerance, its bound and its expected cost.
//! Plain data, chosen before anything is computed; the stages do what it says and decide nothing.
//!
//! The tolerance is the largest error in linear light, and the stages share it. A stage is skipped only where its whole effect
//! stays within its share; else the cheapest form is taken whose error [`Bound`](crate::forward_scatter::Bound) says does. The
//! bounds of a frame add up to its tolerance at most, or [`Plan::exceeds`] says why. A style network has no known gain: the
//! bounds hold up to its input.

mod above;
mod bins;
mod casting;
mod cost;
mod gates;
mod ibla;
mod lamps;
mod layered;
mod levels;
mod line;
mod model;
mod outlook;
mod passages;
mod scatter;
mod sediment;
mod shadows;
mod shares;
mod snow;
mod stats;
mod style;
mod veil;
mod water;

pub use above::Above;
pub use casting::Casting;
pub use gates::GateStep;
pub use ibla::{IblaForm, IblaStep};
pub use lamps::LampLight;
pub use levels::display_tolerance;
pub use line::Line;
pub use scatter::MOST_TERMS;
pub use shadows::{Shadows, shadow_share};
pub use shares::{before_water, glow_share};
pub use stats::{RangeBin, SceneStats};
pub use style::StyleTraits;

use spec::{Fidelity, Frame, Haze};

use crate::forward_scatter::{Kernels, Nodes};
use crate::lamp;
use crate::setting::Setting;
use crate::water::Water;
use model::{Conditions, ModelErrors};
use shares::Shares;
use water::WaterStages;

/// How a stage runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Not at all.
    Skip,
    /// In f32.
    Fast,
    /// In f64.
    Reference,
}

/// Forward scatter of one channel.
#[derive(Debug, Clone, PartialEq)]
pub enum ScatterStep {
    /// Its effect stays below the tolerance.
    Skip,
    /// The kernel is narrower than a pixel: what is scattered arrives where it left.
    Pointwise,
    /// Interpolation between these kernels.
    Interpolated(Nodes),
    /// The same with two kernels in each path or behind gates: the nodes of each layer, nearest first, of one where there are no
    /// gates.
    Layered(Vec<Kernels>),
    /// Every pixel's own kernel, in f64.
    Reference,
}

impl ScatterStep {
    /// Kernels; none where nothing is transformed by them.
    #[must_use]
    pub fn terms(&self) -> Option<usize> {
        match self {
            Self::Interpolated(nodes) => Some(nodes.terms()),
            Self::Layered(layers) => Some(layers.iter().map(Kernels::terms).sum()),
            Self::Skip | Self::Pointwise | Self::Reference => None,
        }
    }
}

/// What of a style model runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StyleStep {
    /// No style, or no weight of it.
    Skip,
    /// The network.
    Network,
    /// The network, which looks at the range of each pixel, too.
    RangeNetwork,
    /// Its color table.
    Table,
}

/// One stage of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Stage<F = Form> {
    /// What is done.
    pub form: F,
    /// The error in linear light that it is given, where the frame asks for a tolerance.
    pub share: Option<f64>,
    /// What it may add to the error of the picture, where that is known.
    pub bound: Option<f64>,
}

/// The plan of a frame, stage by stage in the order of the light.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The largest error in linear light that the frame asks for; none where it asks for kernels or for the reference.
    pub tolerance: Option<f64>,
    /// Daylight at the depth on the scene.
    pub scene_light: Stage,
    /// Light from above on surfaces; none where the frame does not ask for it.
    pub above: Option<Above>,
    /// Paths through patches of murkier water.
    pub turbidity: Stage,
    /// Light of the lamps on surfaces.
    pub lamps: Stage,
    /// Shadows on surfaces; none where no lamp casts one.
    pub lamp_shadows: Option<Stage<Shadows>>,
    /// Attenuation; in f64 forward scatter is, too.
    pub attenuation: Stage,
    /// The veil by direction, or the constant one where that is as good; none where the frame does not ask for it. Its bound is a part
    /// of that of the water.
    pub veil: Option<Stage>,
    /// Gates that stop spread light; none where the frame does not ask for them.
    pub gates: Option<Stage<GateStep>>,
    /// Forward scatter of each channel. Its bound is that of all of the water: attenuation, gates, scatter and rounding.
    pub scatter: [Stage<ScatterStep>; 3],
    /// Glow of the water before the lamps.
    pub glow: Stage,
    /// Shadows in the glow; none where no lamp casts one.
    pub glow_shadows: Option<Stage<Shadows>>,
    /// Clouds of sediment; none where the frame does not ask for them.
    pub sediment: Option<Stage>,
    /// Marine snow.
    pub snow: Stage,
    /// The style.
    pub style: Stage<StyleStep>,
    /// Haze of the lights.
    pub haze: Stage,
    /// Enhancement of the 8-bit result.
    pub enhance: Stage,
    /// The form of the enhancement `ibla`; none where the frame does not ask for it.
    pub ibla: Option<Stage<IblaStep>>,
    /// Why the bounds add up to more than the tolerance; none where they do not.
    pub exceeds: Option<String>,
    /// How far the models of the stages are from the truth.
    model: ModelErrors,
    /// How much of everything there is, from which the expected cost follows.
    amounts: cost::Amounts,
}

/// What a plan is made from.
#[derive(Debug, Clone, Copy)]
pub struct Given<'a> {
    /// The description.
    pub frame: &'a Frame,
    /// Water, lamps, patches and snow of the frame.
    pub setting: &'a Setting,
    /// What was measured of the scene in its light.
    pub stats: &'a SceneStats,
    /// Its light from above, where it falls on surfaces.
    pub above: Option<&'a Above>,
    /// The light of its lamps.
    pub lamps: LampLight,
    /// How they cast shadows; none where they do so as they are described.
    pub casting: Option<&'a Casting>,
    /// The most that clouds of sediment may hide of a pixel; 0 where none is in view.
    pub cloud_opacity: f64,
    /// The most light that a particle of snow adds to a pixel; 0 without snow.
    pub snow_peak: f64,
    /// The frame's style.
    pub style: StyleTraits,
    /// The forms of the enhancement `ibla`, the exact one first, each faster than the one before it; empty where the frame does not ask
    /// for it.
    pub ibla: &'a [IblaForm],
}

impl Form {
    /// How every stage of a frame runs that is not left out.
    #[must_use]
    pub fn asked_by(fidelity: Fidelity) -> Self {
        match fidelity {
            Fidelity::REFERENCE => Self::Reference,
            _ => Self::Fast,
        }
    }

    fn when(self, is_there: bool) -> Self {
        if is_there { self } else { Self::Skip }
    }
}

impl<F> Stage<F> {
    /// A stage without error.
    fn exact(form: F) -> Self {
        Self {
            form,
            share: None,
            bound: None,
        }
    }
}

impl Plan {
    /// Chooses for a frame.
    #[must_use]
    pub fn new(given: &Given<'_>) -> Self {
        let Given {
            frame,
            setting,
            stats,
            ..
        } = *given;
        let shares = Shares::new(given);
        let form = Form::asked_by(frame.fidelity);
        let water = match &setting.around {
            Some(water) => WaterStages::choose(stats, water, shares.fidelity(frame)),
            None => WaterStages::none(),
        };
        let rounded = |is_there: bool, bound: f64| Stage {
            form: form.when(is_there),
            share: None,
            bound: (is_there && form == Form::Fast).then_some(bound),
        };
        let plan = Self {
            tolerance: shares.tolerance,
            scene_light: Stage::exact(
                Form::Fast.when(given.above.is_none() && ![[0.0; 3], [1.0; 3]].contains(&setting.gain())),
            ),
            above: given.above.cloned(),
            turbidity: rounded(setting.patches.is_some(), shares.path),
            lamps: rounded(setting.lighting.is_some(), shares.surfaces),
            lamp_shadows: shadows::on_surfaces(given),
            attenuation: water.attenuation,
            veil: water.veil,
            gates: water.gates,
            scatter: water.scatter,
            glow: lamps::glow(given),
            glow_shadows: shadows::in_water(given),
            sediment: sediment::drift(given),
            snow: snow::fall(given, &shares),
            style: style::choose(given),
            haze: Stage::exact(Form::Fast.when(frame.haze().iter().any(Haze::shines))),
            enhance: Stage::exact(Form::Fast.when(!frame.enhance.is_empty())),
            ibla: ibla::choose(given.ibla, frame.fidelity),
            exceeds: None,
            model: setting
                .around
                .as_ref()
                .map_or_else(ModelErrors::default, |water| {
                    ModelErrors::measured(&Conditions {
                        water,
                        lighting: setting.lighting.as_ref(),
                        patches: setting.patches.as_ref(),
                        stats,
                    })
                }),
            amounts: cost::Amounts::new(frame, setting),
        };
        let lamps = &given.lamps;
        let rounding = shares.path
            + shares.surfaces
            + shares.above
            + lamps.glow_rounding
            + water.rounding
            + shares.snow_rounding;
        let lacks_nodes = lamps.glow_left > glow_share(given.frame);
        Self {
            exceeds: plan.excess(rounding, lacks_nodes),
            ..plan
        }
    }

    /// Chooses for water alone, around a scene without lamps, snow, style or haze.
    #[must_use]
    pub fn for_water(stats: &SceneStats, water: &Water, fidelity: Fidelity) -> Self {
        let stages = WaterStages::choose(stats, water, fidelity);
        let plan = Self {
            tolerance: levels::tolerance(stats, water, fidelity),
            scene_light: Stage::exact(Form::Fast.when(water.radiance_gain != [1.0; 3])),
            attenuation: stages.attenuation,
            veil: stages.veil,
            gates: stages.gates,
            scatter: stages.scatter,
            model: ModelErrors::measured(&Conditions::of_water(water, stats)),
            ..Self::in_air(stats.pixels)
        };
        Self {
            exceeds: plan.excess(stages.rounding, false),
            ..plan
        }
    }

    /// The plan of a frame to which nothing is done.
    #[must_use]
    pub fn in_air(pixels: usize) -> Self {
        let skip = || Stage::exact(Form::Skip);
        Self {
            tolerance: None,
            scene_light: skip(),
            above: None,
            turbidity: skip(),
            lamps: skip(),
            lamp_shadows: None,
            attenuation: skip(),
            veil: None,
            gates: None,
            scatter: [const { ScatterStep::Skip }; 3].map(Stage::exact),
            glow: skip(),
            glow_shadows: None,
            sediment: None,
            snow: skip(),
            style: Stage::exact(StyleStep::Skip),
            haze: skip(),
            enhance: skip(),
            ibla: None,
            exceeds: None,
            model: ModelErrors::default(),
            amounts: cost::Amounts::of_pixels(pixels),
        }
    }

    /// The error in linear light that all stages before the style may make together in a channel; none where the frame asks for
    /// no tolerance.
    #[must_use]
    pub fn bound(&self, channel: usize) -> Option<f64> {
        let water = self.scatter[channel].bound;
        let others = [&self.turbidity, &self.lamps, &self.glow, &self.snow];
        self.tolerance?;
        let above = self.above.as_ref().map_or(0.0, Above::bound);
        let shadows = self.lamp_shadows.as_ref().and_then(|stage| stage.bound);
        let clouds = self.sediment.as_ref().and_then(|stage| stage.bound);
        let others = others.iter().filter_map(|stage| stage.bound).sum::<f64>();
        Some(water.unwrap_or(0.0) + above + shadows.unwrap_or(0.0) + clouds.unwrap_or(0.0) + others)
    }

    /// [`Plan::bound`] of each channel.
    #[must_use]
    pub fn bounds(&self) -> Option<[f64; 3]> {
        let bounds = [0, 1, 2].map(|channel| self.bound(channel).unwrap_or(f64::NAN));
        self.tolerance.map(|_| bounds)
    }

    /// Why the bounds exceed the tolerance: `rounding` may be too much of it, or a ray to a lamp needs more nodes than there are.
    fn excess(&self, rounding: f64, lacks_nodes: bool) -> Option<String> {
        let tolerance = self.tolerance?;
        let whole = (0..3)
            .filter_map(|channel| self.bound(channel))
            .fold(0.0, f64::max);
        if whole <= tolerance * (1.0 + 1e-9) {
            return None;
        }
        let kernels = self
            .scatter
            .iter()
            .any(|stage| stage.form.terms() >= Some(MOST_TERMS));
        let mut reasons = vec![format!("the bounds add up to {whole:.2e}")];
        if rounding > 0.0 {
            reasons.push(format!(
                "rounding of f32 alone may reach {rounding:.2e} in light as bright as here"
            ));
        }
        reasons.extend(kernels.then(|| format!("{MOST_TERMS} kernels are the most")));
        reasons.extend(
            lacks_nodes.then(|| format!("{} nodes are the most on a ray to a lamp", lamp::MOST_NODES)),
        );
        Some(reasons.join(", "))
    }
}

#[cfg(test)]
mod tests;
