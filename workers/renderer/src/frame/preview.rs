//! Renders a thinned scene from radiance to codes, with and without an effect. The difference estimates the effect before the frame
//! is planned.

mod occlusion;

use std::borrow::Cow;
use std::cell::OnceCell;

use imaging::rays::Rays;
use imaging::{Plane, Rgb, transfer};
use optics::attenuation::exp_negative;
use optics::daylight::{self, Daylight, Reaching, SunLight, Surfaces, Tiles};
use optics::lamp::{self, Lighting, Shadow};
use optics::layering::Layering;
use optics::plan::StageId;
use optics::range::{is_hole, of_surfaces};
use optics::water::Water;

use crate::context::FrameContext;
use crate::effects::{Change, VISIBLE_CODES};
use crate::inputs::caustics::find_coarse_tiles;

/// Cells along the caustic tile for estimating contrast: a quarter of those of a frame.
const TILE_CELLS: usize = 32;

/// A thinned scene in its light.
pub(crate) struct Preview<'a> {
    context: &'a FrameContext<'a>,
    range: Cow<'a, Plane<f32>>,
    normals: Cow<'a, [Plane<f32>; 3]>,
    water: &'a Water,
    /// The wave pattern in few cells; `None` without caustics.
    tiles: Option<Tiles>,
    /// The layers of the frame itself: in a thinned picture a slope has edges too. `None` without occlusion of scattered light.
    layering: Option<Layering>,
    /// Factor of the exposure.
    gain: f64,
    /// Noise of the sensor in exposed light; 0 without a sensor.
    noise: f64,
    /// The veil, and the picture without any effect, once they are needed.
    veil: OnceCell<Rgb<f32>>,
    plain: OnceCell<Rgb<f32>>,
}

/// Factors of daylight on surfaces; `None` means 1.
#[derive(Clone, Copy, Default)]
struct Light<'a> {
    sun: Option<&'a Plane<f32>>,
    sky: Option<&'a Rgb<f32>>,
    shadows: bool,
}

impl<'a> Preview<'a> {
    /// A thinned frame with the layers of the frame. `None` without water or range.
    pub(crate) fn new(
        context: &'a FrameContext<'a>,
        layering: Option<Layering>,
        gain: f64,
        noise: f64,
    ) -> Option<Self> {
        let water = context.setting.water.as_ref()?;
        let range = of_surfaces(context.prepared.scene.range.as_ref()?, water.holes());
        let normals = match &context.prepared.scene.normals {
            Some(normals) => Cow::Borrowed(normals),
            None => Cow::Owned(lamp::normals_of(&range, &context.setting.eye.camera)),
        };
        let tiles = find_coarse_tiles(context.frame, &context.setting, &range, TILE_CELLS);
        Some(Self {
            context,
            range,
            normals,
            water,
            tiles,
            layering,
            gain,
            noise,
            veil: OnceCell::new(),
            plain: OnceCell::new(),
        })
    }

    /// The change of the picture by an effect; `None` if the frame cannot have it.
    pub(crate) fn measure_change(&self, id: StageId, cost_ms: f64) -> Option<Change> {
        let [with, without] = match id {
            StageId::SunShadow => self.with_sun_shadow()?,
            StageId::AmbientAccess => self.with_ambient_occlusion()?,
            StageId::Caustics => self.with_caustics()?,
            StageId::Shafts => self.with_shafts()?,
            StageId::LampShadows => self.with_lamp_shadows()?,
            StageId::VeilOcclusion => self.with_veil_occlusion()?,
            StageId::Occlusion => self.with_occlusion()?,
            _ => return None,
        };
        Some(self.compare(&with, &without, cost_ms))
    }

    fn daylight(&self) -> Option<&Daylight> {
        self.water.daylight()
    }

    fn sun(&self) -> Option<(&Daylight, &SunLight)> {
        let daylight = self.daylight()?;
        Some((daylight, daylight.sun()?))
    }

