//! Paths through turbid patches: closed forms of the range.

use imaging::Plane;
use optics::range::is_hole;
use optics::setting::Setting;
use optics::turbidity;
use spec::{Fidelity, Frame};

/// Mean, least and greatest path relative to the range; `None` without valid range.
pub(crate) fn measure_paths(path: &Plane<f32>, range: &Plane<f32>) -> Option<[f64; 3]> {
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

/// The paths; `None` in uniform water.
pub(crate) fn find_paths(frame: &Frame, range: &Plane<f32>, setting: &Setting) -> Option<Plane<f32>> {
    let (water, field, eye) = (setting.water.as_ref()?, setting.patches.as_ref()?, &setting.eye);
    Some(match (frame.fidelity, &frame.water.turbidity) {
        (Fidelity::Reference, Some(patches)) => {
            let range = range.map(|&z| f64::from(z));
            turbidity::optical_path_reference(&range, patches, field, eye, water.holes()).map(|&t| t as f32)
        }
        _ => turbidity::optical_path(range, field, eye, water.holes()),
    })
}
