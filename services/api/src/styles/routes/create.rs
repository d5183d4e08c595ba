use axum::extract::Multipart;
use style::ModelCard;
use utoipa::ToSchema;

use crate::http::form::{Form, Kind};
use crate::http::located::{Located, created, located};
use crate::http::{MultipartBody, Problem, State, Topic};
use crate::openapi::StyleCard;
use crate::styles::Styles;
use crate::styles::new_style::NewStyle;

const FIELDS: [(&str, Kind); 8] = [
    ("name", Kind::Text),
    ("model", Kind::File),
    ("architecture", Kind::Text),
    ("source", Kind::Text),
    ("licence", Kind::Text),
    ("alpha", Kind::Text),
    ("caveat", Kind::Texts),
    ("scale", Kind::Text),
];

/// The fields of a style upload.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes the body; `read` reads it")]
pub(crate) struct StyleUpload {
    /// Name of the style in jobs: 1 to 64 characters of a-z, 0-9, `_` and `-`.
    #[schema(example = "harbour")]
    name: String,
    /// The ONNX file with all tensors inside: an input `image` and an output `styled`, float32 `[1, 3, height,
    /// width]` of any size, sRGB-encoded in 0..=1; optionally an input `noise` `[1, 1, height, width]`, standard
    /// normal, seeded by job and frame.
    #[schema(value_type = String, format = Binary)]
    model: Vec<u8>,
    /// Kind of network.
    architecture: Option<String>,
    /// Training data.
    source: Option<String>,
    /// License of the model.
    licence: Option<String>,
    /// Effect of the style weight on its output.
    alpha: Option<String>,
    /// Caveat for users; repeatable.
    caveat: Option<String>,
    /// The value of white in its inputs and outputs, such as 255; absent: 1.
    scale: Option<f32>,
}

/// Add your style.
///
/// The network is tried in a separate process on frames of 1×1, of odd sides and of 768×492: it must load, return
/// finite images, and be deterministic. Then jobs may use it. Repeating an upload returns 200. Styles are never
/// replaced or deleted, because images reference them. The stability of an added style is not measured; its card
/// contains this caveat.
#[utoipa::path(post, path = "/v1/styles", tag = "styles", operation_id = "add_style",
    request_body(content = StyleUpload, content_type = "multipart/form-data"),
    responses((status = 201, description = "Added: its card.", body = StyleCard),
              (status = 200, description = "Already stored.", body = StyleCard),
              (status = 409, response = crate::openapi::Problem)))]
pub(crate) async fn create(
    State(styles): Topic<Styles>,
    MultipartBody(body): MultipartBody,
) -> Result<Located<ModelCard>, Problem> {
    let (card, new) = styles.add(read(body).await?).await?;
    Ok(located(created(new), "/v1/styles".to_owned(), card))
}

async fn read(body: Multipart) -> Result<NewStyle, Problem> {
    let mut form = Form::read(body, &FIELDS).await?;
    form.require("name");
    form.require("model");
    let scale = form.parsed("scale", "a number above 0 and at most 65535", |scale: &f32| {
        style::is_scale(*scale)
    });
    form.check()?;
    let model = form.get("model").map(|model| model.to_vec()).unwrap_or_default();
    let mut new = NewStyle::new(&form.text_or("name", ""), model)?;
    let card = &mut new.card;
    card.architecture = form.text_or("architecture", &card.architecture);
    card.source = form.text_or("source", &card.source);
    card.licence = form.text_or("licence", &card.licence);
    card.alpha = form.text_or("alpha", &card.alpha);
    card.caveats.extend(form.texts("caveat"));
    card.scale = scale;
    Ok(new)
}
