//! From a frame's lamps to what the optics ask for.

use optics::lamp::{Lamp, LampError};

use crate::frame::Frame;

/// The lamps of a frame as the optics ask for them, in their order.
///
/// # Errors
/// What is wrong with them, such as a direction of length 0 that laws have yielded.
pub fn lamps(frame: &Frame) -> Result<Vec<Lamp>, Vec<LampError>> {
    let lamp = |lamp: &crate::frame::Lamp| match &lamp.beam {
        None => Lamp::point(lamp.position_m, lamp.intensity),
        Some(beam) => Lamp::spot(lamp.position_m, lamp.intensity, beam.direction, beam.cone_deg),
    };
    let (mut lamps, mut errors) = (Vec::new(), Vec::new());
    for lamp in frame.lamps.iter().map(lamp) {
        match lamp {
            Ok(lamp) => lamps.push(lamp),
            Err(wrong) => errors.extend(wrong),
        }
    }
    if errors.is_empty() { Ok(lamps) } else { Err(errors) }
}
