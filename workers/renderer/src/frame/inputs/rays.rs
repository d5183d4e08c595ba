//! Occluders of light.

use imaging::rays::Rays;
use optics::Screen;
use optics::lamp::Shadow;
use optics::setting::Setting;
use optics::water::Water;
use spec::{Fidelity, Frame, RaySource};

use super::scene::Prepared;

/// The occluders that rays are tested against. A procedural scene without its world only has its range image.
pub(crate) fn source(frame: &Frame, prepared: &Prepared) -> RaySource {
    match (frame.ray_source(), &prepared.world, &prepared.pose) {
        (RaySource::Scene, Some(_), Some(_)) => RaySource::Scene,
        _ => RaySource::Screen,
    }
}

/// The solids of a procedural scene, or the range image of any other; `None` without range. In the camera coordinates of the scene.
pub(crate) fn scene_rays<'a>(frame: &Frame, prepared: &'a Prepared) -> Option<Box<dyn Rays + Sync + 'a>> {
    let range = prepared.scene.range.as_ref()?;
    Some(match (source(frame, prepared), &prepared.world, &prepared.pose) {
        (RaySource::Scene, Some(world), Some(pose)) => Box::new(world.rays(pose)),
        _ if frame.fidelity == Fidelity::Reference => {
            Box::new(Screen::reference(range, prepared.view().camera))
        }
        _ => Box::new(Screen::new(range, prepared.view().camera)),
    })
}

/// The same, if the sun or a lamp casts shadows or ambient occlusion is traced.
pub(crate) fn occluders<'a>(
    frame: &Frame,
    prepared: &'a Prepared,
    setting: &Setting,
) -> Option<Box<dyn Rays + Sync + 'a>> {
    let lamps = setting.lighting.iter().flat_map(|lighting| &lighting.lamps);
    let daylight = setting.water.as_ref().and_then(Water::daylight);
    let is_needed = lamps.into_iter().any(|lamp| lamp.shadow() != Shadow::None)
        || daylight.is_some_and(|light| light.traces_rays());
    is_needed.then(|| scene_rays(frame, prepared)).flatten()
}
