//! Exposure times of the rows of a frame: motion blur and rolling shutter.

use std::ops::Range;

use spec::{Frame, Scene};

/// Pictures averaged for the blur of an exposure. The copies of an edge that moves by 8 pixels are one pixel apart.
pub(crate) const BLUR_SAMPLES: usize = 8;
/// Bands of rows that share a pose during a rolling readout. Steps between them stay below a pixel for skews of up to 16 pixels.
const READOUT_BANDS: usize = 16;

/// One of the pictures averaged into a frame.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Moment {
    /// Time after the frame's time, in frames of the path.
    pub(crate) later: f64,
    /// The rows it contributes to.
    pub(crate) rows: Range<usize>,
    /// Its weight in those rows.
    pub(crate) weight: f64,
    /// Whether it provides the labels of these rows; true for the moment closest to mid-exposure.
    pub(crate) labels: bool,
}

/// The moments that make up a frame of `height` rows. A frame without motion has one moment, at its nominal time.
///
/// The exposure of a row is sampled evenly around its readout time, at `(k + 1/2)/n - 1/2` of the exposure. Row j is read
/// `(j + 1/2)/H - 1/2` of the readout after the frame's time; the rows of a band share the time of its middle.
pub(crate) fn moments(frame: &Frame, height: usize) -> Vec<Moment> {
    let camera = ::camera::preset::complete(&frame.camera);
    let still = || {
        vec![Moment {
            later: 0.0,
            rows: 0..height,
            weight: 1.0,
            labels: true,
        }]
    };
    if camera.path.is_none() || !matches!(frame.scene, Scene::Procedural { .. }) {
        return still();
    }
    let (samples, exposure_s) = camera
        .exposure_s
        .map_or((1, 0.0), |exposure_s| (BLUR_SAMPLES, exposure_s));
    let (bands, readout_s) = camera
        .readout_s
        .map_or((1, 0.0), |readout_s| (READOUT_BANDS.min(height), readout_s));
    let mut moments = Vec::new();
    for band in 0..bands {
        let rows = band * height / bands..(band + 1) * height / bands;
        let middle = (rows.start + rows.end) as f64 / 2.0 / height as f64;
        for sample in 0..samples {
            let open = (sample as f64 + 0.5) / samples as f64 - 0.5;
            moments.push(Moment {
                later: camera.frames_per_s * (readout_s * (middle - 0.5) + exposure_s * open),
                rows: rows.clone(),
                weight: 1.0 / samples as f64,
                labels: sample == samples / 2,
            });
        }
    }
    moments
}
