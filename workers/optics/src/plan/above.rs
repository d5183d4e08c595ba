//! Light from above on surfaces: what of it a tolerance needs. It is chosen and computed before the rest of the plan, which depends
//! on how bright the scene is in it.

use spec::{Fidelity, Frame, SurfaceLight};

use super::line::{Line, with_errors};
use super::{Form, Stage};
use crate::daylight::Daylight;
use crate::setting::Setting;

/// The tolerance of a frame that gives none.
const TOLERANCE: f64 = 3e-4;
/// Shadows of the sun and caustics are each left out where that changes no more than this part of the tolerance.
const SKIP_SHARE: f64 = 0.0625;

/// The stages of light from above on surfaces.
#[derive(Debug, Clone, PartialEq)]
pub struct Above {
    /// Irradiance by depth and slope.
    pub surfaces: Stage,
    /// Rays to the sun; none without a sun, or where it casts no shadows.
    pub shadow: Option<Stage>,
    /// Rays to the sky; none where there are to be none.
    pub access: Option<Stage>,
    /// The pattern of the waves; none without.
    pub caustics: Option<Stage>,
    /// Whether surfaces have a slope to the light.
    pub(super) is_sloped: bool,
    pub(super) sun_shines: bool,
    /// Rays to the sky of each place that has some.
    pub(super) rays: usize,
    /// Whether rays are followed through a range image, whose errors have no bound.
    pub(super) by_screen: bool,
}

impl Above {
    /// Chooses for a frame whose scene reflects or sends out at most `brightest` in each channel, at ranges up to `farthest`; `peak`
    /// is the brightest place of its caustics, where there are some. `by_screen` says that nothing is known of its shape but the range image. None where light from above falls on no surface.
    #[must_use]
    pub fn choose(
        frame: &Frame,
        setting: &Setting,
        (brightest, peak): ([f32; 3], Option<f64>),
        farthest: f64,
        by_screen: bool,
    ) -> Option<Self> {
        let daylight = setting.water.as_ref()?.daylight()?;
        if daylight.surfaces == SurfaceLight::None {
            return None;
        }
        let form = Form::asked_by(frame.fidelity);
        let is_sloped = daylight.surfaces == SurfaceLight::Normal;
        let sun = daylight.sun.filter(|_| is_sloped);
        let tolerance = match frame.fidelity {
            Fidelity::Tolerance(tolerance) => tolerance,
            _ => TOLERANCE,
        };
        let share = SKIP_SHARE * tolerance;
        let sunlit = (0..3)
            .map(|c| f64::from(brightest[c]) * most_sunlight(daylight, c, farthest))
            .fold(0.0, f64::max);
        let by_sun = |changed: f64| {
            let is_needless = form == Form::Fast && changed <= share;
            Stage {
                form: form.when(!is_needless),
                share: Some(share),
                bound: is_needless.then_some(changed),
            }
        };
        // Brighter by no more than the peak, and darker by no more than all of it.
        let patterned = peak.filter(|_| sun.is_some()).map(|peak| (peak - 1.0).max(1.0));
        let casts = sun.is_some_and(|sun| sun.casts_shadows);
        Some(Self {
            surfaces: Stage::exact(form),
            shadow: casts.then(|| by_sun(sunlit)),
            access: (is_sloped && daylight.rays > 0).then(|| Stage::exact(form)),
            caustics: patterned.map(|change| by_sun(sunlit * change)),
            is_sloped,
            sun_shines: sun.is_some(),
            rays: daylight.rays,
            by_screen,
        })
    }

    /// What all of it may add to the error of the picture, as far as that is known: the edges of shadows have no bound.
    #[must_use]
    pub fn bound(&self) -> f64 {
        self.stages()
            .into_iter()
            .filter_map(|(_, stage)| stage.bound)
            .sum()
    }

    fn stages(&self) -> Vec<(&'static str, &Stage)> {
        let rest = [
            ("sun_shadow", &self.shadow),
            ("ambient_access", &self.access),
            ("caustics", &self.caustics),
        ];
        let rest = rest
            .into_iter()
            .filter_map(|(name, stage)| Some((name, stage.as_ref()?)));
        std::iter::once(("surfaces", &self.surfaces))
            .chain(rest)
            .collect()
    }

    pub(super) fn form_of(&self, name: &str) -> Option<Form> {
        let stages = self.stages();
        let found = stages.iter().find(|(stage, _)| *stage == name);
        found.map(|(_, stage)| stage.form)
    }

    /// The lines of a plan.
    pub(super) fn lines(&self) -> Vec<Line> {
        let stages = self.stages().into_iter();
        stages
            .map(|(name, stage)| {
                let traces = name == "sun_shadow" || name == "ambient_access";
                let variant = match (stage.form, name) {
                    (Form::Skip, _) => "skip",
                    (Form::Reference, _) => "reference",
                    (Form::Fast, "surfaces") if self.is_sloped => "by_normal",
                    (Form::Fast, "surfaces") => "by_depth",
                    (Form::Fast, "caustics") => "tiles",
                    (Form::Fast, _) if self.by_screen => "rays_of_range_image",
                    (Form::Fast, _) => "rays",
                };
                let note = match stage.form {
                    Form::Skip => Some("sunlight changes no more than its share"),
                    _ if traces && self.by_screen => {
                        Some("the error is not known: what the picture does not show casts no shadow")
                    }
                    Form::Fast if name == "sun_shadow" => Some("at edges a pixel may fall on the other side"),
                    Form::Fast if name == "ambient_access" => {
                        Some("between every fourth pixel of one surface, each pixel where there is none")
                    }
                    Form::Fast | Form::Reference => None,
                };
                Line {
                    note: note.map(str::to_owned),
                    terms: (name == "ambient_access").then_some(self.rays),
                    ..with_errors(name, variant, stage)
                }
            })
            .collect()
    }
}

/// No sunlight on a surface is brighter, in units of white of that surface.
fn most_sunlight(daylight: &Daylight, channel: usize, farthest: f64) -> f64 {
    let Some(sun) = daylight.sun else { return 0.0 };
    let (low, high) = daylight.gaze.rises;
    let ends = [
        low.min(0.0) * farthest,
        (high.max(0.0) * farthest).min(daylight.depth),
    ];
    // Both factors are exponentials of the height, and so is their product.
    let at = |height: f64| {
        let share = sun.share_at(&daylight.fields[channel], daylight.depth - height);
        share * daylight.irradiance(channel, height) / sun.rise
    };
    let most = ends.into_iter().map(at).fold(0.0, f64::max);
    let unclamped = ends
        .into_iter()
        .map(|height| daylight.irradiance(channel, height) / sun.rise);
    // Where the share is all of it somewhere, the product has a kink.
    let is_clamped = ends
        .into_iter()
        .any(|height| sun.share_at(&daylight.fields[channel], daylight.depth - height) >= 1.0);
    if is_clamped {
        unclamped.fold(0.0, f64::max)
    } else {
        most
    }
}
