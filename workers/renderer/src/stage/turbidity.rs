//! Patches of murkier water: the length of each pixel's path through water of the mean.

use imaging::Plane;
use imaging::geometry::Intrinsics;
use optics::eye::Eye;
use optics::range::is_hole;
use optics::snow::World;
use optics::turbidity::{self, Field};
use optics::water::Water;
use spec::{Fidelity, Frame};

use super::scene::Prepared;
use crate::error::RenderError;

/// Patchy water before a camera.
pub(crate) struct Patches {
    /// Metres of mean water before each pixel; takes the place of the range in the water.
    pub(crate) path: Plane<f32>,
    /// The field in the camera's axes.
    pub(crate) field: Field,
}

impl Patches {
    /// Mean, least and greatest path as a share of the range; none in a frame of holes.
    pub(crate) fn factors(&self, range: &Plane<f32>) -> Option<[f64; 3]> {
        let pairs = self.path.data().iter().zip(range.data());
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

/// The camera of a frame at its place; of a scene without a place, at the origin.
pub(crate) fn eye(prepared: &Prepared) -> Eye {
    let (width, height) = prepared.scene.radiance.size();
    let centred = || Intrinsics::centered(prepared.focal_px, width, height);
    let still = Eye::at_origin(prepared.scene.intrinsics.unwrap_or_else(centred));
    match prepared.pose {
        None => still,
        Some(pose) => Eye {
            world_from_camera: pose.world_from_camera(),
            ..still
        },
    }
}

/// Where the particles and patches of a frame come from.
pub(crate) fn world(frame: &Frame) -> World {
    World {
        seed: frame.seed,
        index: frame.world_index(),
    }
}

/// The patches of a frame; none in even water, without water or without range.
pub(crate) fn patches(
    frame: &Frame,
    prepared: &Prepared,
    water: Option<&Water>,
) -> Result<Option<Patches>, RenderError> {
    let given = frame.water.turbidity.filter(|patches| patches.contrast > 0.0);
    let (Some(patches), Some(water), Some(range)) = (given, water, &prepared.scene.range) else {
        return Ok(None);
    };
    let beyond = spec::beyond(&patches);
    if !beyond.is_empty() {
        let what = "turbidity";
        return Err(RenderError::Beyond { what, beyond });
    }
    let eye = eye(prepared);
    let field = Field::new(&patches, world(frame));
    let path = match frame.fidelity {
        Fidelity::REFERENCE => {
            let range = range.map(|&z| f64::from(z));
            turbidity::optical_path_reference(&range, &patches, &field, &eye, water.holes())
                .map(|&t| t as f32)
        }
        _ => turbidity::optical_path(range, &field, &eye, water.holes()),
    };
    Ok(Some(Patches {
        path,
        field: field.seen_from(&eye),
    }))
}
