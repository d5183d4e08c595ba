//! The brightest light of lamps on particles in view.

use super::Lighting;
use crate::visible_bounds::VisibleBounds;

/// Upper bound of the light of visible white particles at this range or farther: `I₀ e^{−c r}/(π r²)` at the least distance r of a
/// lamp from the visible water, the same for R, G and B.
#[must_use]
pub fn most_white_beyond(lighting: &Lighting, view: &VisibleBounds, near_m: f64) -> [f64; 3] {
    let lamps = lighting.lamps.iter().map(|lamp| {
        let place = lamp.position_m();
        let regions = view.water_beyond(near_m);
        let nearest = regions.map(|region| region.places.distances(place)[0]);
        lamp.most_light(lighting, nearest.fold(f64::INFINITY, f64::min))
    });
    [lamps.sum::<f64>() / std::f64::consts::PI; 3]
}
