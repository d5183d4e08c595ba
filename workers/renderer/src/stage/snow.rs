//! Marine snow over the picture after the water.

use imaging::{Plane, Rgb};
use optics::chain::Layers;
use optics::lamp::{self, Lighting};
use optics::snow::{self, Surround};
use serde_json::{Value, json};
use spec::{Fidelity, Frame, Snow};

use super::scene::Prepared;
use super::turbidity::{eye, world};
use super::water::Chosen;
use crate::error::RenderError;

/// What fell.
pub(crate) struct Fallen {
    /// `skip`, `discs` or `reference`.
    pub(crate) variant: &'static str,
    /// Particles whose discs reach into the frame.
    particles: usize,
    /// Opacity of each pixel; none where nothing was drawn.
    pub(crate) mask: Option<Plane<f32>>,
}

impl Fallen {
    /// For the record: the particles, and the share of the frame that they cover.
    pub(crate) fn describe(&self) -> Value {
        let cover = self.mask.as_ref().map_or(0.0, |mask| {
            let sum: f64 = mask.data().iter().map(|&v| f64::from(v)).sum();
            sum / mask.data().len() as f64
        });
        json!({"particles": self.particles, "cover": cover})
    }
}

/// Lays the snow over the picture; none without snow or without range, in which nothing hangs anywhere.
pub(crate) fn run(
    frame: &Frame,
    prepared: &Prepared,
    chosen: &Chosen,
    lighting: Option<&Lighting>,
    layers: &mut Layers,
) -> Result<Option<Fallen>, RenderError> {
    let (Some(law), Some(range)) = (frame.water.snow, &prepared.scene.range) else {
        return Ok(None);
    };
    let (eye, size) = (eye(prepared), range.size());
    let mut beyond = snow::validate(&law);
    beyond.extend(snow::check_count(&law, snow::solid(&eye.camera, size)).err());
    if !beyond.is_empty() {
        return Err(RenderError::Beyond { what: "snow", beyond });
    }
    let water = chosen.water.as_ref();
    let attenuation = water.map_or([0.0; 3], optics::water::Water::direct_attenuation);
    let gain = water.map_or([1.0; 3], optics::water::Water::radiance_gain);
    let reference = frame.fidelity == Fidelity::REFERENCE;
    if !reference
        && needless(
            frame,
            chosen,
            lighting,
            &law,
            attenuation,
            gain,
            &layers.scattered,
        )
    {
        return Ok(Some(Fallen {
            variant: "skip",
            particles: 0,
            mask: None,
        }));
    }
    let path = |place: [f64; 3], metres: f64| match &chosen.patches {
        Some(patches) => patches.field.path_m(place.map(|v| v / metres), metres),
        None => metres,
    };
    let light = |place: [f64; 3]| match lighting {
        Some(lighting) => {
            let lamps = lamp::white_at(place, lighting);
            [0, 1, 2].map(|i| gain[i] + lamps[i])
        }
        None => gain,
    };
    let surround = Surround {
        range,
        eye: &eye,
        attenuation,
        path: &path,
        light: &light,
    };
    let found = snow::flakes(&eye, &law, world(frame), size);
    let picture = &mut layers.scattered;
    let mask = if reference {
        let exact = snow::snow_reference(&picture.map(|&v| f64::from(v)), &found, law.albedo, &surround);
        *picture = exact.0.map(|&v| v as f32);
        exact.1.map(|&v| v as f32)
    } else {
        snow::snow(picture, &found, law.albedo, &surround, chosen.shares.snow)
    };
    Ok(Some(Fallen {
        variant: if reference { "reference" } else { "discs" },
        particles: found.len(),
        mask: Some(mask),
    }))
}

/// Whether the snow may be left out.
fn needless(
    frame: &Frame,
    chosen: &Chosen,
    lighting: Option<&Lighting>,
    law: &Snow,
    attenuation: [f64; 3],
    gain: [f64; 3],
    picture: &Rgb<f32>,
) -> bool {
    // The clearest patch lets the most through.
    let clearest = 1.0 - frame.water.turbidity.map_or(0.0, |patches| patches.contrast);
    let least = attenuation.into_iter().fold(f64::INFINITY, f64::min) * clearest;
    let lamps = lighting.map_or([0.0; 3], lamp::most_white);
    let colors = [0, 1, 2].map(|i| law.albedo[i] * (gain[i] + lamps[i]));
    let behind = snow::brightest(picture).into_iter().fold(0.0, f32::max);
    let contrast = colors.into_iter().fold(f64::from(behind), f64::max);
    let pixels = picture.width() * picture.height();
    snow::is_needless(law, pixels, least, contrast, chosen.shares.snow)
}

/// The mask as codes: 255 is opaque; a frame where nothing was drawn has a mask of 0.
pub(crate) fn codes(fallen: Option<&Fallen>, (width, height): (usize, usize)) -> Plane<u8> {
    match fallen.and_then(|fallen| fallen.mask.as_ref()) {
        Some(mask) => mask.map(|&v| (255.0 * v.clamp(0.0, 1.0)).round() as u8),
        None => Plane::filled(width, height, 0),
    }
}
