//! Decodes user files in a separate process, `PROGRAM decode --folder FOLDER`, with limited memory and time. The
//! folder contains `request.json` and the files; the process writes `reply.json`.

mod refusal;
mod summary;

use std::collections::BTreeMap;
use std::path::Path;
use std::{fs, io};

use client::SceneSummary;
use imaging::Raster;
use imaging::codec::{Radiance, decode_picture, decode_radiance, encode_png, encode_webp_lossless};
use imaging::geometry::Intrinsics;
use quality::MetricId;
use scenes::uploaded::{check_objects, decode};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use spec::{Enhancement, SceneFiles};
use utoipa::ToSchema;

use crate::limits;
pub(crate) use refusal::Refusal;
use summary::{check_units, summarize};

pub(crate) const REQUEST: &str = "request.json";
pub(crate) const REPLY: &str = "reply.json";
/// File name of an enhanced image.
pub(crate) const RESULT: &str = "result";

/// Operation on the files.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Request {
    /// Check a scene; replies with [`SceneFacts`].
    Scene(SceneRequest),
    /// Enhance an image; replies with warning codes.
    Enhance(EnhanceRequest),
    /// Measure an image; replies with [`Measured`].
    Measure(MeasureRequest),
}

/// The files of a scene by name, and its camera.
#[derive(Serialize, Deserialize)]
pub(crate) struct SceneRequest {
    pub(crate) files: SceneFiles<String>,
    pub(crate) camera: Option<GivenCamera>,
}

/// A camera given in a form. The principal point defaults to the center.
#[derive(Clone, Copy, Serialize, Deserialize)]
pub(crate) struct GivenCamera {
    pub(crate) focal_px: Option<f64>,
    pub(crate) cx: Option<f64>,
    pub(crate) cy: Option<f64>,
    pub(crate) hfov_deg: Option<f64>,
}

/// Facts about a scene that require decoding.
#[derive(Serialize, Deserialize)]
pub(crate) struct SceneFacts {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) camera: Option<Intrinsics>,
    pub(crate) summary: SceneSummary,
}

/// An image to enhance.
#[derive(Serialize, Deserialize)]
pub(crate) struct EnhanceRequest {
    pub(crate) picture: String,
    /// As [`Enhancement::parse`] reads it.
    pub(crate) method: String,
    pub(crate) is_webp: bool,
}

/// An image to measure.
#[derive(Serialize, Deserialize)]
pub(crate) struct MeasureRequest {
    pub(crate) picture: String,
    pub(crate) clean: Option<String>,
    pub(crate) metrics: Vec<String>,
}

/// Measurements of an image.
#[derive(Debug, Serialize, Deserialize, ToSchema)]
pub(crate) struct Measured {
    /// Image columns.
    width: usize,
    /// Image rows.
    height: usize,
    /// Values by metric.
    metrics: BTreeMap<String, f64>,
}

/// Executes the request in a folder; the main function of `PROGRAM decode`.
///
/// # Errors
/// The folder has no valid request.
pub fn decode_folder(folder: &Path) -> io::Result<()> {
    let request = serde_json::from_slice(&fs::read(folder.join(REQUEST))?)?;
    // Decoders may panic on damaged files; users need no backtrace.
    std::panic::set_hook(Box::new(|_| {}));
    let reply = std::panic::catch_unwind(|| execute(folder, &request)).unwrap_or_else(|_| {
        let message =
            "the decoder failed on a file that is damaged or of a rare kind; save it as PNG and try again";
        Ok(Err(Refusal {
            pointer: String::new(),
            message: message.to_owned(),
        }))
    })?;
    fs::write(folder.join(REPLY), serde_json::to_vec(&reply)?)
}

fn execute(folder: &Path, request: &Request) -> Checked<Value> {
    Ok(match request {
        Request::Scene(request) => scene(folder, request)?.map(|facts| serde_json::json!(facts)),
        Request::Enhance(request) => enhanced(folder, request)?.map(Value::String),
        Request::Measure(request) => measured(folder, request)?.map(|values| serde_json::json!(values)),
    })
}

/// I/O errors outside, rejections inside.
type Checked<T> = io::Result<Result<T, Refusal>>;

