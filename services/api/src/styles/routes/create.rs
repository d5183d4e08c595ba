use axum::extract::Multipart;
use serde::de::DeserializeOwned;
use style::{InputScale, Layout, ModelCard, ModelRole, SizeRule};
use utoipa::ToSchema;

use crate::http::form::{Form, Kind};
use crate::http::located::{Located, created, located};
use crate::http::{MultipartBody, Problem, State, Topic};
use crate::openapi::StyleCard;
use crate::styles::Styles;
use crate::styles::new_style::NewStyle;

const FIELDS: [(&str, Kind); 12] = [
    ("name", Kind::Text),
    ("model", Kind::File),
    ("architecture", Kind::Text),
    ("source", Kind::Text),
    ("licence", Kind::Text),
    ("alpha", Kind::Text),
    ("caveat", Kind::Texts),
    ("scale", Kind::Text),
    ("role", Kind::Text),
    ("input_scale", Kind::Text),
    ("layout", Kind::Text),
    ("size", Kind::Text),
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
    /// Styles only: the value of white in its inputs and outputs, such as 255; absent: 1.
    scale: Option<f32>,
    /// Its use in jobs; absent: `style`. An `enhancer` maps a picture to one of the same size, a `metric` maps a picture to one
    /// number.
    role: Option<ModelRole>,
    /// Enhancers and metrics only: the values of black and white, of an enhancer also in its output; absent: `0..1`.
    input_scale: Option<InputScale>,
    /// Enhancers and metrics only: the order of the axes; absent: `NCHW`.
    layout: Option<Layout>,
    /// Enhancers and metrics only: the sizes that it takes, `any`, `multiple of N` or `fixed WxH`; absent: `any`.
    #[schema(value_type = Option<String>, example = "multiple of 32")]
    size: Option<SizeRule>,
}

/// Add your style, enhancer or metric network.
///
/// The network is tried in a separate process on frames of 1×1, of odd sides and of 768×492: it must load, return
/// finite images, and be deterministic. Then jobs may use it. Repeating an upload returns 200. Styles are never
/// replaced or deleted, because images reference them. The stability of an added style is not measured; its card
/// contains this caveat.
///
/// An enhancer or a metric is tried on pictures of these sizes, or of its only size: an enhancer must return finite pictures of the
/// right size, not of one value; a metric one finite number, not the same for every picture.
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
    let role = read_word(&mut form, "role");
    let input_scale = read_word(&mut form, "input_scale");
    let layout = read_word(&mut form, "layout");
    let size = read_word(&mut form, "size");
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
    card.role = role.unwrap_or_default();
    card.takes_noise &= card.role == ModelRole::Style;
    card.takes_range &= card.role == ModelRole::Style;
    (card.input_scale, card.layout, card.size) = (input_scale, layout, size);
    for (field, reason) in card.foreign_fields() {
        form.refuse(field, format!("`{field}` {reason}"));
    }
    form.check()?;
    card.declare_input();
    Ok(new)
}

/// A word of a card, with an error if it is not one of the allowed words.
fn read_word<T: DeserializeOwned>(form: &mut Form, field: &str) -> Option<T> {
    let text = form.texts(field).next()?;
    match serde_json::from_value(text.clone().into()) {
        Ok(word) => Some(word),
        Err(error) => {
            form.refuse(field, format!("`{field}` is {text}: {error}"));
            None
        }
    }
}
