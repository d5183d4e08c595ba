//! The distance of the models of a frame from the truth: the measured errors of its light, weighted by that light.

use imaging::vector::DVec3;
use imaging::{Plane, Rgb};
use optics::chain::Layers;
use optics::daylight::{Daylight, Gaze};
use optics::plan::{LightError, PartErrors};
use optics::range::is_hole;
use serde_json::{Value, json};
use spec::{FrameRecord, SceneLighting};

use crate::context::FrameContext;

/// Least samples along the shorter side of a frame, if it has as many, and the largest distance between samples: enough for two
/// digits of a mean.
const LEAST_SAMPLES: usize = 64;
const MOST_STEP_PX: usize = 8;
/// Cosine of the half angle of Snell's window, 48.6 degrees. The chain has half of the true light there.
const WINDOW_RISE: f64 = 0.661;

/// The model error of a frame, weighted by pixels and their light.
#[derive(Debug, Clone, Copy, PartialEq)]
struct FrameError {
    /// Share of the light whose error was measured; 0 of a dark frame.
    covered: f64,
    /// Mean error of that light; `None` without such light.
    error: Option<LightError>,
}

/// Adds the model error of the light before particles and camera to the record. Frames without water or range have none.
pub(crate) fn run(context: &FrameContext<'_>, layers: &Layers, record: &mut FrameRecord) {
    let setting = &context.setting;
    let (Some(water), Some(path)) = (&setting.around, context.path()) else {
        return;
    };
    let is_reflectance = context.frame.scene.lighting() == SceneLighting::Water;
    let errors = PartErrors::find(water, setting.lighting.as_ref(), is_reflectance);
    let daylight = water.daylight().map(Daylight::gaze);
    let found = weigh(&errors, daylight, layers, path);
    let mut numbers = json!({"covered": round(found.covered)});
    if let Some(LightError { bias, rms }) = found.error {
        numbers["bias"] = round(bias);
        numbers["rms"] = round(rms);
    }
    record.optics.insert("model".to_owned(), numbers);
}

/// The mean error of the light of a frame. `path` holds meters of the mean water before each pixel. By day, `gaze` is the view: open
/// water in Snell's window is not covered.
fn weigh(errors: &PartErrors, gaze: Option<&Gaze>, layers: &Layers, path: &Plane<f32>) -> FrameError {
    let (width, height) = path.size();
    let step = (width.min(height) / LEAST_SAMPLES).clamp(1, MOST_STEP_PX);
    let mut sums = Sums::default();
    for y in (0..height).step_by(step) {
        for x in (0..width).step_by(step) {
            let meters = path.pixel(x, y);
            let is_near = f64::from(meters) <= errors.farthest_m;
            let is_sky = is_hole(meters) && gaze.is_some_and(|gaze| rise(gaze, x, y) > WINDOW_RISE);
            sums.add(
                add_channels(&layers.direct, x, y),
                errors.unscattered.filter(|_| is_near),
            );
            sums.add(
                add_channels(&layers.forward_scatter, x, y),
                errors.forward_scatter.filter(|_| is_near),
            );
            sums.add(
                add_channels(&layers.backscatter, x, y),
                errors.backscatter.filter(|_| !is_sky),
            );
        }
    }
    sums.finish()
}

/// Light of all channels of a pixel. The published gathering may be negative.
fn add_channels(layer: &Rgb<f32>, x: usize, y: usize) -> f64 {
    let samples = layer
        .planes()
        .iter()
        .map(|plane| f64::from(plane.pixel(x, y)).abs());
    samples.sum()
}

/// Cosine from the vertical of the ray of a pixel.
fn rise(gaze: &Gaze, x: usize, y: usize) -> f64 {
    let ray = gaze.camera.ray(x as f64, y as f64).normalized();
    ray.dot(DVec3::from(gaze.up))
}

/// Sums of light, and of its errors where they were measured.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    all: f64,
    covered: f64,
    bias: f64,
    rms: f64,
}

impl Sums {
    fn add(&mut self, light: f64, error: Option<LightError>) {
        self.all += light;
        if let Some(error) = error {
            self.covered += light;
            self.bias += light * error.bias;
            self.rms += light * error.rms;
        }
    }

