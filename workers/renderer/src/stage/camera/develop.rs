//! From exposed light to the codes of the picture: sensor, white balance, tone and compression.

use std::borrow::Cow;

use ::camera::sensor::{self, Chance, Raw, SensorModel};
use ::camera::{balance, jpeg, mosaic, preset, tone};
use imaging::random::Stream;
use imaging::{Raster, Rgb, Rgb8, transfer};
use optics::plan::StageId;
use serde_json::{Value, json};
use spec::{Frame, FrameRecord, WhiteBalance};

use crate::context::FrameContext;
use crate::inputs::camera::Cameras;

/// The codes of a picture.
pub(crate) struct Developed {
    /// The result.
    pub(crate) rgb: Rgb8,
    /// The same in 16 bits, if the camera has them.
    pub(crate) deep: Option<Raster>,
    /// Number of clamped samples.
    pub(crate) clamped: u64,
    /// The codes of the sensor.
    pub(crate) raw: Option<Raw>,
    /// The gains of the white balance; `None` without one.
    pub(crate) balance: Option<[f64; 3]>,
}

/// The codes of exposed light.
pub(crate) fn develop(
    context: &FrameContext<'_>,
    light: &Rgb<f32>,
    cameras: &mut Cameras,
    record: &mut FrameRecord,
) -> Developed {
    let Some(taking) = &context.taking else {
        let (rgb, clamped) = match find_unchanged(context) {
            Some(codes) => (codes.clone(), 0),
            None => transfer::encode_rgb8(light),
        };
        return Developed {
            rgb,
            deep: None,
            clamped,
            raw: None,
            balance: None,
        };
    };
    let mut light = Cow::Borrowed(light);
    let mut raw = None;
    if let Some(sensor) = &taking.parts.sensor {
        let codes = read(context, sensor, &light, cameras);
        light = Cow::Owned(if context.runs_reference(StageId::Sensor) {
            mosaic::light_of_reference(&codes, sensor).map(|&v| v as f32)
        } else {
            mosaic::light_of(&codes, sensor)
        });
        note(record, "sensor", described(context, sensor));
        raw = Some(codes);
    }
    let law = taking.parts.balance.filter(|law| *law != WhiteBalance::Off);
    let gains = law.map(|law| balance::gains(&light, law));
    if let Some(gains) = gains {
        note(record, "white_balance", json!(gains));
        balance::apply(light.to_mut(), gains);
    }
    let tone = taking.parts.tone;
    let (rgb, clamped) = tone::codes(&light, tone);
    let deep = (taking.parts.bits == 16).then(|| tone::deep_codes(&light, tone));
    let rgb = match taking.parts.jpeg {
        Some(law) => jpeg::compressed(&rgb, law),
        None => rgb,
    };
    Developed {
        rgb,
        deep,
        clamped,
        raw,
        balance: gains,
    }
}

/// The codes of a scene, if no stage changes its light: encoding would repeat them.
fn find_unchanged<'a>(context: &FrameContext<'a>) -> Option<&'a Rgb8> {
    let mut before = context
        .plan
        .stages
        .iter()
        .filter(|stage| stage.id <= StageId::Haze);
    let codes = context.prepared.codes.as_ref()?;
    before.all(|stage| stage.variant.is_skipped()).then_some(codes)
}

fn read(context: &FrameContext<'_>, sensor: &SensorModel, light: &Rgb<f32>, cameras: &mut Cameras) -> Raw {
    let seed = sensor_seed(context.frame);
    let chance = Chance {
        seed,
        frame: context.frame.index,
    };
    if context.runs_reference(StageId::Sensor) {
        return sensor::read_reference(&light.map(|&v| f64::from(v)), sensor, chance);
    }
    let planes = if sensor.cfa == spec::Cfa::None { 3 } else { 1 };
    let samples = light.width() * light.height() * planes;
    sensor::read(light, sensor, chance, cameras.pattern(sensor, seed, samples))
}

/// The seed of a frame's sensor; another one for the right camera of a stereo pair.
fn sensor_seed(frame: &Frame) -> u64 {
    if frame.right_m == 0.0 {
        return frame.seed;
    }
    Stream::stage(frame.seed, "camera/right").bits(0, 0)
}

fn note(record: &mut FrameRecord, name: &str, value: Value) {
    record.optics.entry("camera").or_insert_with(|| json!({}))[name] = value;
}

/// Metadata needed to interpret the raw codes, and the source of the sensor's values.
fn described(context: &FrameContext<'_>, sensor: &SensorModel) -> Value {
    let law = preset::complete(&context.frame.camera).sensor.unwrap_or_default();
    let name = law.preset.as_deref().unwrap_or(preset::SENSORS[0].name);
    let source = preset::SensorPreset::find(name).map(|preset| {
        let assumed = if preset.is_assumed() {
            preset::ASSUMPTIONS
        } else {
            ""
        };
        json!({"source": preset.source, "assumed": assumed})
    });
    json!({
        "preset": name,
        "cfa": sensor.cfa,
        "black_dn": sensor.black_dn,
        "dn_per_e": sensor.dn_per_e(),
        "white_e": sensor.white_e(),
        "full_well_e": sensor.full_well_e,
        "bits": sensor.bits,
        "gain": sensor.gain,
        "noise_of_black": sensor.noise_at(0.0),
        "noise_of_white": sensor.noise_at(1.0),
        "provenance": source,
    })
}
