//! Sensors and cameras by name, with sources.

use spec::{Camera, Cfa, Distortion, Exposure, Metering, Port, Vignette, WhiteBalance};

use crate::sensor::SensorModel;

/// A sensor preset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensorPreset {
    /// Name in descriptions.
    pub name: &'static str,
    /// Pixels and shutter.
    pub about: &'static str,
    /// Source of its numbers.
    pub source: &'static str,
    full_well_e: f64,
    read_noise_e: f64,
    bits: u8,
}

/// Default exposure time, s: frames of a moving inspection camera are rarely exposed for longer.
pub const EXPOSURE_S: f64 = 0.01;

/// Assumptions where no source gives all numbers of one sensor.
const ASSUMED: SensorModel = SensorModel {
    full_well_e: 0.0,
    white_at: 0.9,
    prnu: 0.005,
    dcnu: 0.1,
    dsnu_e: 0.5,
    dark_e_per_s: 1.0,
    hot_share: 0.0,
    exposure_s: EXPOSURE_S,
    read_noise_e: 0.0,
    row_noise_e: 0.3,
    shot: true,
    bits: 12,
    black_dn: 64,
    gain: 1.0,
    cfa: Cfa::Rggb,
};

/// Assumptions for every sensor but `ideal`.
pub const ASSUMPTIONS: &str = "assumed, not published together: white at 0.9 of the full well, PRNU 0.005, DSNU 0.5 e-, \
    dark current 1 e-/s with spread 0.1, row noise 0.3 e-, black 64 DN, gain 1, 0.01 s, RGGB";

/// All sensors; the first is the default.
pub const SENSORS: &[SensorPreset] = &[
    SensorPreset {
        name: "machine-vision-1/1.8",
        about: "3.45 µm, 2048×1536, global shutter",
        source: "manual of a maker (2.8 e-/DN) and EMVA 1288 sheet of a sister model: 40.3 dB, 71.3 dB",
        full_well_e: 11_000.0,
        read_noise_e: 2.2,
        bits: 12,
    },
    SensorPreset {
        name: "large-pixel-1/1.2",
        about: "5.86 µm, 1936×1216, global shutter",
        source: "published EMVA 1288 figures: 32691 e-, 6.83 e-, 73 dB, 45.1 dB",
        full_well_e: 32_700.0,
        read_noise_e: 6.8,
        bits: 12,
    },
    SensorPreset {
        name: "small-pixel-1/2.3",
        about: "1.55 µm, 4056×3040, rolling shutter",
        source: "published photon-transfer measurement at base gain: 0.47 DN/e-",
        full_well_e: 8180.0,
        read_noise_e: 3.0,
        bits: 12,
    },
    SensorPreset {
        name: "ideal",
        about: "no noise but rounding to 16 bits, three sensors",
        source: "none: a limit",
        full_well_e: 1e6,
        read_noise_e: 0.0,
        bits: 16,
    },
];

impl SensorPreset {
    /// The preset of a name.
    #[must_use]
    pub fn find(name: &str) -> Option<&'static Self> {
        SENSORS.iter().find(|sensor| sensor.name == name)
    }

    /// Its parameters.
    #[must_use]
    pub fn sensor(&self) -> SensorModel {
        let sensor = SensorModel {
            full_well_e: self.full_well_e,
            read_noise_e: self.read_noise_e,
            bits: self.bits,
            ..ASSUMED
        };
        if self.name != "ideal" {
            return sensor;
        }
        SensorModel {
            white_at: 1.0,
            prnu: 0.0,
            dcnu: 0.0,
            dsnu_e: 0.0,
            dark_e_per_s: 0.0,
            row_noise_e: 0.0,
            shot: false,
            black_dn: 0,
            cfa: Cfa::None,
            ..sensor
        }
    }

    /// Whether its record must list the assumptions.
    #[must_use]
    pub fn is_assumed(&self) -> bool {
        self.sensor().row_noise_e > 0.0
    }
}

/// The sensor of a description with this exposure time: its preset with fields replaced. `None` for an unknown preset.
#[must_use]
pub fn sensor(law: &spec::Sensor, exposure_s: Option<f64>) -> Option<SensorModel> {
    let name = law.preset.as_deref().unwrap_or(SENSORS[0].name);
    let preset = SensorPreset::find(name)?.sensor();
    Some(SensorModel {
        full_well_e: law.full_well_e.unwrap_or(preset.full_well_e),
        white_at: preset.white_at * law.light_level.unwrap_or(1.0),
        prnu: law.prnu.unwrap_or(preset.prnu),
        dcnu: law.dcnu.unwrap_or(preset.dcnu),
        dsnu_e: law.dsnu_e.unwrap_or(preset.dsnu_e),
        dark_e_per_s: law.dark_e_per_s.unwrap_or(preset.dark_e_per_s),
        hot_share: law.hot_share.unwrap_or(preset.hot_share),
        exposure_s: exposure_s.unwrap_or(preset.exposure_s),
        read_noise_e: law.read_noise_e.unwrap_or(preset.read_noise_e),
        row_noise_e: law.row_noise_e.unwrap_or(preset.row_noise_e),
        shot: preset.shot,
        bits: law.bits.unwrap_or(preset.bits),
        black_dn: law.black_dn.unwrap_or(preset.black_dn),
        gain: law.gain.unwrap_or(preset.gain),
        cfa: law.cfa.unwrap_or(preset.cfa),
    })
}

