use axum::extract::Multipart;
use axum::http::StatusCode;
use style::is_name;
use utoipa::ToSchema;

use super::training::TrainingView;
use crate::http::extract::Submitter;
use crate::http::failure::writing;
use crate::http::form::{Form, Kind};
use crate::http::located::{Located, located};
use crate::http::{MultipartBody, Problem, State, Topic};
use crate::limits;
use crate::styles::Styles;
use crate::styles::trainings::{Order, photo_name};

const FIELDS: [(&str, Kind); 7] = [
    ("name", Kind::Text),
    ("photo", Kind::Files),
    ("seed", Kind::Text),
    ("steps", Kind::Text),
    ("range", Kind::Text),
    ("licence", Kind::Text),
    ("source", Kind::Text),
];

/// Photos and options of a training.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes the body; `read` reads it")]
pub(crate) struct TrainingUpload {
    /// Name of the new style in jobs: 1 to 64 characters of a-z, 0-9, `_` and `-`.
    #[schema(example = "harbour")]
    name: String,
    /// PNG, JPEG or WebP of the water; up to eight photos of the same water.
    #[schema(value_type = String, format = Binary)]
    photo: Vec<u8>,
    /// Random seed: the same photos, seed and steps yield the same network.
    #[schema(default = 1)]
    seed: Option<u64>,
    /// Steps, 1..=5000; 60 are enough for a preview.
    #[schema(default = 1000, minimum = 1, maximum = 5000)]
    steps: Option<u32>,
    /// Whether the network has a range input, so that contrast falls with range as in the photos. Jobs with such a
    /// style need scenes with a range.
    #[schema(default = false)]
    range: Option<bool>,
    /// License of the photos, and so of the style.
    #[schema(default = "unknown")]
    licence: Option<String>,
    /// Source of the photos.
    source: Option<String>,
}

/// Train a style from photos.
///
/// Unsuitable photos are rejected immediately. Trainings run in a separate process, one at a time, and callers take turns;
/// each may have half of the eight waiting ones. A thousand steps take about a minute on four free cores. Jobs may use the style as soon as the training is done. The service stores
/// the style, not the training: after a restart, submit an open training again.
#[utoipa::path(post, path = "/v1/styles/train", tag = "styles", operation_id = "train_style",
    request_body(content = TrainingUpload, content_type = "multipart/form-data"),
    responses((status = 202, description = "Accepted; `Location` is the training.", body = TrainingView),
              (status = 409, response = crate::openapi::Problem)))]
pub(crate) async fn train(
    State(styles): Topic<Styles>,
    Submitter { owner, .. }: Submitter,
    MultipartBody(body): MultipartBody,
) -> Result<Located<TrainingView>, Problem> {
    let training = styles.train(read(body, &styles, owner).await?).await?;
    let location = format!("/v1/styles/trainings/{}", training.id);
    let view = TrainingView::new(&training);
    Ok(located(StatusCode::ACCEPTED, location, view))
}

async fn read(body: Multipart, styles: &Styles, owner: String) -> Result<Order, Problem> {
    let mut form = Form::read(body, &FIELDS).await?;
    let seed_limit = format!("a whole number in 0..={}", u64::MAX);
    let seed = form.parsed("seed", &seed_limit, |_| true);
    let steps_limit = format!("a whole number in 1..={}", limits::STEPS);
    let steps = form.parsed("steps", &steps_limit, |steps| (1..=limits::STEPS).contains(steps));
    let range = form.parsed("range", "true or false", |_| true);
    let photos = form.all("photo").count();
    if photos > limits::PHOTOS {
        let message = format!("there are more than {} photos", limits::PHOTOS);
        form.refuse("photo", message);
    }
    form.check()?;
    form.require("photo");
    let name = form.text_or("name", "");
    if !is_name(&name) {
        let message = format!("name is `{name}`; must have 1 to 64 characters of a-z, 0-9, _ and -");
        form.refuse("name", message);
    }
    form.check()?;
    let folder = styles.temporary_folder().map_err(|error| writing(&error))?;
    for (index, bytes) in form.all("photo").enumerate() {
        let written = tokio::fs::write(folder.path().join(photo_name(index)), bytes).await;
        written.map_err(|error| writing(&error))?;
    }
    Ok(Order {
        owner,
        name,
        seed: seed.unwrap_or(1),
        steps: steps.unwrap_or(1000),
        range: range.unwrap_or(false),
        licence: form.text_or("licence", "unknown"),
        source: form.text_or("source", "trained from a user's photos"),
        photos,
        folder,
    })
}
