//! The scene in its light: how much water is before each pixel, and what lamps add to surfaces and to the water.

use std::sync::Arc;

use imaging::rays::Rays;
use imaging::{Plane, Rgb};
use optics::daylight;
use optics::lamp::{self, Airlight, Irradiance, Lamp, Lighting, REFERENCE_NODES, Shadow};
use optics::plan::{Above, Casting, Form, LampLight, SceneStats, before_water, glow_share, shadow_share};
use optics::range::is_hole;
use optics::sediment::Layers as Clouds;
use optics::setting::Setting;
use optics::snow::LitFlake;
use optics::turbidity;
use spec::Frame;

use super::above::{LastTiles, Pattern};
use super::scene::Prepared;
use super::snow::{self, Shutter};
use super::surroundings::{Shading, Surroundings};
use super::{above, rays, sediment};
use crate::stopwatch::Stopwatch;

/// A scene in its light.
pub(crate) struct Lit {
    prepared: Arc<Prepared>,
    /// The radiance where light from above makes it or lamps add to it.
    lit: Option<Rgb<f32>>,
    /// What the plan has to know of light from above on surfaces.
    pub(crate) above: Option<Above>,
    /// Its caustics; none without.
    pub(crate) pattern: Option<Pattern>,
    /// The paths through patches of murkier water.
    patchy: Option<Plane<f32>>,
    /// Glow of the water before the lamps; none without lamps, or in water that scatters nothing.
    pub(crate) glow: Option<Rgb<f32>>,
    /// What the plan has to know of the light of the lamps.
    pub(crate) lamps: LampLight,
    /// How they cast shadows; none where they do so as they are described.
    pub(crate) casting: Option<Casting>,
    /// Clouds of sediment in their light; none without clouds, and where the reference follows its own.
    pub(crate) clouds: Option<Clouds>,
    /// Particles of snow in their light; none without snow, and where the reference draws its own.
    pub(crate) flakes: Vec<LitFlake>,
    /// Through what those are seen.
    pub(crate) shutter: Shutter,
    /// Whether a lamp lights any of the scene.
    pub(crate) shines: bool,
}

impl Lit {
    /// Lights a scene.
    pub(crate) fn new(
        frame: &Frame,
        prepared: &Arc<Prepared>,
        setting: &Setting,
        shutter: Shutter,
        tiles: &mut LastTiles,
        watch: &mut Stopwatch,
    ) -> Self {
        let form = Form::asked_by(frame.fidelity);
        let range = prepared.scene.range.as_ref();
        let mut lit = Self {
            prepared: Arc::clone(prepared),
            lit: None,
            above: None,
            pattern: None,
            patchy: watch.time("turbidity", || path(form, frame, range?, setting)),
            glow: None,
            lamps: LampLight::default(),
            casting: None,
            clouds: None,
            flakes: Vec::new(),
            shutter,
            shines: false,
        };
        if let Some(range) = range.filter(|_| frame.water.from_above.is_some()) {
            let above = watch.time("above", || {
                lit.pattern = above::pattern(frame, setting, range, tiles);
                above::light(frame, prepared, setting, lit.pattern.as_ref())
            });
            (lit.lit, lit.above) = above.unzip();
        }
        let rays = casting_rays(frame, prepared, setting);
        let rays = rays.as_deref().map(|rays| rays as &dyn Rays);
        if let (Some(lighting), Some(range)) = (&setting.lighting, range) {
            watch.time("lamps", || {
                let scene = (range, &prepared.scene.radiance);
                lit.casting = (rays.filter(|_| form == Form::Fast))
                    .map(|rays| Casting::needed(before_water(frame), lighting, scene, rays));
                lit.add(frame, (lighting, setting.gain()), range, rays);
                if lighting.scattering != [0.0; 3] {
                    lit.add_glow(frame, lighting, range, rays);
                }
            });
        }
        if let (Form::Fast, Some(range)) = (form, range) {
            watch.time("snow", || lit.suspend(frame, setting, range, rays));
        }
        lit
    }

    /// Adds clouds and snow.
    fn suspend(&mut self, frame: &Frame, setting: &Setting, range: &Plane<f32>, rays: Option<&dyn Rays>) {
        let shading = rays.map_or(Shading::None, |rays| Shading::Fast {
            rays,
            unseen: shadow_share(frame),
        });
        let surroundings = Surroundings {
            setting,
            range,
            shading,
        };
        self.clouds = sediment::layers(&surroundings);
        if let Some(law) = &setting.snow {
            self.flakes = snow::lit(&surroundings, law, &self.shutter, self.clouds.as_ref());
        }
    }

    /// What the camera would see if the water took nothing.
    pub(crate) fn radiance(&self) -> &Rgb<f32> {
        self.lit.as_ref().unwrap_or(&self.prepared.scene.radiance)
    }

    /// Meters of mean water before each pixel: its range, or its path through patches; none without range.
    pub(crate) fn path(&self) -> Option<&Plane<f32>> {
        self.patchy.as_ref().or(self.prepared.scene.range.as_ref())
    }