fn scene(folder: &Path, SceneRequest { files, camera }: &SceneRequest) -> Checked<SceneFacts> {
    let mut files = files.try_map(|name| fs::read(folder.join(name)))?;
    Ok((|| {
        if let Some(given) = camera {
            files.intrinsics = camera_of(given, &files.rgb)?;
        }
        let scene = decode(&files)?;
        check_objects(&scene, files.classes.as_ref())?;
        check_units(&scene, &files)?;
        Ok(SceneFacts {
            width: scene.radiance.width(),
            height: scene.radiance.height(),
            camera: files.intrinsics,
            summary: summarize(&scene, &files),
        })
    })())
}

/// The camera needs the image size, which requires decoding.
fn camera_of(given: &GivenCamera, rgb: &[u8]) -> Result<Option<Intrinsics>, Refusal> {
    let picture = decode_radiance(rgb).map_err(|error| Refusal::new("rgb", format!("`rgb`: {error}")))?;
    let (width, height) = match picture {
        Radiance::Encoded(raster) => (raster.width(), raster.height()),
        Radiance::Linear(picture) => picture.size(),
    };
    let Some(focal_px) = given.focal_px.or_else(|| {
        given
            .hfov_deg
            .map(|degrees: f64| width as f64 / 2.0 / (degrees.to_radians() / 2.0).tan())
    }) else {
        return Ok(None);
    };
    let centered = Intrinsics::centered(focal_px, width, height);
    Ok(Some(Intrinsics {
        cx: given.cx.unwrap_or(centered.cx),
        cy: given.cy.unwrap_or(centered.cy),
        ..centered
    }))
}

fn enhanced(folder: &Path, request: &EnhanceRequest) -> Checked<String> {
    let bytes = fs::read(folder.join(&request.picture))?;
    let encoded = (|| {
        let enhancement = Enhancement::parse(&request.method)
            .map_err(|invalid| Refusal::new("method", invalid.to_string()))?;
        let picture = picture("picture", &bytes)?;
        let enhanced = enhance::enhance(&enhancement, &picture, &[], &mut enhance::refuse_network)
            .map_err(|error| Refusal::new("picture", error.to_string()))?;
        let bytes = match request.is_webp {
            true => encode_webp_lossless(&enhanced.picture.to_rgb8()),
            false => encode_png(&enhanced.picture),
        };
        let codes: Vec<_> = enhanced.warnings.iter().map(|warning| warning.code()).collect();
        Ok((
            bytes.map_err(|error| Refusal::new("picture", error.to_string()))?,
            codes.join(", "),
        ))
    })();
    match encoded {
        Err(refusal) => Ok(Err(refusal)),
        Ok((bytes, warnings)) => {
            fs::write(folder.join(RESULT), bytes)?;
            Ok(Ok(warnings))
        }
    }
}

fn measured(folder: &Path, request: &MeasureRequest) -> Checked<Measured> {
    let bytes = fs::read(folder.join(&request.picture))?;
    let clean = request.clean.as_ref().map(|name| fs::read(folder.join(name)));
    let clean = clean.transpose()?;
    Ok((|| {
        let picture = picture("picture", &bytes)?.to_rgb8();
        let clean = clean.map(|bytes| self::picture("clean", &bytes)).transpose()?;
        let clean = clean.map(|clean| clean.to_rgb8());
        let metrics: Vec<MetricId> = request
            .metrics
            .iter()
            .filter_map(|name| MetricId::parse(name))
            .collect();
        let values = quality::measure(&picture, clean.as_ref(), &metrics)
            .map_err(|error| Refusal::new("clean", error))?;
        let named = values.into_iter().map(|(id, value)| (id.to_string(), value));
        Ok(Measured {
            width: picture.width(),
            height: picture.height(),
            metrics: named.collect(),
        })
    })())
}

/// Decodes an image within the size limit.
fn picture(field: &str, bytes: &[u8]) -> Result<Raster, Refusal> {
    let picture =
        decode_picture(bytes).map_err(|error| Refusal::new(field, format!("`{field}`: {error}")))?;
    let (width, height) = (picture.width(), picture.height());
    match width * height {
        0..=limits::PICTURE_PIXELS => Ok(picture),
        pixels => {
            let limit = limits::PICTURE_PIXELS;
            let message = format!("`{field}` is {width}×{height} = {pixels} pixels; must be at most {limit}");
            Err(Refusal::new(field, message))
        }
    }
}
