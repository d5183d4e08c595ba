//! One case: its parameters, its arrays, and comparison with a largest error.

use std::path::{Path, PathBuf};

use imaging::codec::{self, NpyValues};
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
    "focal_px",
    "principal_point",
    "absorption_per_m",
    "scattering_per_m",
    "hg_g",
    "min_radius_m",
];

pub(crate) struct Case {
    folder: PathBuf,
    parameters: Map<String, Value>,
}

/// An array of any plain type as f64.
pub(crate) struct Array {
    pub(crate) shape: Vec<usize>,
    pub(crate) values: Vec<f64>,
    /// The largest code of an integer type.
    pub(crate) top_code: Option<f64>,
}

impl Case {
    /// A case with only known parameters.
    pub(crate) fn read(folder: &Path) -> Self {
        let case = Self::open(folder);
        for key in case.parameters.keys() {
            assert!(
                KNOWN.contains(&key.as_str()),
                "{}: parameter `{key}` is not known",
                folder.display()
            );
        }
        case
    }

    pub(crate) fn open(folder: &Path) -> Self {
        let path = folder.join("params.json");
        let text =
            std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        Self {
            folder: folder.to_owned(),
            parameters: serde_json::from_str(&text).expect("params.json is an object"),
        }
    }

    /// Some numbers.
    pub(crate) fn numbers(&self, key: &str) -> Vec<f64> {
        let values = self.get(key).and_then(Value::as_array);
        let values = values.unwrap_or_else(|| panic!("`{key}` is a list"));
        values.iter().filter_map(Value::as_f64).collect()
    }

    /// An array of 32-bit integers, unlike a picture.
    pub(crate) fn integers(&self, name: &str) -> Vec<i32> {
        let bytes = std::fs::read(self.folder.join(format!("{name}.npy"))).expect("a readable array");
        let header = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
        let words = bytes[header..].chunks_exact(4);
        words
            .map(|word| i32::from_le_bytes([word[0], word[1], word[2], word[3]]))
            .collect()
    }

    pub(crate) fn get(&self, key: &str) -> Option<&Value> {
        self.parameters.get(key)
    }

    /// A text, empty if it is missing.
    pub(crate) fn text(&self, key: &str) -> String {
        let text = self
            .get(key)
            .map(|value| value.as_str().unwrap_or_else(|| panic!("`{key}` is not a text")));
        text.unwrap_or_default().to_owned()
    }

    /// Panics if a text is given and is not one of `known`.
    pub(crate) fn expect_text(&self, key: &str, known: &[&str]) {
        let text = self.text(key);
        assert!(
            text.is_empty() || known.contains(&text.as_str()),
            "{key} `{text}` is not known"
        );
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
        let array = codec::decode_npy(&bytes).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let (values, top_code) = match array.values {
            NpyValues::F64(values) => (values, None),
            NpyValues::F32(values) => (widened(values), None),
            NpyValues::U8(codes) => (widened(codes), Some(255.0)),
            NpyValues::U16(codes) => (widened(codes), Some(65535.0)),
            NpyValues::Wide(_) => panic!("{}: integers of another type", path.display()),
        };
        Some(Array {
            shape: array.shape,
            values,
            top_code,
        })
    }

    pub(crate) fn needed(&self, name: &str) -> Array {
        self.array(name)
            .unwrap_or_else(|| panic!("{}: {name}.npy is missing", self.folder.display()))
    }

    /// Linear radiance of the input in any of its forms: the array named by `input`, else `input_linear` or `input_srgb`. Integer
    /// codes are sRGB and floats linear unless `transfer` overrides it.
    pub(crate) fn radiance(&self) -> Rgb<f64> {
        let named = self.text("input");
        let array = if named.is_empty() {
            self.array("input_linear")
                .unwrap_or_else(|| self.needed("input_srgb"))
        } else {
            self.needed(named.trim_end_matches(".npy"))
        };
        let encoded = match self.text("transfer").as_str() {
            "" => array.top_code.is_some(),
            "srgb" => true,
            "linear" => false,
            other => panic!("transfer `{other}` is not known"),
        };
        let top_code = array.top_code.unwrap_or(1.0);
        array.rgb(|code| {
            let value = code / top_code;
            if encoded {
                imaging::transfer::decode(value)
            } else {
                value
            }
        })
    }

    pub(crate) fn range(&self) -> Plane<f64> {
        let array = self.needed("range_m");
        assert_eq!(array.shape.len(), 2, "a range map has two dimensions");
        Plane::new(array.shape[1], array.shape[0], array.values).expect("the shape of the array")
    }

    /// Compares with an array of the case, if it is there: the largest error bounds, not the mean. Light above 1 is allowed
    /// its share, for rounding is relative.
    pub(crate) fn compare<T: Copy + Into<f64>>(
        &self,
        name: &str,
        actual: &Rgb<T>,
        tolerance: f64,
        what: &str,
    ) {
        let Some(expected) = self.array(name) else { return };
        let place = format!("{}: {name} by {what}", self.folder.display());
        assert_eq!(expected.shape, [actual.height(), actual.width(), 3], "{place}");
        let peak = expected.values.iter().copied().fold(1.0, f64::max);
        let mut worst = (0.0, 0);
        for (index, value) in expected.values.iter().enumerate() {
            let actual: f64 = actual.planes()[index % 3].data()[index / 3].into();
            let error = (value - actual).abs();
            assert!(!error.is_nan(), "{place}: {actual} for {value} at {index}");
            if error > worst.0 {
                worst = (error, index);
            }
        }
        let (x, y) = (worst.1 / 3 % actual.width(), worst.1 / 3 / actual.width());
        println!("   {place}: {:.2e}", worst.0);
        assert!(
            worst.0 <= tolerance * peak,
            "{place}: error {:.3e} at ({x}, {y}) exceeds {tolerance:.1e} of {peak}",
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

fn widened<T: Into<f64>>(values: Vec<T>) -> Vec<f64> {
    values.into_iter().map(Into::into).collect()
}

impl Array {
    pub(crate) fn rgb<T>(&self, sample: impl Fn(f64) -> T) -> Rgb<T> {
        assert!(
            self.shape.len() == 3 && self.shape[2] == 3,
            "a picture has rows, columns and three channels"
        );
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