    fn surfaces(&self) -> Surfaces<'_> {
        Surfaces {
            range: &self.range,
            normals: &self.normals,
            objects: self.context.prepared.scene.instances.as_ref(),
        }
    }

    fn rays(&self) -> Option<&dyn Rays> {
        self.context.rays()
    }

    fn with_sun_shadow(&self) -> Option<[Rgb<f32>; 2]> {
        let (daylight, sun) = self.sun().filter(|(daylight, sun)| {
            daylight.surfaces() == daylight::SurfaceLight::Normal && sun.casts_shadows
        })?;
        let seen = daylight::sunlit(self.surfaces(), daylight, sun, self.rays()?);
        let shadowed = Light {
            sun: Some(&seen),
            ..Light::default()
        };
        Some([self.arriving(shadowed), self.plain().clone()])
    }

    fn with_ambient_occlusion(&self) -> Option<[Rgb<f32>; 2]> {
        let daylight = self.daylight().filter(|daylight| daylight.ambient_rays() > 0)?;
        let attenuation = self.water.direct_attenuation();
        let access = daylight::access(self.surfaces(), daylight, attenuation, self.rays()?);
        let occluded = Light {
            sky: Some(&access),
            ..Light::default()
        };
        Some([self.arriving(occluded), self.plain().clone()])
    }

    fn with_caustics(&self) -> Option<[Rgb<f32>; 2]> {
        let (daylight, sun) = self.sun()?;
        let tiles = self.tiles.as_ref()?;
        if daylight.surfaces() != daylight::SurfaceLight::Normal {
            return None;
        }
        let mut pattern = Plane::filled(self.range.width(), self.range.height(), 1.0);
        daylight::caustics(&self.range, daylight, sun, tiles, &mut pattern);
        let lit = Light {
            sun: Some(&pattern),
            ..Light::default()
        };
        Some([self.arriving(lit), self.plain().clone()])
    }

    fn with_shafts(&self) -> Option<[Rgb<f32>; 2]> {
        let (daylight, sun) = self.sun().filter(|(daylight, _)| daylight.has_shafts())?;
        let tiles = self.tiles.as_ref()?;
        let shafts = daylight::shafts(&self.range, daylight, sun, tiles, self.clearest());
        let (mut veil, plain) = (self.veil().clone(), self.plain().clone());
        let mut total = plain.clone();
        daylight::with_shafts(&mut veil, &mut total, &shafts, daylight);
        Some([total, plain])
    }

    fn with_veil_occlusion(&self) -> Option<[Rgb<f32>; 2]> {
        let daylight = self.daylight().filter(|daylight| daylight.occludes_veil())?;
        let access = daylight::veil_access(&self.range, daylight, self.rays()?);
        let (mut veil, plain) = (self.veil().clone(), self.plain().clone());
        let mut total = plain.clone();
        daylight::occlude_veil(&mut veil, &mut total, &access);
        Some([total, plain])
    }

    /// Attenuation of the clearest channel.
    fn clearest(&self) -> f64 {
        let attenuation = self.water.direct_attenuation();
        attenuation.into_iter().fold(f64::INFINITY, f64::min)
    }

    fn with_lamp_shadows(&self) -> Option<[Rgb<f32>; 2]> {
        self.context.setting.lighting.as_ref()?;
        self.rays()?;
        let shadowed = Light {
            shadows: true,
            ..Light::default()
        };
        Some([self.arriving(shadowed), self.plain().clone()])
    }

    /// Transmitted light, and the veil in front of it.
    fn arriving(&self, light: Light<'_>) -> Rgb<f32> {
        let surfaces = self.light_surfaces(light);
        let veil = self.veil();
        let attenuation = self.water.direct_attenuation();
        self.for_each_pixel(|channel, x, y, z| {
            let direct = surfaces.planes()[channel].pixel(x, y);
            let transmittance = exp_negative((attenuation[channel] * z) as f32);
            direct * transmittance + veil.planes()[channel].pixel(x, y)
        })
    }

    /// The light of surfaces, before the water.
    fn light_surfaces(&self, light: Light<'_>) -> Rgb<f32> {
        let scene = &self.context.prepared.scene.radiance;
        let setting = &self.context.setting;
        let daylit = self
            .daylight()
            .filter(|daylight| daylight.surfaces() != daylight::SurfaceLight::None)
            .map(|daylight| {
                let reaching = Reaching {
                    sunlight: light.sun,
                    access: light.sky,
                };
                daylight::surfaces(scene, &self.range, &self.normals, daylight, reaching)
            });
        let lamps = setting
            .lighting
            .as_ref()
            .map(|lighting| self.shine(lighting, light.shadows));
        match (daylit, lamps) {
            (Some(daylit), Some(lamps)) => daylight::with_lamps(daylit, scene, &lamps),
            (Some(daylit), None) => daylit,
            (None, Some(lamps)) => lamp::lit(scene, setting.gain(), &lamps),
            (None, None) => scene.clone(),
        }
    }

    /// The picture without any effect.
    fn plain(&self) -> &Rgb<f32> {
        self.plain.get_or_init(|| self.arriving(Light::default()))
    }

    /// The veil at the radiance of the horizon.
    fn veil(&self) -> &Rgb<f32> {
        self.veil.get_or_init(|| {
            let (attenuation, veil) = (self.water.direct_attenuation(), self.water.veiling_light());
            self.for_each_pixel(|channel, _, _, z| {
                (veil[channel] * -(-attenuation[channel] * z).exp_m1()) as f32
            })
        })
    }

    fn for_each_pixel(&self, light: impl Fn(usize, usize, usize, f64) -> f32) -> Rgb<f32> {
        let (width, height) = self.range.size();
        Rgb::from_fn(width, height, |x, y| {
            let z = self.range.pixel(x, y);
            let z = if is_hole(z) { f64::INFINITY } else { f64::from(z) };
            [0, 1, 2].map(|channel| light(channel, x, y, z))
        })
    }

    /// Light of lamps on surfaces, with hard shadows or without.
    fn shine(&self, lighting: &Lighting, shadows: bool) -> Rgb<f32> {
        match self.rays().filter(|_| shadows) {
            Some(rays) => {
                let hard = Lighting {
                    lamps: (lighting.lamps.iter())
                        .map(|lamp| lamp.with_shadow(Shadow::Hard, false))
                        .collect(),
                    ..lighting.clone()
                };
                lamp::shaded_irradiance(&self.range, &self.normals, &hard, (rays, 0.0)).light
            }
            None => lamp::irradiance(&self.range, &self.normals, lighting).light,
        }
    }

    /// The change between two pictures in codes after the exposure.
    fn compare(&self, with: &Rgb<f32>, without: &Rgb<f32>, cost_ms: f64) -> Change {
        let (width, height) = with.size();
        let (mut visible, mut sum) = (0usize, 0.0);
        for y in 0..height {
            for x in 0..width {
                let mut largest = 0.0f64;
                for (with, without) in with.planes().iter().zip(without.planes()) {
                    let exposed =
                        [with, without].map(|plane| (self.gain * f64::from(plane.pixel(x, y))).min(1.0));
                    if (exposed[0] - exposed[1]).abs() > self.noise {
                        let codes = exposed.map(|light| 255.0 * transfer::encode(light));
                        largest = largest.max((codes[0] - codes[1]).abs());
                    }
                }
                sum += largest;
                visible += usize::from(largest > VISIBLE_CODES);
            }
        }
        let pixels = (width * height) as f64;
        Change {
            share: visible as f64 / pixels,
            mean_codes: sum / pixels,
            cost_ms,
        }
    }
}
