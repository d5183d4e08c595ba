//! One case: its parameters, its arrays, and comparison with a largest error.

use std::path::{Path, PathBuf};

use imaging::{Plane, Rgb};
use serde_json::{Map, Value};

/// Parameters that a case may have. Any other fails, so that a new one is never ignored.
const KNOWN: &[&str] = &[
    "stage",
    "input",
    "attenuation_per_m",
    "background",
    "transfer",
    "note",
    "arrays",
    "hole_rule",
    "backscatter_per_m",
    "kd_per_m",
    "depth_m",
    "background_surface",
    "G_per_m",
    "spread_px_per_m",
    "spread_offset_px",
    "scatter_source",
    "interpretation",
    "border",
    "hole_range",
    "lights",
    "units",
    "alpha",
    "haze_space",
    "blend_space",
    "gamma_px",
    "kernel",
    "otf",
    "otf_tolerance",
];

pub(crate) struct Case {
    folder: PathBuf,
    parameters: Map<String, Value>,
}

/// An array of any plain type as f64.
pub(crate) struct Array {
    pub(crate) shape: Vec<usize>,
    pub(crate) values: Vec<f64>,
    pub(crate) is_bytes: bool,
}

impl Case {
    pub(crate) fn read(folder: &Path) -> Self {
        let path = folder.join("params.json");
        let text =
            std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let parameters: Map<String, Value> = serde_json::from_str(&text).expect("params.json is an object");
        for key in parameters.keys() {
            assert!(
                KNOWN.contains(&key.as_str()),
                "{}: parameter `{key}` is not known",
                path.display()
            );
        }
        Self {
            folder: folder.to_owned(),
            parameters,
        }
    }

    pub(crate) fn get(&self, key: &str) -> Option<&Value> {
        self.parameters.get(key)
    }

    pub(crate) fn text(&self, key: &str) -> String {
        self.get(key)
            .and_then(Value::as_str)
            .unwrap_or_default()
            .to_owned()
    }

    pub(crate) fn number(&self, key: &str) -> Option<f64> {
        self.get(key).map(|value| value.as_f64().expect("a number"))
    }

    /// Three channels; a single number stands for all.
    pub(crate) fn triple(&self, key: &str) -> Option<[f64; 3]> {
        let value = self.get(key)?;
        if let Some(number) = value.as_f64() {
            return Some([number; 3]);
        }
        let values: Vec<f64> = value
            .as_array()
            .expect("an array")
            .iter()
            .filter_map(Value::as_f64)
            .collect();
        Some(values.try_into().expect("three numbers"))
    }

    pub(crate) fn array(&self, name: &str) -> Option<Array> {
        let path = self.folder.join(format!("{name}.npy"));
        if !path.exists() {
            assert!(
                self.get("arrays").and_then(|a| a.get(name)).is_none(),
                "{} is missing",
                path.display()
            );
            return None;
        }
        let bytes = std::fs::read(&path).expect("a readable array");
        let file = npyz::NpyFile::new(&bytes[..]).expect("an NPY file");
        let shape = file.shape().iter().map(|&side| side as usize).collect();
        let kind = file.dtype().descr();
        let is_bytes = kind.contains("u1");
        let values = if kind.contains("f8") {
            file.into_vec::<f64>().expect("f64")
        } else if kind.contains("f4") {
            file.into_vec::<f32>()
                .expect("f32")
                .into_iter()
                .map(f64::from)
                .collect()
        } else if is_bytes {
            file.into_vec::<u8>()
                .expect("u8")
                .into_iter()
                .map(f64::from)
                .collect()
        } else {
            panic!("{}: type {kind} is not known", path.display())
        };
        Some(Array {
            shape,
            values,
            is_bytes,
        })
    }

    pub(crate) fn needed(&self, name: &str) -> Array {
        self.array(name)
            .unwrap_or_else(|| panic!("{}: {name}.npy is missing", self.folder.display()))
    }

    /// Linear radiance of the input, whatever its form.
    pub(crate) fn radiance(&self) -> Rgb<f32> {
        let linear = self.text("transfer") == "linear";
        match self.array("input_linear") {
            Some(array) => array.rgb(|v| v as f32),
            None => {
                let array = self.needed("input_srgb");
                assert!(array.is_bytes, "input_srgb holds 8-bit codes");
                array.rgb(|code| {
                    if linear {
                        (code / 255.0) as f32
                    } else {
                        imaging::transfer::decode_u8(code as u8)
                    }
                })
            }
        }
    }

    pub(crate) fn range(&self) -> Plane<f32> {
        let array = self.needed("range_m");
        let data = array.values.iter().map(|&v| v as f32).collect();
        Plane::new(array.shape[1], array.shape[0], data).expect("the shape of the array")
    }

    /// Compares with an array of the case, if it is there: the largest error bounds, not the mean.
    pub(crate) fn compare(&self, name: &str, actual: &Rgb<f32>, tolerance: f64, what: &str) {
        let Some(expected) = self.array(name) else { return };
        assert_eq!(expected.shape, [actual.height(), actual.width(), 3], "{name}");
        let mut worst = (0.0, 0);
        for (index, value) in expected.values.iter().enumerate() {
            let error = (value - f64::from(actual.planes()[index % 3].data()[index / 3])).abs();
            assert!(
                !error.is_nan(),
                "{}: {name}: NaN at {index}",
                self.folder.display()
            );
            if error > worst.0 {
                worst = (error, index);
            }
        }
        let (x, y) = (worst.1 / 3 % actual.width(), worst.1 / 3 / actual.width());
        assert!(
            worst.0 <= tolerance,
            "{}: {name} by {what}: error {:.3e} at ({x}, {y}) exceeds {tolerance:.1e}",
            self.folder.display(),
            worst.0
        );
    }

    /// Compares 8-bit codes: never more than one apart, different in at most this share of samples.
    pub(crate) fn compare_codes(&self, name: &str, actual: &Rgb<f32>, share: f64, what: &str) {
        let Some(expected) = self.array(name) else { return };
        let codes = imaging::transfer::encode_rgb8(actual).0;
        assert_eq!(expected.values.len(), codes.data().len(), "{name}");
        let apart: Vec<f64> = expected
            .values
            .iter()
            .zip(codes.data())
            .map(|(e, &c)| (e - f64::from(c)).abs())
            .collect();
        let different = apart.iter().filter(|&&d| d > 0.0).count();
        assert!(
            apart.iter().all(|&d| d <= 1.0),
            "{}: {name} by {what}: codes differ by more than 1",
            self.folder.display()
        );
        let allowed = (share * apart.len() as f64).ceil() as usize;
        assert!(
            different <= allowed,
            "{}: {name} by {what}: {different} codes differ, {allowed} may",
            self.folder.display()
        );
    }
}

impl Array {
    pub(crate) fn rgb(&self, sample: impl Fn(f64) -> f32) -> Rgb<f32> {
        assert_eq!(self.shape.len(), 3, "a picture has three dimensions");
        Rgb::from_fn(self.shape[1], self.shape[0], |x, y| {
            let at = 3 * (y * self.shape[1] + x);
            [
                sample(self.values[at]),
                sample(self.values[at + 1]),
                sample(self.values[at + 2]),
            ]
        })
    }
}
