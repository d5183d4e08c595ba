//! Light from above on surfaces.

use std::borrow::Cow;

use imaging::{Plane, Rgb};
use optics::daylight::{self, Daylight, Reaching};
use optics::lamp;
use optics::plan::{Above, Form};
use optics::range::{farthest, of_surfaces};
use optics::setting::Setting;
use spec::{Frame, SurfaceLight};

use super::scene::Prepared;

/// A scene in the light from above, and how it was computed; none where it falls on no surface.
pub(crate) fn light(
    frame: &Frame,
    prepared: &Prepared,
    setting: &Setting,
    range: &Plane<f32>,
) -> Option<(Rgb<f32>, Above)> {
    let water = setting.water.as_ref()?;
    let daylight = water.daylight()?;
    if daylight.surfaces() == SurfaceLight::None {
        return None;
    }
    let scene = &prepared.scene.radiance;
    let range = &*of_surfaces(range, water.holes());
    let farthest = farthest(range).unwrap_or(0.0);
    let brightest = scene.planes().each_ref().map(|plane| {
        let samples = plane.data().iter();
        samples.fold(0.0f32, |most, &sample| most.max(sample))
    });
    let mut above = Above::choose(frame, setting, brightest, farthest, false)?;
    let normals = normals(prepared, range, setting, daylight);
    let reaching = Reaching::default();
    if above.surfaces.form == Form::Reference {
        let exact = daylight::surfaces_reference(
            &scene.map(|&v| f64::from(v)),
            &range.map(|&z| f64::from(z)),
            &normals.each_ref().map(|axis| axis.map(|&v| f64::from(v))),
            daylight,
            reaching,
        );
        return Some((exact.map(|&v| v as f32), above));
    }
    let lit = daylight::surfaces(scene, range, &normals, daylight, reaching);
    above.surfaces.bound = Some(daylight::surfaces_rounding(daylight, &lit, farthest));
    Some((lit, above))
}

/// Those of the scene, or of its range; none where daylight does not go by them.
fn normals<'a>(
    prepared: &'a Prepared,
    range: &Plane<f32>,
    setting: &Setting,
    daylight: &Daylight,
) -> Cow<'a, [Plane<f32>; 3]> {
    match &prepared.scene.normals {
        _ if daylight.surfaces() != SurfaceLight::Normal => {
            Cow::Owned([(); 3].map(|()| Plane::filled(0, 0, 0.0)))
        }
        Some(normals) => Cow::Borrowed(normals),
        None => Cow::Owned(lamp::normals_of(range, &setting.eye.camera)),
    }
}
