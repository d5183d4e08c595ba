//! Builds the Monte Carlo scene of a job's frame.

use std::ops::Range;

use imaging::geometry::Intrinsics;
use imaging::random::Stream;
use imaging::rays::Rays;
use imaging::vector::vec3;
use imaging::{Plane, Rgb};
use optics::daylight::SurfaceLight;
use optics::setting::Setting;
use optics::water::Water;
use spec::Frame;

use crate::dice::Address;
use crate::estimate::PixelSums;
use crate::lamp::SphereLamp;
use crate::phase::Phase;
use crate::scene::{Along, TracedScene};
use crate::sea::Sea;
use crate::surface::{PictureSurfaces, SurfaceMaterials};
use crate::water::{TurbidityField, WaterCoefficients};

/// A frame without a truth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NoTruth {
    /// Without absorption and scattering there is no transfer.
    #[error(
        "water.optics: the scattering of the water is not known, give absorption_per_m and scattering_per_m"
    )]
    NoScattering,
    /// The scattering exceeds the attenuation.
    #[error("water.optics: scattering exceeds beam attenuation")]
    MoreScatteredThanLost,
    /// Clouds of sediment are not traced.
    #[error("water.sediment: clouds are not traced")]
    Clouds,
    /// The irradiance at the surface overflows.
    #[error(
        "water.depth_m: so little daylight is left that the irradiance at the surface is beyond all numbers"
    )]
    TooDeep,
}

/// Input of a traced frame.
#[derive(Debug, Clone, Copy)]
pub struct Subject<'a> {
    /// Its description.
    pub frame: &'a Frame,
    /// Its surroundings.
    pub setting: &'a Setting,
    /// Linear radiance in air.
    pub radiance: &'a Rgb<f32>,
    /// Range, m.
    pub range: &'a Plane<f32>,
    /// Reflectance of the ground, object 0 of the rays; `None` if it is not known.
    pub ground: Option<[f64; 3]>,
}

impl<'a> TracedScene<'a> {
    /// The scene of a frame. Its picture in air emits its radiance and, with lamps, reflects their light by the same
    /// factor, limited to one. A scene of reflectance under daylight is below a flat sea with a uniform sky and its sun;
    /// their light in the water is traced, too. Otherwise daylight's veil is not included. Snow, style, haze and camera
    /// are never included.
    ///
    /// # Errors
    /// [`NoTruth`].
    pub fn of_frame(
        subject: &Subject<'a>,
        rays: &'a (dyn Rays + Sync),
        phase: Phase,
    ) -> Result<Self, NoTruth> {
        let setting = subject.setting;
        if setting.sediment.is_some() {
            return Err(NoTruth::Clouds);
        }
        let sea = sea(setting)?;
        let water = setting.water.as_ref().map_or(Ok([NOTHING; 3]), coefficients)?;
        let lamps = if setting.lighting.is_some() {
            SphereLamp::among(&subject.frame.lights)
        } else {
            Vec::new()
        };
        let patches = setting
            .patches
            .as_ref()
            .map(|field| field.seen_from(&setting.eye));
        let mut picture = PictureSurfaces::new(
            subject.radiance,
            subject.range,
            setting.eye.camera,
            if sea.is_some() { [0.0; 3] } else { setting.gain() },
            !lamps.is_empty() || sea.is_some(),
        );
        picture.ground = subject.ground.filter(|_| sea.is_some());
        Ok(Self {
            rays,
            surfaces: SurfaceMaterials::Picture(picture),
            lamps,
            sea,
            water,
            phase,
            turbidity: patches.map_or(TurbidityField::Even, |field| {
                TurbidityField::Patches(Box::new(field))
            }),
        })
    }
}

/// The sea over surfaces with daylight; `None` without. Its surface is calm: waves redistribute sunlight, but their
/// mean over the picture is that of a calm sea.
fn sea(setting: &Setting) -> Result<Option<Sea>, NoTruth> {
    let Some(daylight) = setting.water.as_ref().and_then(Water::daylight) else {
        return Ok(None);
    };
    match daylight.surfaces() {
        SurfaceLight::None => Ok(None),
        SurfaceLight::Normal => Sea::of_daylight(daylight).ok_or(NoTruth::TooDeep).map(Some),
    }
}

const NOTHING: WaterCoefficients = WaterCoefficients {
    absorption: 0.0,
    scattering: 0.0,
};

fn coefficients(water: &Water) -> Result<[WaterCoefficients; 3], NoTruth> {
    let scattering = water.scattering().ok_or(NoTruth::NoScattering)?;
    let attenuation = water.direct_attenuation();
    if (0..3).any(|i| scattering[i] > attenuation[i] * (1.0 + 1e-9)) {
        return Err(NoTruth::MoreScatteredThanLost);
    }
    Ok([0, 1, 2].map(|i| WaterCoefficients {
        absorption: (attenuation[i] - scattering[i]).max(0.0),
        scattering: scattering[i],
    }))
}

/// Parameters of the paths of a frame.
#[derive(Debug, Clone, Copy)]
pub struct PathBatch {
    /// The camera.
    pub camera: Intrinsics,
    /// Columns of the frame.
    pub width: usize,
    /// Frame number.
    pub frame: u64,
    /// Random numbers.
    pub stream: Stream,
}

impl PathBatch {
    /// Traces samples of some pixels, in the order of their numbers.
    #[must_use]
    pub fn trace(
        &self,
        scene: &TracedScene<'_>,
        pixels: Range<usize>,
        samples: &Range<u64>,
    ) -> Vec<PixelSums> {
        let is_shared = scene.has_similar_channels();
        let traced = pixels.map(|number| {
            let ray = self
                .camera
                .ray((number % self.width) as f64, (number / self.width) as f64);
            let along = Along {
                origin: vec3(0.0, 0.0, 0.0),
                direction: ray.normalized(),
            };
            let address = Address {
                frame: self.frame,
                pixel: number as u64,
                sample: 0,
                channel: 0,
            };
            PixelSums::trace(scene, along, self.stream, address, samples.clone(), is_shared)
        });
        traced.collect()
    }
}
