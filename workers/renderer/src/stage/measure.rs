//! Image quality of the result and of each enhancement, the latter measured before its mask is applied.

use std::borrow::Cow;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::Arc;

use enhance::mask::black_out;
use imaging::{Plane, Raster, Rgb, Rgb8, transfer};
use optics::chain::Layers;
use quality::{
    CameraMotion, FrameFeatures, Illumination, MetricId, Needs, PreviousFrame, RelativePose, Sequence,
    Subject, TrueLight,
};
use spec::{Enhancement, FrameRecord, METRIC_NETWORK, MetricsOver};

use super::enhance::{Enhancements, complete};
use super::networks::{PictureNetworks, split_networks};
use crate::context::FrameContext;
use crate::error::RenderError;
use crate::sequence::{Held, Track};

/// Weights of red, green and blue in linear luminance (Rec. 709).
const LUMINANCE: [f32; 3] = [0.2126, 0.7152, 0.0722];

/// The pictures of a frame, and the inputs of comparisons.
pub(crate) struct Measured<'a> {
    pub(crate) layers: &'a Layers,
    pub(crate) rgb: &'a Rgb8,
    pub(crate) enhancements: &'a Enhancements,
    /// The last pictures of the path, if a metric compares with them.
    pub(crate) track: Option<&'a Track>,
}

/// Measures `rgb` and every enhancement.
pub(crate) fn run(
    context: &FrameContext<'_>,
    measured: &Measured<'_>,
    networks: &mut PictureNetworks,
    record: &mut FrameRecord,
) -> Result<(), RenderError> {
    let (registered, metric_networks) = split_networks(&context.frame.metrics);
    let metrics = registered.into_iter().map(parse);
    let metrics = metrics.collect::<Result<Vec<_>, _>>()?;
    if metrics.is_empty() && metric_networks.is_empty() {
        return Ok(());
    }
    let needs = |needs: Needs| metrics.iter().any(|metric| metric.info().needs == needs);
    let measure = Measure {
        clean: needs(Needs::PictureInAir)
            .then(|| transfer::encode_rgb8(&context.view(&context.prepared.scene.radiance)).0),
        light: needs(Needs::Illumination).then(|| SceneLight::new(context, measured)),
        context,
        measured,
        metrics,
        metric_networks,
        networks: RefCell::new(networks),
    };
    measure.add(None, measured.rgb, None, record)?;
    for enhancement in &context.frame.enhance {
        if let Some(outcome) = measured.enhancements.get(&enhancement.name) {
            let mask = outcome.mask.as_ref();
            let mask = mask.filter(|_| enhancement.metrics_over == MetricsOver::Mask);
            measure.add(Some(enhancement), &outcome.unmasked.to_rgb8(), mask, record)?;
        }
    }
    Ok(())
}

/// The metrics of a frame.
struct Measure<'a> {
    context: &'a FrameContext<'a>,
    measured: &'a Measured<'a>,
    metrics: Vec<MetricId>,
    /// Names of networks that measure.
    metric_networks: Vec<&'a str>,
    /// Runs one network at a time.
    networks: RefCell<&'a mut PictureNetworks>,
    clean: Option<Rgb8>,
    light: Option<SceneLight>,
}