    fn finish(self) -> FrameError {
        FrameError {
            covered: if self.all > 0.0 {
                self.covered / self.all
            } else {
                0.0
            },
            error: (self.covered > 0.0).then(|| LightError {
                bias: self.bias / self.covered,
                rms: self.rms / self.covered,
            }),
        }
    }
}

/// Four decimals.
fn round(number: f64) -> Value {
    json!((number * 1e4).round() / 1e4)
}

#[cfg(test)]
mod tests {
    use imaging::geometry::Intrinsics;

    use super::*;

    /// Two pixels at 2 m and at 8 m with these layers, equal in all channels.
    fn layers(direct: [f32; 2], forward: [f32; 2], back: [f32; 2]) -> Layers {
        let layer = |light: [f32; 2]| Rgb::from_fn(2, 1, |x, _| [light[x]; 3]);
        Layers {
            direct: layer(direct),
            forward_scatter: layer(forward),
            backscatter: layer(back),
            scattered: layer([0.0; 2]),
            holes: 0,
        }
    }

    fn path() -> Plane<f32> {
        Plane::from_fn(2, 1, |x, _| [2.0, 8.0][x])
    }

    const ERROR: LightError = LightError { bias: -0.1, rms: 0.2 };
    const OTHER: LightError = LightError { bias: 0.3, rms: 0.4 };

    #[test]
    fn light_weighs_the_errors_of_its_parts() {
        let errors = PartErrors {
            unscattered: Some(ERROR),
            forward_scatter: None,
            backscatter: Some(OTHER),
            farthest_m: 4.0,
        };
        // Covered: 3 of the near surface and 1 + 2 of the water; not the far surface with 2, nor forward scatter with 1 + 1.
        let found = weigh(
            &errors,
            None,
            &layers([3.0, 2.0], [1.0, 1.0], [1.0, 2.0]),
            &path(),
        );
        assert!((found.covered - 0.6).abs() < 1e-12, "{found:?}");
        let error = found.error.unwrap();
        assert!(
            (error.bias - (3.0 * -0.1 + 3.0 * 0.3) / 6.0).abs() < 1e-12,
            "{error:?}"
        );
        assert!(
            (error.rms - (3.0 * 0.2 + 3.0 * 0.4) / 6.0).abs() < 1e-12,
            "{error:?}"
        );
    }

    #[test]
    fn light_under_other_conditions_has_no_error() {
        let found = weigh(
            &PartErrors::default(),
            None,
            &layers([1.0; 2], [0.0; 2], [1.0; 2]),
            &path(),
        );
        assert_eq!((found.covered, found.error), (0.0, None));
        let all = PartErrors {
            unscattered: Some(ERROR),
            ..PartErrors::default()
        };
        let dark = weigh(&all, None, &layers([0.0; 2], [0.0; 2], [0.0; 2]), &path());
        assert_eq!((dark.covered, dark.error), (0.0, None));
    }

    #[test]
    fn open_water_in_snells_window_is_not_covered() {
        let errors = PartErrors {
            backscatter: Some(ERROR),
            ..PartErrors::default()
        };
        let camera = Intrinsics::centered(10.0, 2, 1);
        let light = layers([0.0; 2], [0.0; 2], [1.0, 3.0]);
        let path = Plane::from_fn(2, 1, |x, _| [f32::INFINITY, 2.0][x]);
        let covered =
            |up: [f64; 3]| weigh(&errors, Some(&Gaze::new(camera, (2, 1), up)), &light, &path).covered;
        assert_eq!(covered([0.0, -1.0, 0.0]), 1.0);
        // The camera looks up: only the hole is the sky.
        assert_eq!(covered([0.0, 0.0, 1.0]), 0.75);
    }

    #[test]
    fn the_gathering_of_published_models_counts_by_its_size() {
        let errors = PartErrors {
            unscattered: Some(ERROR),
            farthest_m: 10.0,
            ..PartErrors::default()
        };
        let found = weigh(&errors, None, &layers([3.0, 3.0], [-1.0, 1.0], [0.0; 2]), &path());
        assert!((found.covered - 0.75).abs() < 1e-12, "{found:?}");
    }
}