    /// Adds the light of lamps on surfaces to that around them. The radiance of the scene in air stands for its reflectance.
    fn add(
        &mut self,
        frame: &Frame,
        (lighting, gain): (&Lighting, [f64; 3]),
        range: &Plane<f32>,
        rays: Option<&dyn Rays>,
    ) {
        let normals = lamp::normals_of(range, &lighting.camera);
        let needed = (self.casting.as_ref()).map_or(lighting, |casting| &casting.on_surfaces);
        let casts = needed.lamps.iter().any(|lamp| lamp.shadow() != Shadow::None);
        let irradiance = match (Form::asked_by(frame.fidelity), rays.filter(|_| casts)) {
            (Form::Reference, rays) => {
                let range = range.map(|&z| f64::from(z));
                let light = match rays {
                    Some(rays) => lamp::shaded_irradiance_reference(&range, &normals, lighting, rays),
                    None => lamp::irradiance_reference(&range, &normals, lighting),
                };
                Irradiance {
                    light: light.map(|&e| e as f32),
                    rounding: 0.0,
                }
            }
            (Form::Fast | Form::Skip, None) => lamp::irradiance(range, &normals, lighting),
            (Form::Fast | Form::Skip, Some(rays)) => {
                self.lamps.shadows_left = shadow_share(frame);
                let each = self.lamps.shadows_left / lighting.lamps.len() as f64;
                let unseen = lamp::irradiance_of(&self.prepared.scene.radiance, each);
                lamp::shaded_irradiance(range, &normals, needed, (rays, unseen))
            }
        };
        let reflectance = &self.prepared.scene.radiance;
        let lit = match self.lit.take() {
            Some(daylit) => daylight::with_lamps(daylit, reflectance, &irradiance.light),
            None => lamp::lit(reflectance, gain, &irradiance.light),
        };
        self.lamps.surface_rounding = lamp::lit_rounding(reflectance, &lit, irradiance.rounding);
        self.shines = any_light(&irradiance.light);
        self.lit = Some(lit);
    }

    /// Adds the glow of the water before the lamps.
    fn add_glow(&mut self, frame: &Frame, lighting: &Lighting, range: &Plane<f32>, rays: Option<&dyn Rays>) {
        let lighting = (self.casting.as_ref()).map_or(lighting, |casting| &casting.in_glow);
        let rays = rays.filter(|_| lighting.lamps.iter().any(Lamp::casts_into_water));
        let glow = match (Form::asked_by(frame.fidelity), rays) {
            (Form::Reference, rays) => {
                let range = range.map(|&z| f64::from(z));
                let light = match rays {
                    Some(rays) => lamp::shaded_airlight_reference(&range, lighting, REFERENCE_NODES, rays),
                    None => lamp::airlight_reference(&range, lighting, REFERENCE_NODES),
                };
                Airlight {
                    light: light.map(|&v| v as f32),
                    left: 0.0,
                    rounding: 0.0,
                }
            }
            (Form::Fast | Form::Skip, None) => lamp::airlight(range, lighting, glow_share(frame)),
            (Form::Fast | Form::Skip, Some(rays)) => {
                lamp::shaded_airlight(range, lighting, glow_share(frame), rays)
            }
        };
        self.lamps.glow_left = glow.left;
        self.lamps.glow_rounding = glow.rounding;
        self.lamps.glow_peak = glow.peak();
        self.glow = Some(glow.light);
    }

    /// What a plan needs to know of it.
    pub(crate) fn measure(&self, setting: &Setting) -> SceneStats {
        match (&setting.around, self.path()) {
            (Some(water), Some(path)) => SceneStats::measure(self.radiance(), path, water),
            _ => SceneStats::in_air(self.radiance()),
        }
    }

    /// Mean, least and greatest path as a share of the range; none in even water or in a frame of holes.
    pub(crate) fn factors(&self) -> Option<[f64; 3]> {
        let (path, range) = (self.patchy.as_ref()?, self.prepared.scene.range.as_ref()?);
        let pairs = path.data().iter().zip(range.data());
        let factors = pairs
            .filter(|(_, z)| !is_hole(**z))
            .map(|(path, z)| f64::from(*path) / f64::from(*z));
        let (mut count, mut sum, mut least, mut most) = (0.0, 0.0, f64::INFINITY, 0.0f64);
        for factor in factors {
            (count, sum) = (count + 1.0, sum + factor);
            (least, most) = (least.min(factor), most.max(factor));
        }
        (count > 0.0).then(|| [sum / count, least, most])
    }
}

/// What the shadows of lamps ask; none where no lamp is to cast one.
pub(crate) fn casting_rays<'a>(
    frame: &Frame,
    prepared: &'a Prepared,
    setting: &Setting,
) -> Option<Box<dyn Rays + Sync + 'a>> {
    let lighting = setting.lighting.as_ref()?;
    let casts = lighting.lamps.iter().any(|lamp| lamp.shadow() != Shadow::None);
    casts.then(|| rays::scene_rays(frame, prepared)).flatten()
}

/// Whether any sample is positive.
fn any_light(light: &Rgb<f32>) -> bool {
    light
        .planes()
        .iter()
        .any(|plane| plane.data().iter().any(|&v| v > 0.0))
}

/// The paths through patches of murkier water; none in even water.
fn path(form: Form, frame: &Frame, range: &Plane<f32>, setting: &Setting) -> Option<Plane<f32>> {
    let (water, field, eye) = (setting.water.as_ref()?, setting.patches.as_ref()?, &setting.eye);
    Some(match (form, &frame.water.turbidity) {
        (Form::Reference, Some(patches)) => {
            let range = range.map(|&z| f64::from(z));
            turbidity::optical_path_reference(&range, patches, field, eye, water.holes()).map(|&t| t as f32)
        }
        _ => turbidity::optical_path(range, field, eye, water.holes()),
    })
}
