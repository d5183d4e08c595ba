//! `POST /v1/styles/train`.

use axum::Json;
use axum::extract::multipart::Field;
use axum::extract::{Multipart, State};
use axum::http::{HeaderName, StatusCode, header};
use style::is_name;
use tempfile::TempDir;
use utoipa::ToSchema;

use super::create::text;
use super::training::TrainingView;
use crate::app::Shared;
use crate::http::extract::MultipartBody;
use crate::http::failure::writing;
use crate::http::problem::Problem;
use crate::limits;
use crate::scenes::form::{broken, too_many};
use crate::styles::trainings::{Order, photo, start};

const FIELDS: [&str; 6] = ["name", "photo", "seed", "steps", "licence", "source"];

/// The photo and what to make of it.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes the body; `read` reads it field by field")]
pub(crate) struct TrainingUpload {
    /// Name by which jobs will ask for it: 1 to 64 characters of a-z, 0-9, `_` and `-`.
    #[schema(example = "harbour")]
    name: String,
    /// PNG, JPEG or WebP of the water; up to eight photos of the same water may be given.
    #[schema(value_type = String, format = Binary)]
    photo: Vec<u8>,
    /// Seed of all chance: the same photos, seed and steps give the same network.
    #[schema(default = 1)]
    seed: Option<u64>,
    /// Steps, 1..=5000; 60 are enough for a first look.
    #[schema(default = 1000, minimum = 1, maximum = 5000)]
    steps: Option<u32>,
    /// Terms under which the photo, and so the style, may be used.
    #[schema(default = "unknown")]
    licence: Option<String>,
    /// Where the photo comes from.
    source: Option<String>,
}

/// Train a style from a photo.
///
/// Photos that cannot be learned from are refused at once. The training runs in a process of its own, one at a time; a
/// thousand steps take about a minute on four free cores. When it is done jobs may name the style at once. The service
/// keeps the style, not the training: after a restart, an open training must be asked for again.
#[utoipa::path(post, path = "/v1/styles/train", tag = "waters",
    request_body(content = TrainingUpload, content_type = "multipart/form-data"),
    responses((status = 202, description = "Accepted; `Location` is the training.", body = TrainingView),
              (status = 409, response = crate::openapi::Problem),
              (status = 422, response = crate::openapi::Problem)))]
pub(crate) async fn train(
    State(app): State<Shared>,
    MultipartBody(body): MultipartBody,
) -> Result<(StatusCode, [(HeaderName, String); 1], Json<TrainingView>), Problem> {
    let order = read(body).await?;
    let training = start(&app, order).await?;
    let location = format!("/v1/styles/trainings/{}", training.id);
    let view = TrainingView::of(&training);
    Ok((StatusCode::ACCEPTED, [(header::LOCATION, location)], Json(view)))
}

async fn read(mut body: Multipart) -> Result<Order, Problem> {
    let folder = TempDir::new().map_err(|error| writing(&error))?;
    let mut order = Order {
        name: String::new(),
        seed: 1,
        steps: 1000,
        licence: "unknown".to_owned(),
        source: "trained from photos given by a user of the service".to_owned(),
        photos: 0,
        folder,
    };
    let mut seen = Vec::new();
    while let Some(field) = body.next_field().await.map_err(|error| broken(&error))? {
        let name = field.name().unwrap_or_default().to_owned();
        if seen.len() == limits::FORM_FIELDS {
            return Err(too_many());
        }
        let refuse = |why: String| Problem::field(&format!("/{name}"), why);
        if !FIELDS.contains(&name.as_str()) {
            return Err(refuse(format!(
                "there is no field `{name}`; fields are {}",
                FIELDS.join(", ")
            )));
        }
        if name != "photo" && seen.contains(&name) {
            return Err(refuse(format!("`{name}` is given twice")));
        }
        match name.as_str() {
            "photo" => take_photo(&mut order, field).await?,
            "name" => order.name = text(field).await?,
            "licence" => order.licence = text(field).await?,
            "source" => order.source = text(field).await?,
            "seed" => {
                let given = text(field).await?;
                let limit = format!("must be a whole number in 0..={}", u64::MAX);
                let seed = given.trim().parse();
                order.seed = seed.map_err(|_| refuse(format!("seed is `{given}` but {limit}")))?;
            }
            _ => {
                let given = text(field).await?;
                let steps = given
                    .trim()
                    .parse()
                    .ok()
                    .filter(|steps| (1..=limits::STEPS).contains(steps));
                let limit = format!("must be a whole number in 1..={}", limits::STEPS);
                order.steps = steps.ok_or_else(|| refuse(format!("steps is `{given}` but {limit}")))?;
            }
        }
        seen.push(name);
    }
    if order.photos == 0 {
        return Err(Problem::field("/photo", "`photo` is missing"));
    }
    if !is_name(&order.name) {
        let message = format!(
            "name is `{}` but must have 1 to 64 characters of a-z, 0-9, _ and -",
            order.name
        );
        return Err(Problem::field("/name", message));
    }
    Ok(order)
}

async fn take_photo(order: &mut Order, field: Field<'_>) -> Result<(), Problem> {
    if order.photos == limits::PHOTOS {
        let message = format!("there are more than {} photos", limits::PHOTOS);
        return Err(Problem::field("/photo", message));
    }
    let bytes = field.bytes().await.map_err(|error| broken(&error))?;
    let file = order.folder.path().join(photo(order.photos));
    tokio::fs::write(&file, &bytes)
        .await
        .map_err(|error| writing(&error))?;
    order.photos += 1;
    Ok(())
}