impl Measure<'_> {
    /// Measures the picture of an enhancement, or `rgb` itself, and adds the values to the record.
    fn add(
        &self,
        of: Option<&Enhancement>,
        picture: &Rgb8,
        mask: Option<&Plane<u8>>,
        record: &mut FrameRecord,
    ) -> Result<(), RenderError> {
        let light = self.light.as_ref();
        let in_mask = light
            .zip(mask)
            .map(|(light, mask)| light.within(self.measured.rgb, mask));
        let subject = Subject {
            clean: self.clean.as_ref(),
            mask,
            illumination: in_mask.as_ref().or(light.map(|light| &light.whole)),
            ..Subject::new(picture)
        };
        let values = match self.measured.track {
            None => quality::measure_subject(&subject, &self.metrics)?,
            Some(track) => {
                let features = self.find_features(track, of, picture, mask)?;
                self.measure_along(track, &features, subject)?
            }
        };
        let values = values
            .into_iter()
            .map(|(metric, value)| (metric.to_string(), value));
        let mut values: BTreeMap<_, _> = values.collect();
        values.extend(self.run_metric_networks(picture, mask)?);
        let name = of.map_or("rgb", |enhancement| &enhancement.name);
        record.measurements.insert(name.to_owned(), values);
        Ok(())
    }

    /// The values of the metric networks, for which pixels outside the mask are black.
    fn run_metric_networks(
        &self,
        picture: &Rgb8,
        mask: Option<&Plane<u8>>,
    ) -> Result<Vec<(String, f64)>, RenderError> {
        let mut picture = Cow::Borrowed(picture);
        if let Some(mask) = mask.filter(|_| !self.metric_networks.is_empty()) {
            black_out(picture.to_mut().data_mut(), 3, mask);
        }
        let mut networks = self.networks.borrow_mut();
        let values = self.metric_networks.iter().map(|name| {
            let value = networks.measure(name, &picture)?;
            // Adding 0 turns -0 into +0.
            Ok((format!("{METRIC_NETWORK}{name}"), value + 0.0))
        });
        values.collect()
    }

    /// The features of a picture and of the previous ones, which are enhanced in the same way.
    fn find_features(
        &self,
        track: &Track,
        of: Option<&Enhancement>,
        picture: &Rgb8,
        mask: Option<&Plane<u8>>,
    ) -> Result<Vec<Arc<FrameFeatures>>, RenderError> {
        let Some((own, previous)) = track.pictures.split_first() else {
            return Ok(Vec::new());
        };
        let mut features = vec![own.find_features(of, picture, mask)];
        for held in previous {
            features.push(match held.features(of) {
                Some(known) => known,
                None => self.find_previous(held, of)?,
            });
        }
        Ok(features)
    }

    fn find_previous(
        &self,
        held: &Held,
        of: Option<&Enhancement>,
    ) -> Result<Arc<FrameFeatures>, RenderError> {
        let Some(enhancement) = of else {
            return Ok(held.find_features(None, &held.rgb, None));
        };
        let picture = Raster::from(held.rgb.clone());
        let enhancement_of_plan = complete(self.context, enhancement);
        let outcome = self
            .networks
            .borrow_mut()
            .enhance(&enhancement_of_plan, &picture, &[])?;
        let mask = outcome.mask.as_ref();
        let mask = mask.filter(|_| enhancement.metrics_over == MetricsOver::Mask);
        Ok(held.find_features(of, &outcome.unmasked.to_rgb8(), mask))
    }

    fn measure_along(
        &self,
        track: &Track,
        features: &[Arc<FrameFeatures>],
        subject: Subject<'_>,
    ) -> Result<Vec<(MetricId, f64)>, RenderError> {
        let [own, earlier @ ..] = features else {
            return Ok(quality::measure_subject(&subject, &self.metrics)?);
        };
        let motions = track.motions(features);
        let previous = earlier.iter().zip(&motions);
        let previous: Vec<_> = previous
            .map(|(features, motion)| PreviousFrame { features, motion })
            .collect();
        let current_ray = |x: f64, y: f64| track.ray(0, x, y);
        let previous_ray = |x: f64, y: f64| track.ray(1, x, y);
        let pose = track.pictures.get(1).map(|newest| {
            let pose = newest.viewpoint.relative_to(&track.pictures[0].viewpoint);
            RelativePose {
                rotation: pose.rotation,
                translation: pose.translation_m.into(),
            }
        });
        let frame = self.context.frame;
        let sequence = Sequence {
            features: own,
            previous: &previous,
            camera: pose.map(|pose| CameraMotion {
                current: &current_ray,
                previous: &previous_ray,
                pose,
                pixel_rad: track.pixel_rad(),
                seed: frame.seed ^ frame.index.rotate_left(32),
            }),
        };
        let subject = Subject {
            sequence: Some(&sequence),
            ..subject
        };
        Ok(quality::measure_subject(&subject, &self.metrics)?)
    }
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
    /// Prepared for pictures without a mask.
    whole: Illumination,
}

impl SceneLight {
    /// The illumination is that of a white surface at each pixel, lamps and daylight times transmittance: unscattered light
    /// over the scene in air. It is NaN where the scene is black in a channel.
    fn new(context: &FrameContext<'_>, measured: &Measured<'_>) -> Self {
        let direct = context.view(&measured.layers.direct);
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
        let reflectance = luminance(&in_air);
        let whole = Illumination::new(&TrueLight {
            illumination: &illumination,
            reflectance: &reflectance,
            input: measured.rgb,
            mask: None,
        });
        Self {
            illumination,
            reflectance,
            whole,
        }
    }

    fn within(&self, input: &Rgb8, mask: &Plane<u8>) -> Illumination {
        Illumination::new(&TrueLight {
            illumination: &self.illumination,
            reflectance: &self.reflectance,
            input,
            mask: Some(mask),
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
