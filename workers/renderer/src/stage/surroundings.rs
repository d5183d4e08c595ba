//! What snow and clouds of sediment hang in: the water before them and the light that meets them.

use imaging::Plane;
use imaging::rays::Rays;
use optics::lamp;
use optics::setting::Setting;
use optics::snow::Surround;

/// What is in the way of the light of lamps.
#[derive(Clone, Copy)]
pub(super) enum Shading<'a> {
    /// Nothing.
    None,
    /// What is looked for in f32 from many places at once.
    Fast {
        rays: &'a dyn Rays,
        /// Light up to this arrives whatever is in the way.
        unseen: f64,
    },
    /// What is looked for from every place, in f64.
    Reference(&'a dyn Rays),
}

/// A setting in front of a range image.
#[derive(Clone, Copy)]
pub(super) struct Surroundings<'a> {
    pub(super) setting: &'a Setting,
    pub(super) range: &'a Plane<f32>,
    pub(super) shading: Shading<'a>,
}

impl<'a> Surroundings<'a> {
    /// With every shadow that lamps are to cast.
    pub(super) fn reference(
        setting: &'a Setting,
        range: &'a Plane<f32>,
        rays: Option<&'a (dyn Rays + Sync)>,
    ) -> Self {
        Self {
            setting,
            range,
            shading: rays.map_or(Shading::None, |rays| Shading::Reference(rays)),
        }
    }

    /// Hands out what particles hang in.
    pub(super) fn show<T>(&self, see: impl FnOnce(&Surround<'_>) -> T) -> T {
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
            light: &|places| self.light(places),
        })
    }

    /// Radiance of white particles: of light from above, and of lamps.
    fn light(&self, places: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let gain = self.setting.gain();
        let from_above = |place: [f64; 3]| {
            let above = self.setting.daylight_at(place);
            [0, 1, 2].map(|i| gain[i] * above[i])
        };
        let mut light: Vec<[f64; 3]> = places.iter().map(|&place| from_above(place)).collect();
        let Some(lighting) = &self.setting.lighting else {
            return light;
        };
        let add = |(light, lamps): (&mut [f64; 3], [f64; 3])| {
            *light = [0, 1, 2].map(|i| light[i] + lamps[i]);
        };
        let each = |rays: Option<&dyn Rays>| {
            let lamps = places.iter().map(|&place| lamp::white_at(place, lighting, rays));
            lamps.collect::<Vec<_>>()
        };
        let lamps = match self.shading {
            Shading::None => each(None),
            Shading::Reference(rays) => each(Some(rays)),
            Shading::Fast { rays, unseen } => lamp::white_at_each(places, lighting, (rays, unseen)),
        };
        light.iter_mut().zip(lamps).for_each(add);
        light
    }
}
