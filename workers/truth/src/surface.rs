//! Surface materials.

use imaging::geometry::Intrinsics;
use imaging::rays::Hit;
use imaging::vector::DVec3;
use imaging::{Plane, Rgb};
use optics::range::is_hole;

/// A point belongs to a pixel if its distance and the pixel's range agree to this share.
const SAME_PLACE: f64 = 0.03;

/// Lambertian at a point, by channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lambertian {
    /// Lambertian reflectance, 0..=1.
    pub reflectance: [f64; 3],
    /// Emitted radiance.
    pub emitted: [f64; 3],
}

impl Lambertian {
    /// Absorbs all light.
    pub const BLACK: Self = Self {
        reflectance: [0.0; 3],
        emitted: [0.0; 3],
    };

    /// Reflects without emission.
    #[must_use]
    pub fn gray(reflectance: f64) -> Self {
        Self {
            reflectance: [reflectance; 3],
            ..Self::BLACK
        }
    }

    /// A black surface that emits light.
    #[must_use]
    pub fn glowing(radiance: f64) -> Self {
        Self {
            emitted: [radiance; 3],
            ..Self::BLACK
        }
    }
}

/// The surfaces of a scene.
#[derive(Debug, Clone, PartialEq)]
pub enum SurfaceMaterials<'a> {
    /// One material per object number, from 0.
    ByObject(Vec<Lambertian>),
    /// Materials from the picture of a camera at the origin.
    Picture(PictureSurfaces<'a>),
}

/// A picture that defines materials.
#[derive(Debug, Clone, PartialEq)]
pub struct PictureSurfaces<'a> {
    /// Linear radiance in air, white = 1.
    pub radiance: &'a Rgb<f32>,
    /// Range of its pixels, m.
    pub range: &'a Plane<f32>,
    /// The camera.
    pub camera: Intrinsics,
    /// Factor on the emitted radiance, per channel.
    pub gain: [f64; 3],
    /// Whether lamps illuminate it, too: then the radiance, at most 1, is also the reflectance.
    pub reflects: bool,
    /// Reflectance of the ground, object 0, where the camera does not see it.
    pub ground: Option<[f64; 3]>,
    /// Mean material, for other points invisible to the camera.
    mean: [f64; 3],
}

impl<'a> PictureSurfaces<'a> {
    /// The surfaces of a picture with the range of its pixels.
    #[must_use]
    pub fn new(
        radiance: &'a Rgb<f32>,
        range: &'a Plane<f32>,
        camera: Intrinsics,
        gain: [f64; 3],
        reflects: bool,
    ) -> Self {
        let seen = range.data().iter().filter(|&&z| !is_hole(z)).count().max(1) as f64;
        let mean = radiance.planes().each_ref().map(|plane| {
            let lit = plane
                .data()
                .iter()
                .zip(range.data())
                .filter(|(_, z)| !is_hole(**z));
            lit.map(|(&j, _)| f64::from(j)).sum::<f64>() / seen
        });
        Self {
            radiance,
            range,
            camera,
            gain,
            reflects,
            ground: None,
            mean,
        }
    }

    fn material(&self, hit: &Hit, place: DVec3) -> Lambertian {
        let ground = self.ground.filter(|_| hit.object == 0);
        let hidden = ground.unwrap_or(self.mean);
        let air = self.pixel(place).map_or(hidden, |(x, y)| {
            self.radiance
                .planes()
                .each_ref()
                .map(|plane| f64::from(plane.pixel(x, y)))
        });
        Lambertian {
            reflectance: if self.reflects {
                air.map(|j| j.clamp(0.0, 1.0))
            } else {
                [0.0; 3]
            },
            emitted: [0, 1, 2].map(|i| air[i] * self.gain[i]),
        }
    }

    /// The pixel that shows a point.
    fn pixel(&self, place: DVec3) -> Option<(usize, usize)> {
        let (width, height) = self.range.size();
        let index = |offset: f64, center: f64, count: usize| {
            let position = (self.camera.focal_px * offset / place.z + center).round();
            (position >= 0.0 && position < count as f64).then_some(position as usize)
        };
        if place.z <= 0.0 {
            return None;
        }
        let x = index(place.x, self.camera.cx, width)?;
        let y = index(place.y, self.camera.cy, height)?;
        let (range, distance) = (f64::from(self.range.pixel(x, y)), place.length());
        ((range - distance).abs() <= SAME_PLACE * distance).then_some((x, y))
    }
}

impl SurfaceMaterials<'_> {
    /// The material at a hit point.
    #[must_use]
    pub fn material(&self, hit: &Hit, place: DVec3) -> Lambertian {
        match self {
            Self::ByObject(materials) => materials
                .get(hit.object as usize)
                .copied()
                .unwrap_or(Lambertian::BLACK),
            Self::Picture(picture) => picture.material(hit, place),
        }
    }
}
