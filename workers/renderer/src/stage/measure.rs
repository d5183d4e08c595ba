//! Image quality of the result and of each enhancement, the latter measured before its mask is applied.

use imaging::{Plane, Rgb, Rgb8, transfer};
use optics::chain::Layers;
use quality::{Illumination, MetricId, Needs, Subject, TrueLight};
use spec::{Enhancement, FrameRecord, MetricsOver};

use super::enhance::Enhancements;
use crate::context::FrameContext;
use crate::error::RenderError;

/// Weights of red, green and blue in linear luminance (Rec. 709).
const LUMINANCE: [f32; 3] = [0.2126, 0.7152, 0.0722];

/// Measures `rgb` and every enhancement.
pub(crate) fn run(
    context: &FrameContext<'_>,
    layers: &Layers,
    rgb: &Rgb8,
    enhancements: &Enhancements,
    record: &mut FrameRecord,
) -> Result<(), RenderError> {
    let metrics = context.frame.metrics.iter().map(|name| parse(name));
    let metrics = metrics.collect::<Result<Vec<_>, _>>()?;
    if metrics.is_empty() {
        return Ok(());
    }
    let needs = |needs: Needs| metrics.iter().any(|metric| metric.info().needs == needs);
    let clean = needs(Needs::PictureInAir)
        .then(|| transfer::encode_rgb8(&context.view(&context.prepared.scene.radiance)).0);
    let light = needs(Needs::Illumination).then(|| SceneLight::new(context, layers));
    let mut measure = |name: &str, picture: &Rgb8, mask: Option<&Plane<u8>>| {
        let illumination = light.as_ref().map(|light| light.seen_in(rgb, mask));
        let subject = Subject {
            clean: clean.as_ref(),
            mask,
            illumination: illumination.as_ref(),
            ..Subject::new(picture)
        };
        let values = quality::measure_subject(&subject, &metrics)?;
        let values = values
            .into_iter()
            .map(|(metric, value)| (metric.to_string(), value));
        record.measurements.insert(name.to_owned(), values.collect());
        Ok::<_, RenderError>(())
    };
    measure("rgb", rgb, None)?;
    for Enhancement {
        name, metrics_over, ..
    } in &context.frame.enhance
    {
        if let Some(outcome) = enhancements.get(name) {
            let mask = outcome.mask.as_ref();
            let mask = mask.filter(|_| *metrics_over == MetricsOver::Mask);
            measure(name, &outcome.unmasked.to_rgb8(), mask)?;
        }
    }
    Ok(())
}

fn parse(name: &str) -> Result<MetricId, RenderError> {
    MetricId::parse(name).ok_or_else(|| RenderError::Unknown {
        kind: "metric",
        name: name.to_owned(),
    })
}

/// The true light of a frame in the geometry of its picture.
struct SceneLight {
    illumination: Plane<f32>,
    reflectance: Plane<f32>,
}

impl SceneLight {
    /// The illumination is that of a white surface at each pixel, lamps and daylight times transmittance: unscattered light
    /// over the scene in air. It is NaN where the scene is black in a channel.
    fn new(context: &FrameContext<'_>, layers: &Layers) -> Self {
        let direct = context.view(&layers.direct);
        let in_air = context.view(&context.prepared.scene.radiance);
        let mut white = [0, 1, 2].map(|channel| {
            let mut gains = direct.planes()[channel].clone();
            let surfaces = in_air.planes()[channel].data();
            for (gain, &surface) in gains.data_mut().iter_mut().zip(surfaces) {
                *gain = if surface > 0.0 { *gain / surface } else { f32::NAN };
            }
            gains
        });
        let [red, green, blue] = &mut white;
        weigh([red.data_mut(), green.data_mut(), blue.data_mut()]);
        let [illumination, ..] = white;
        Self {
            illumination,
            reflectance: luminance(&in_air),
        }
    }

    fn seen_in(&self, input: &Rgb8, mask: Option<&Plane<u8>>) -> Illumination {
        Illumination::new(&TrueLight {
            illumination: &self.illumination,
            reflectance: &self.reflectance,
            input,
            mask,
        })
    }
}

fn luminance(picture: &Rgb<f32>) -> Plane<f32> {
    let [mut red, mut green, mut blue] = picture.planes().clone();
    weigh([red.data_mut(), green.data_mut(), blue.data_mut()]);
    red
}

/// Replaces red by the luminance.
fn weigh([red, green, blue]: [&mut [f32]; 3]) {
    for ((red, green), blue) in red.iter_mut().zip(green).zip(blue) {
        *red = LUMINANCE[0] * *red + LUMINANCE[1] * *green + LUMINANCE[2] * *blue;
    }
}
