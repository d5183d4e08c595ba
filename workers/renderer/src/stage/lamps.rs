//! Lamps in the water: their light on the surfaces, and the glow of the water before them.

use imaging::Rgb;
use imaging::geometry::Intrinsics;
use optics::chain::Layers;
use optics::lamp::{self, LAMP_RADIUS_M, Lamp, Lighting, REFERENCE_NODES};
use optics::water::Water;
use spec::{Fidelity, Frame};

use super::scene::Prepared;
use super::turbidity::Patches;
use crate::error::RenderError;

/// The lamps of a frame; `None` without lamps or without range, where they have nothing to shine on.
pub(crate) fn lighting(
    frame: &Frame,
    prepared: &Prepared,
    water: Option<&Water>,
    patches: Option<&Patches>,
) -> Result<Option<Lighting>, RenderError> {
    let lamps = Lamp::among(&frame.lights).map_err(|beyond| RenderError::Beyond {
        what: "lights",
        beyond,
    })?;
    let Some(range) = prepared.scene.range.as_ref().filter(|_| !lamps.is_empty()) else {
        return Ok(None);
    };
    let (width, height) = range.size();
    let camera = Intrinsics::centered(prepared.focal_px, width, height);
    Ok(Some(Lighting {
        lamps,
        radius_m: LAMP_RADIUS_M,
        camera: prepared.scene.intrinsics.unwrap_or(camera),
        attenuation: water.map_or([0.0; 3], Water::direct_attenuation),
        scattering: water.and_then(Water::scattering).unwrap_or([0.0; 3]),
        asymmetry: water.map_or(0.0, |water| lamp::asymmetry_of(water.backscatter_fraction())),
        patches: patches.map(|patches| patches.field),
    }))
}

/// The scene as the light around and the lamps show it, and whether a lamp lights any of it. Its radiance in air stands for its
/// reflectance.
pub(crate) fn surfaces(
    prepared: &Prepared,
    lighting: &Lighting,
    water: Option<&Water>,
) -> Option<(Rgb<f32>, bool)> {
    let range = prepared.scene.range.as_ref()?;
    let normals = lamp::normals_of(range, &lighting.camera);
    let irradiance = lamp::irradiance(range, &normals, lighting);
    let gain = water.map_or([1.0; 3], Water::radiance_gain);
    let shines = any_light(&irradiance);
    Some((lamp::lit(&prepared.scene.radiance, gain, &irradiance), shines))
}

/// Adds the glow of the water to the picture and to its backscatter, with an error below `share`; says whether there is any.
pub(crate) fn glow(
    frame: &Frame,
    prepared: &Prepared,
    lighting: &Lighting,
    share: f64,
    layers: &mut Layers,
) -> bool {
    let Some(range) = prepared.scene.range.as_ref() else {
        return false;
    };
    let glow = match frame.fidelity {
        Fidelity::REFERENCE => {
            lamp::airlight_reference(&range.map(|&z| f64::from(z)), lighting, REFERENCE_NODES)
                .map(|&v| v as f32)
        }
        _ => lamp::airlight(range, lighting, share),
    };
    for layer in [&mut layers.backscatter, &mut layers.scattered] {
        for (plane, glow) in layer.planes_mut().into_iter().zip(glow.planes()) {
            plane
                .iter_mut()
                .zip(glow.data())
                .for_each(|(sum, glow)| *sum += glow);
        }
    }
    any_light(&glow)
}

fn any_light(light: &Rgb<f32>) -> bool {
    light
        .planes()
        .iter()
        .any(|plane| plane.data().iter().any(|&v| v > 0.0))
}
