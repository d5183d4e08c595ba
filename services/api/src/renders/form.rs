//! The form of a picture to render.

use axum::body::Bytes;
use axum::extract::Multipart;
use imaging::codec::announced_pixels;
use renderer::{StreamJob, StreamParts};
use serde_json::Value;
use spec::{Invalid, Vocabulary};
use utoipa::ToSchema;

use super::protocol::{InputFile, InputRole, PictureJob, PictureRequest, ReplyFormat};
use crate::http::form::{Form, Kind};
use crate::http::problem::Problem;
use crate::limits;

const FIELDS: [(&str, Kind); 8] = [
    ("frame", Kind::File),
    ("rgb", Kind::File),
    ("range", Kind::File),
    ("z_depth", Kind::File),
    ("instances", Kind::File),
    ("camera", Kind::Text),
    ("pose", Kind::File),
    ("stamp_ns", Kind::Text),
];

/// The fields of a picture to render.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes the body; `PictureForm` reads it")]
pub(crate) struct PictureUpload {
    /// The job as JSON. The picture replaces its scene, which may be absent.
    #[schema(value_type = String, format = Binary, content_media_type = "application/json")]
    frame: Vec<u8>,
    /// The picture in air, as for uploads, of at most 8 388 608 pixels: integers are sRGB codes, floats linear light.
    #[schema(value_type = String, format = Binary)]
    rgb: Vec<u8>,
    /// Distances along the line of sight, as for uploads: integers are millimeters, floats meters. Without distances the
    /// stages of the water are skipped.
    #[schema(value_type = Option<String>, format = Binary)]
    range: Option<Vec<u8>>,
    /// Distances along the optical axis, instead of `range`.
    #[schema(value_type = Option<String>, format = Binary)]
    z_depth: Option<Vec<u8>>,
    /// Instance of each pixel, 0 = background, for the artifacts `instances` and `boxes`.
    #[schema(value_type = Option<String>, format = Binary)]
    instances: Option<Vec<u8>>,
    /// The camera matrix in pixels as JSON, `[[fx, 0, cx], [0, fy, cy], [0, 0, 1]]`; absent: the camera of the job.
    camera: Option<String>,
    /// Camera pose as JSON, as for uploads.
    #[schema(value_type = Option<String>, format = Binary)]
    pose: Option<Vec<u8>>,
    /// Time of the picture in nanoseconds; the random numbers of the frame depend on it. Absent: 0.
    stamp_ns: Option<u64>,
}

/// A checked form.
pub(crate) struct PictureForm {
    pub(crate) job: StreamJob,
    pub(crate) request: PictureRequest,
    pub(crate) files: Vec<Bytes>,
    /// Pixels by the header of the picture.
    pub(crate) pixels: usize,
}

impl PictureForm {
    /// Reads all fields and reports all errors together.
    pub(crate) async fn read(
        body: Multipart,
        vocabulary: &Vocabulary,
        format: ReplyFormat,
    ) -> Result<Self, Problem> {
        let mut form = Form::read(body, &FIELDS).await?;
        ["frame", "rgb"].into_iter().for_each(|name| form.require(name));
        if form.get("range").is_some() && form.get("z_depth").is_some() {
            let message = "`range` and `z_depth` exclude each other; send one".to_owned();
            form.refuse("z_depth", message);
        }
        let mut files = Vec::new();
        let mut described = Vec::new();
        for role in InputRole::ALL {
            if let Some(bytes) = form.get(role.name()).cloned() {
                check_pixels(&mut form, role, announced_pixels(&bytes));
                described.push(InputFile {
                    role,
                    bytes: bytes.len() as u64,
                });
                files.push(bytes);
            }
        }
        let limit = "a whole number of 0 to 18446744073709551615";
        let stamp_ns = form.parsed("stamp_ns", limit, |_: &u64| true).unwrap_or(0);
        let camera = read_camera(&mut form);
        let pose = form.get("pose").map(|text| scenes::pose::read(text));
        let pose = pose.and_then(|read| read.map_err(|wrong| form.refuse_inside("pose", wrong)).ok());
        let job = read_job(&mut form, vocabulary);
        form.check()?;
        // Without one there was an error.
        let Some((job, picture_job)) = job else {
            return Err(Problem::internal(&"a form without a job passed its checks"));
        };
        Ok(Self {
            pixels: files.first().map_or(0, |rgb| announced_pixels(rgb)),
            request: PictureRequest {
                job: picture_job,
                stamp_ns,
                camera,
                pose,
                format,
                files: described,
            },
            job,
            files,
        })
    }

    /// The line of the request and the files.
    pub(crate) fn message(&self) -> Result<Vec<u8>, Problem> {
        let mut message = serde_json::to_vec(&self.request).map_err(|error| Problem::internal(&error))?;
        message.push(b'\n');
        self.files.iter().for_each(|file| message.extend_from_slice(file));
        Ok(message)
    }
}

/// Rejects large pictures by their headers, before anything is decoded.
fn check_pixels(form: &mut Form, role: InputRole, pixels: usize) {
    let (name, limit) = (role.name(), limits::RENDER_PIXELS);
    if pixels > limit {
        form.refuse(
            name,
            format!("`{name}` has {pixels} pixels; must be at most {limit}: make it smaller, or upload it as a scene"),
        );
    }
}

fn read_camera(form: &mut Form) -> Option<[[f64; 3]; 3]> {
    let text = form.texts("camera").next()?;
    match serde_json::from_str(&text) {
        Ok(matrix) => Some(matrix),
        Err(error) => {
            let message = format!("`camera` must be [[fx, 0, cx], [0, fy, cy], [0, 0, 1]]: {error}");
            form.refuse("camera", message);
            None
        }
    }
}

fn read_job(form: &mut Form, vocabulary: &Vocabulary) -> Option<(StreamJob, PictureJob)> {
    let text = form.get("frame")?.clone();
    if text.len() > limits::JSON_BYTES {
        let message = format!(
            "`frame` has {} bytes; must be at most {}",
            text.len(),
            limits::JSON_BYTES
        );
        form.refuse("frame", message);
        return None;
    }
    let written: Option<Value> = serde_json::from_slice(&text).ok();
    let parts = StreamParts {
        // Metrics are measured if the job names them.
        has_metrics: written.is_some_and(|written| written.get("metrics").is_some()),
        has_instances: form.get(InputRole::Instances.name()).is_some(),
    };
    let read = StreamJob::read(&text, parts, vocabulary);
    let job = read
        .map_err(|invalid: Invalid| form.refuse_inside("frame", invalid))
        .ok()?;
    let picture_job = PictureJob {
        description: job.job.canonical().to_owned(),
        gives_hfov: job.gives_hfov,
        has_metrics: parts.has_metrics,
        has_instances: parts.has_instances,
    };
    Some((job, picture_job))
}
