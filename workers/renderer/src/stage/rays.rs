//! What shadows ask whether something is in the way.

use imaging::rays::Rays;
use optics::Screen;
use optics::plan::Form;
use spec::{Frame, RaySource};

use super::scene::Prepared;

/// Where the surfaces come from that rays meet: never [`RaySource::Auto`].
pub(crate) fn source(frame: &Frame, prepared: &Prepared) -> RaySource {
    match (frame.ray_source(), &prepared.world, &prepared.pose) {
        (RaySource::Scene, Some(_), Some(_)) => RaySource::Scene,
        _ => RaySource::Screen,
    }
}

/// The solids of a procedural scene, or the range image of any; none without range. In the axes of the camera of the scene.
pub(crate) fn scene_rays<'a>(frame: &Frame, prepared: &'a Prepared) -> Option<Box<dyn Rays + Sync + 'a>> {
    let range = prepared.scene.range.as_ref()?;
    Some(match (source(frame, prepared), &prepared.world, &prepared.pose) {
        (RaySource::Scene, Some(world), Some(pose)) => Box::new(world.rays(pose)),
        _ if Form::asked_by(frame.fidelity) == Form::Reference => {
            Box::new(Screen::reference(range, prepared.view().camera))
        }
        _ => Box::new(Screen::new(range, prepared.view().camera)),
    })
}
