//! A scene upload on its way from a multipart body to a checked value.

use std::str::FromStr;

use axum::body::Bytes;
use axum::extract::Multipart;
use axum::extract::multipart::{Field, MultipartError};
use axum::http::StatusCode;
use imaging::geometry::Intrinsics;
use spec::{FieldError, Invalid, RangeFile, RangeKind, SceneFiles};

use crate::http::problem::{Problem, Slug};
use crate::limits;

/// The names of all fields.
const FIELDS: [&str; 11] = [
    "rgb",
    "range",
    "z_depth",
    "instances",
    "unit_m",
    "invalid_code",
    "fx",
    "focal_px",
    "cx",
    "cy",
    "hfov_deg",
];

/// The fields of a scene upload as they came.
#[derive(Default)]
pub(crate) struct Form {
    pub(crate) rgb: Option<Bytes>,
    range: Option<Bytes>,
    z_depth: Option<Bytes>,
    instances: Option<Bytes>,
    unit_m: Option<f64>,
    invalid_code: Option<u16>,
    focal_px: Option<f64>,
    cx: Option<f64>,
    cy: Option<f64>,
    hfov_deg: Option<f64>,
    seen: Vec<String>,
    errors: Vec<FieldError>,
}

impl Form {
    /// Reads all fields; what is wrong with them comes together.
    pub(crate) async fn read(mut body: Multipart) -> Result<Self, Problem> {
        let mut form = Self::default();
        while let Some(field) = body.next_field().await.map_err(|error| broken(&error))? {
            form.take(field).await?;
            if form.seen.len() + form.errors.len() > limits::FORM_FIELDS {
                return Err(too_many());
            }
        }
        if form.rgb.is_none() {
            form.refuse("rgb", "`rgb` is missing: the picture".to_owned());
        }
        if form.range.is_some() && form.z_depth.is_some() {
            form.refuse("z_depth", "give `range` or `z_depth`, not both".to_owned());
        }
        if form.focal_px.is_some() && form.hfov_deg.is_some() {
            form.refuse("hfov_deg", "give `focal_px` or `hfov_deg`, not both".to_owned());
        }
        if form.focal_px.is_none() && form.hfov_deg.is_none() && (form.cx.is_some() || form.cy.is_some()) {
            form.refuse(
                "cx",
                "a principal point needs `focal_px` or `hfov_deg`".to_owned(),
            );
        }
        if form.errors.is_empty() {
            Ok(form)
        } else {
            Err(Invalid(form.errors).into())
        }
    }

    async fn take(&mut self, field: Field<'_>) -> Result<(), Problem> {
        let name = field.name().unwrap_or_default().to_owned();
        if !FIELDS.contains(&name.as_str()) {
            self.refuse(
                &name,
                format!("there is no field `{name}`; fields are {}", FIELDS.join(", ")),
            );
            return drain(field).await;
        }
        if self.seen.contains(&name) {
            self.refuse(&name, format!("`{name}` is given twice"));
            return drain(field).await;
        }
        let bytes = field.bytes().await.map_err(|error| broken(&error))?;
        match name.as_str() {
            "rgb" => self.rgb = Some(bytes),
            "range" => self.range = Some(bytes),
            "z_depth" => self.z_depth = Some(bytes),
            "instances" => self.instances = Some(bytes),
            "invalid_code" => {
                self.invalid_code = self.number(&name, &bytes, "a whole number in 0..=65535", |_| true)
            }
            "unit_m" => {
                self.unit_m = self.number(&name, &bytes, "a number above 0", |unit: &f64| *unit > 0.0)
            }
            "hfov_deg" => {
                self.hfov_deg = self.number(&name, &bytes, "a number above 0 and below 180", |deg: &f64| {
                    *deg > 0.0 && *deg < 180.0
                });
            }
            "cx" => self.cx = self.number(&name, &bytes, "a finite number", |_| true),
            "cy" => self.cy = self.number(&name, &bytes, "a finite number", |_| true),
            _ => {
                if self.focal_px.is_some() {
                    self.refuse(&name, "`fx` and `focal_px` are the same; give one".to_owned());
                }
                self.focal_px = self.number(&name, &bytes, "a number above 0", |focal: &f64| *focal > 0.0);
            }
        }
        self.seen.push(name);
        Ok(())
    }

    fn number<T: FromStr + Into<f64> + Copy>(
        &mut self,
        name: &str,
        bytes: &[u8],
        limit: &str,
        holds: impl FnOnce(&T) -> bool,
    ) -> Option<T> {
        let text =
            std::str::from_utf8(&bytes[..bytes.len().min(limits::SCENE_FIELD_BYTES)]).unwrap_or("no text");
        let number = text.trim().parse::<T>().ok();
        let number = number.filter(|number| (*number).into().is_finite() && holds(number));
        if number.is_none() {
            self.refuse(name, format!("{name} is `{}` but must be {limit}", text.trim()));
        }
        number
    }

    fn refuse(&mut self, name: &str, message: String) {
        self.errors.push(FieldError {
            pointer: format!("/{name}"),
            message,
            value: None,
            limit: None,
            allowed: Vec::new(),
            did_you_mean: None,
        });
    }

    /// Whether anything is said about the camera.
    pub(crate) fn has_camera(&self) -> bool {
        self.focal_px.is_some() || self.hfov_deg.is_some()
    }

    /// The camera, for a picture of this size. A principal point that is not given lies in the middle.
    pub(crate) fn camera(&self, width: usize, height: usize) -> Option<Intrinsics> {
        let from_angle = |degrees: f64| width as f64 / 2.0 / (degrees.to_radians() / 2.0).tan();
        let centred = Intrinsics::centered(
            self.focal_px.or_else(|| self.hfov_deg.map(from_angle))?,
            width,
            height,
        );
        Some(Intrinsics {
            cx: self.cx.unwrap_or(centred.cx),
            cy: self.cy.unwrap_or(centred.cy),
            ..centred
        })
    }

    /// The files, with a camera if anything is said about one.
    pub(crate) fn files(self, camera: Option<Intrinsics>) -> SceneFiles<Bytes> {
        let range = self.range.map(|file| (file, RangeKind::Range));
        let z_depth = self.z_depth.map(|file| (file, RangeKind::ZDepth));
        let (unit_m, invalid_code) = (self.unit_m, self.invalid_code);
        SceneFiles {
            rgb: self.rgb.unwrap_or_default(),
            range: range.or(z_depth).map(|(file, kind)| RangeFile {
                file,
                kind,
                unit_m,
                invalid_code,
            }),
            instances: self.instances,
            intrinsics: camera,
        }
    }
}

/// Reads a refused field to its end without keeping it: the fields after it are checked too.
async fn drain(mut field: Field<'_>) -> Result<(), Problem> {
    while field.chunk().await.map_err(|error| broken(&error))?.is_some() {}
    Ok(())
}

/// A form that is more than its fields.
pub(crate) fn too_many() -> Problem {
    Problem::new(
        Slug::InvalidBody,
        format!("the form has more than {} fields", limits::FORM_FIELDS),
    )
}

/// A form that cannot be read to its end.
pub(crate) fn broken(error: &MultipartError) -> Problem {
    match error.status() {
        StatusCode::PAYLOAD_TOO_LARGE => {
            Problem::new(Slug::TooLarge, "the upload is larger than this route takes")
        }
        _ => Problem::new(Slug::InvalidBody, error.body_text()),
    }
}
