//! Marine snow over the picture after the water.

use imaging::Plane;
use optics::chain::Layers;
use optics::lamp;
use optics::plan::{Form, Plan};
use optics::setting::Setting;
use optics::snow::{self, Surround};
use serde_json::{Value, json};

use super::scene::Prepared;

/// What fell.
pub(crate) struct Fallen {
    /// Particles whose discs reach into the frame.
    particles: usize,
    /// Opacity of each pixel; none where nothing was drawn.
    mask: Option<Plane<f32>>,
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
    prepared: &Prepared,
    setting: &Setting,
    plan: &Plan,
    layers: &mut Layers,
) -> Option<Fallen> {
    let (law, range) = (setting.snow.as_ref()?, prepared.scene.range.as_ref()?);
    if plan.snow.form == Form::Skip {
        return Some(Fallen {
            particles: 0,
            mask: None,
        });
    }
    let (eye, gain) = (&setting.eye, setting.gain());
    let patches = setting.patches.map(|field| field.seen_from(eye));
    let path = |place: [f64; 3], metres: f64| match &patches {
        Some(field) => field.path_m(place.map(|v| v / metres), metres),
        None => metres,
    };
    let light = |place: [f64; 3]| match &setting.lighting {
        Some(lighting) => {
            let lamps = lamp::white_at(place, lighting);
            [0, 1, 2].map(|i| gain[i] + lamps[i])
        }
        None => gain,
    };
    let surround = Surround {
        range,
        eye,
        attenuation: setting.attenuation(),
        path: &path,
        light: &light,
    };
    let found = snow::flakes(eye, law, setting.world, range.size());
    let picture = &mut layers.scattered;
    let mask = if plan.snow.form == Form::Reference {
        let exact = snow::snow_reference(&picture.map(|&v| f64::from(v)), &found, law.albedo, &surround);
        *picture = exact.0.map(|&v| v as f32);
        exact.1.map(|&v| v as f32)
    } else {
        snow::snow(
            picture,
            &found,
            law.albedo,
            &surround,
            plan.snow.share.unwrap_or_default(),
        )
    };
    Some(Fallen {
        particles: found.len(),
        mask: Some(mask),
    })
}

/// The mask as codes: 255 is opaque; a frame where nothing was drawn has a mask of 0.
pub(crate) fn codes(fallen: Option<&Fallen>, (width, height): (usize, usize)) -> Plane<u8> {
    match fallen.and_then(|fallen| fallen.mask.as_ref()) {
        Some(mask) => mask.map(|&v| (255.0 * v.clamp(0.0, 1.0)).round() as u8),
        None => Plane::filled(width, height, 0),
    }
}
