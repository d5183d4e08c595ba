//! `POST /v1/styles`.

use axum::Json;
use axum::extract::multipart::Field;
use axum::extract::{Multipart, State};
use axum::http::{HeaderName, StatusCode, header};
use style::Card;
use utoipa::ToSchema;

use crate::app::Shared;
use crate::http::extract::MultipartBody;
use crate::http::problem::Problem;
use crate::limits;
use crate::scenes::form::{broken, too_many};
use crate::styles::{NewStyle, add};

/// The names of all fields.
const FIELDS: [&str; 7] = [
    "name",
    "model",
    "architecture",
    "source",
    "licence",
    "alpha",
    "caveat",
];

/// The fields of a style upload.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes the body; `Form` reads it field by field")]
pub(crate) struct StyleUpload {
    /// Name by which jobs ask for it: 1 to 64 characters of a-z, 0-9, `_` and `-`.
    #[schema(example = "harbour")]
    name: String,
    /// The ONNX file, all of its tensors in it: an input `image` and an output `styled`, float32
    /// `[1, 3, height, width]` of any size, sRGB-encoded in 0..=1; and, if it wants one, an input `noise`
    /// `[1, 1, height, width]`, standard normal, of the job's seed and the frame.
    #[schema(value_type = String, format = Binary)]
    model: Vec<u8>,
    /// What kind of network it is.
    architecture: Option<String>,
    /// What it was trained on.
    source: Option<String>,
    /// Under what terms it may be used.
    licence: Option<String>,
    /// What the style weight does with its output.
    alpha: Option<String>,
    /// What a user should know; may be given several times.
    caveat: Option<String>,
}

/// Add a style of your own.
///
/// The network is tried in a process of its own on frames of 1×1, of odd sides and of 768×492: it must load, answer a
/// finite picture each time, and the same one to the same frame. Then jobs may name it at once. The same network under
/// the same name again answers 200. Styles are never replaced or deleted, since images name them. Nobody has measured
/// how stable a style of your own is; its card says so.
#[utoipa::path(post, path = "/v1/styles", tag = "waters",
    request_body(content = StyleUpload, content_type = "multipart/form-data"),
    responses((status = 201, description = "Added: its card.", body = Value),
              (status = 200, description = "It was there already.", body = Value),
              (status = 409, response = crate::openapi::Problem),
              (status = 422, response = crate::openapi::Problem)))]
pub(crate) async fn create(
    State(app): State<Shared>,
    MultipartBody(body): MultipartBody,
) -> Result<(StatusCode, [(HeaderName, &'static str); 1], Json<Card>), Problem> {
    let new = read(body).await?;
    let (card, is_new) = add(&app, new).await?;
    let status = if is_new {
        StatusCode::CREATED
    } else {
        StatusCode::OK
    };
    Ok((status, [(header::LOCATION, "/v1/styles")], Json(card)))
}

/// Reads all fields of the form.
async fn read(mut body: Multipart) -> Result<NewStyle, Problem> {
    let (mut model, mut texts) = (None, Vec::<(String, String)>::new());
    while let Some(field) = body.next_field().await.map_err(|error| broken(&error))? {
        if texts.len() == limits::FORM_FIELDS {
            return Err(too_many());
        }
        let name = field.name().unwrap_or_default().to_owned();
        let pointer = format!("/{name}");
        if !FIELDS.contains(&name.as_str()) {
            let fields = FIELDS.join(", ");
            let message = format!("there is no field `{name}`; fields are {fields}");
            return Err(Problem::field(&pointer, message));
        }
        let twice = model.is_some() && name == "model" || texts.iter().any(|(seen, _)| *seen == name);
        if twice && name != "caveat" {
            return Err(Problem::field(&pointer, format!("`{name}` is given twice")));
        }
        if name == "model" {
            model = Some(field.bytes().await.map_err(|error| broken(&error))?);
        } else {
            texts.push((name, text(field).await?));
        }
    }
    let missing = |name: &str| Problem::field(&format!("/{name}"), format!("`{name}` is missing"));
    let name = texts.iter().find(|(field, _)| field == "name");
    let name = &name.ok_or_else(|| missing("name"))?.1;
    let mut new = NewStyle::new(name, model.ok_or_else(|| missing("model"))?.into())?;
    for (field, text) in &texts {
        let text = text.clone();
        match field.as_str() {
            "architecture" => new.card.architecture = text,
            "source" => new.card.source = text,
            "licence" => new.card.licence = text,
            "alpha" => new.card.alpha = text,
            "caveat" => new.card.caveats.push(text),
            _ => {}
        }
    }
    Ok(new)
}

/// A text of bearable length.
pub(super) async fn text(mut field: Field<'_>) -> Result<String, Problem> {
    let name = field.name().unwrap_or_default().to_owned();
    let refuse = |why: String| Problem::field(&format!("/{name}"), format!("`{name}` {why}"));
    let mut bytes = Vec::new();
    while let Some(chunk) = field.chunk().await.map_err(|error| broken(&error))? {
        bytes.extend_from_slice(&chunk);
        if bytes.len() > limits::CARD_TEXT_BYTES {
            return Err(refuse(format!("has more than {} bytes", limits::CARD_TEXT_BYTES)));
        }
    }
    String::from_utf8(bytes).map_err(|_| refuse("is not UTF-8".to_owned()))
}
