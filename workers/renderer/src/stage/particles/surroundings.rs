//! The medium around snow and sediment: the water in front of them and the light that reaches them.

use imaging::Plane;
use imaging::rays::Rays;
use optics::lamp::{self, Lighting, Shadow};
use optics::lit_point::LitPoint;
use optics::plan::{StageId, Variant};
use optics::setting::Setting;
use optics::snow::Surround;

use crate::context::FrameContext;

/// Occlusion of lamps.
#[derive(Clone, Copy)]
enum Shading<'a> {
    /// No occlusion.
    None,
    /// Traced in f32, in packets.
    Fast {
        rays: &'a dyn Rays,
        /// Irradiance below which lamps are not tested for occlusion.
        unseen: f64,
    },
    /// Traced in f64 from every point.
    Reference(&'a dyn Rays),
}

/// A setting in front of a range image.
#[derive(Clone, Copy)]
pub(crate) struct Surroundings<'a> {
    pub(crate) setting: &'a Setting,
    pub(crate) range: &'a Plane<f32>,
    shading: Shading<'a>,
}

impl<'a> Surroundings<'a> {
    /// The surroundings of a frame in front of its range, with the shadows of its plan; `None` without range.
    pub(crate) fn new(context: &'a FrameContext<'_>) -> Option<Self> {
        let casts = |lighting: &Lighting| lighting.lamps.iter().any(|lamp| lamp.shadow() != Shadow::None);
        let rays = context
            .rays()
            .filter(|_| context.setting.lighting.as_ref().is_some_and(casts));
        Some(Self {
            setting: &context.setting,
            range: context.prepared.scene.range.as_ref()?,
            shading: match (rays, context.plan.stage(StageId::LampShadows)) {
                (None, _) | (_, None) => Shading::None,
                (Some(rays), Some(stage)) if stage.variant == Variant::Reference => Shading::Reference(rays),
                (Some(rays), Some(stage)) => Shading::Fast {
                    rays,
                    unseen: stage.share.unwrap_or_default(),
                },
            },
        })
    }

    /// Calls `see` with the medium around the particles.
    pub(crate) fn show<T>(&self, see: impl FnOnce(&Surround<'_>) -> T) -> T {
        let eye = &self.setting.eye;
        let patches = self.setting.patches.map(|field| field.seen_from(eye));
        let path = |place: [f64; 3], meters: f64| match &patches {
            Some(field) => field.path_m(place.map(|v| v / meters), meters),
            None => meters,
        };
        see(&Surround {
            range: self.range,
            eye,
            attenuation: self.setting.attenuation(),
            path: &path,
            light: &|points| self.light(points),
        })
    }

    /// Radiance of white particles in daylight and lamplight.
    fn light(&self, points: &[LitPoint]) -> Vec<[f64; 3]> {
        let gain = self.setting.gain();
        let daylight = points.iter().map(|point| {
            let daylight = self.setting.daylight_at(point.place);
            [0, 1, 2].map(|i| gain[i] * daylight[i])
        });
        let mut light: Vec<[f64; 3]> = daylight.collect();
        let Some(lighting) = &self.setting.lighting else {
            return light;
        };
        let lamps = match self.shading {
            Shading::None => white_by_definition(points, lighting, None),
            Shading::Reference(rays) => white_by_definition(points, lighting, Some(rays)),
            Shading::Fast { rays, unseen } => lamp::white_at_each(points, lighting, (rays, unseen)),
        };
        for (light, lamps) in light.iter_mut().zip(lamps) {
            *light = [0, 1, 2].map(|i| light[i] + lamps[i]);
        }
        light
    }
}

/// The light of all lamps at each place, lamp by lamp.
fn white_by_definition(points: &[LitPoint], lighting: &Lighting, rays: Option<&dyn Rays>) -> Vec<[f64; 3]> {
    let light = points
        .iter()
        .map(|point| lamp::white_at(point.place, lighting, rays));
    light.collect()
}