/// A camera preset.
#[derive(Debug, Clone, Copy)]
pub struct CameraPreset {
    /// Name in descriptions.
    pub name: &'static str,
    /// Short description.
    pub about: &'static str,
    /// Source of its numbers.
    pub source: &'static str,
    sensor: &'static str,
    port: Option<Port>,
    distortion: Option<Distortion>,
    readout_s: Option<f64>,
}

const BARREL: Distortion = Distortion {
    k1: -0.12,
    k2: 0.02,
    k3: 0.0,
    p1: 0.0,
    p2: 0.0,
};

/// Every camera.
pub const CAMERAS: &[CameraPreset] = &[
    CameraPreset {
        name: "inspection-flat-port",
        about: "machine vision behind a flat port: narrow view, pincushion, colored edges",
        source: "sensor `machine-vision-1/1.8`; refractive index of sea water by Quan and Fry 1995; the rest assumed",
        sensor: "machine-vision-1/1.8",
        port: Some(Port::Flat {
            pupil_m: 0.0,
            glass_m: 0.0,
        }),
        distortion: None,
        readout_s: None,
    },
    CameraPreset {
        name: "low-light-dome",
        about: "large pixels behind a dome of 0.1 m",
        source: "sensor `large-pixel-1/1.2`; the rest assumed",
        sensor: "large-pixel-1/1.2",
        port: Some(Port::Dome { radius_m: 0.1 }),
        distortion: None,
        readout_s: None,
    },
    CameraPreset {
        name: "action-flat-port",
        about: "small pixels, barrel distortion, rolling shutter, flat port",
        source: "sensor `small-pixel-1/2.3`; refractive index of sea water by Quan and Fry 1995; distortion and readout assumed",
        sensor: "small-pixel-1/2.3",
        port: Some(Port::Flat {
            pupil_m: 0.0,
            glass_m: 0.0,
        }),
        distortion: Some(BARREL),
        readout_s: Some(0.02),
    },
];

const FULL_VIGNETTE: Vignette = Vignette { v: 1.0, v2: 0.0 };

const METERED: Metering = Metering {
    target: 0.5,
    percentile: 0.95,
    lag_frames: 0.0,
};

impl CameraPreset {
    /// The preset of a name.
    #[must_use]
    pub fn find(name: &str) -> Option<&'static Self> {
        CAMERAS.iter().find(|camera| camera.name == name)
    }
}

/// Completes a camera from its preset. A rolling shutter is only added to cameras on a path.
#[must_use]
pub fn complete(camera: &Camera) -> Camera {
    let mut complete = camera.clone();
    let Some(preset) = camera.preset.as_deref().and_then(CameraPreset::find) else {
        return complete;
    };
    complete.port = camera.port.or(preset.port);
    complete.distortion = camera.distortion.or(preset.distortion);
    complete.readout_s = camera
        .readout_s
        .or(preset.readout_s.filter(|_| camera.path.is_some()));
    complete.vignette = camera.vignette.or(Some(FULL_VIGNETTE));
    complete.exposure = camera.exposure.or(Some(Exposure::Auto(METERED)));
    complete.white_balance = camera.white_balance.or(Some(WhiteBalance::GrayWorld));
    let mut sensor = camera.sensor.clone().unwrap_or_default();
    sensor.preset.get_or_insert_with(|| preset.sensor.to_owned());
    complete.sensor = Some(sensor);
    complete
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_camera_has_a_sensor_of_the_table_and_fields_replace_its_parts() {
        for preset in CAMERAS {
            assert!(SensorPreset::find(preset.sensor).is_some(), "{}", preset.name);
            let mut camera = Camera::pinhole(64, 48, 60.0);
            camera.preset = Some(preset.name.to_owned());
            camera.sensor = Some(spec::Sensor {
                gain: Some(4.0),
                ..spec::Sensor::default()
            });
            camera.port = Some(Port::None {});
            let complete = complete(&camera);
            let sensor = sensor(complete.sensor.as_ref().unwrap(), None).unwrap();
            assert_eq!(sensor.gain, 4.0);
            assert_eq!(
                sensor.full_well_e,
                SensorPreset::find(preset.sensor).unwrap().full_well_e
            );
            assert_eq!(complete.port, Some(Port::None {}));
            assert!(complete.readout_s.is_none());
        }
    }

    #[test]
    fn a_camera_without_preset_stays_what_it_is() {
        let camera = Camera::pinhole(64, 48, 60.0);
        assert_eq!(complete(&camera), camera);
        assert_eq!(sensor(&spec::Sensor::default(), None), Some(SENSORS[0].sensor()));
    }
}
