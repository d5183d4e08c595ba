//! The parts of the OpenAPI document without a handler.

mod bodies;
mod description;
mod document;
mod laws;
mod leaf;
mod problems;

use utoipa::openapi::OpenApi;
use utoipa::openapi::RefOr;
use utoipa::openapi::schema::{ObjectBuilder, Schema};
use utoipa::openapi::security::{Http, HttpAuthScheme, SecurityScheme};
use utoipa::{Modify, OpenApi as _, PartialSchema, ToResponse, ToSchema};

use crate::http::picture::PictureFormat;
use crate::http::problem::Slug;

pub(crate) use bodies::{ImageRecord, ImageRow, StyleCard};
pub(crate) use document::document;

/// Declares components whose schemas are generated when the document is assembled.
macro_rules! written {
    ($($(#[doc = $about:literal])+ $Name:ident;)*) => {$(
        $(#[doc = $about])+
        pub(crate) struct $Name;

        impl ToSchema for $Name {}

        impl PartialSchema for $Name {
            fn schema() -> RefOr<Schema> {
                ObjectBuilder::new().into()
            }
        }
    )*};
}

written! {
    /// The body of a job: a frame description with distributions in place of values.
    JobDescription;
    /// A user-defined water.
    NewWater;
    /// The type of a problem.
    ProblemType;
    /// The name of a built-in list.
    ListName;
    /// The bytes of a file.
    Bytes;
}

/// A problem (RFC 9457).
#[derive(ToResponse, ToSchema)]
#[response(
    description = "A problem; `type` is its kind.",
    content_type = "application/problem+json"
)]
#[expect(dead_code, reason = "describes the body, which is built member by member")]
pub(crate) struct Problem {
    /// `/problems/<slug>`; `GET /v1/lists/problems` lists them.
    #[schema(value_type = ProblemType, example = "/problems/validation")]
    r#type: String,
    /// The same for every problem of the type.
    #[schema(example = "The description is not valid")]
    title: String,
    /// The HTTP status.
    #[schema(example = 422)]
    status: u16,
    /// Description of this occurrence.
    #[schema(example = "alpha is 1.2; must be in 0..=1")]
    detail: String,
    /// The request id, as in the header `X-Request-Id` and in the log.
    #[schema(example = "req_0198c0ffee007000800000000000000a")]
    instance: String,
    /// All errors of a description.
    errors: Option<Vec<FieldError>>,
    /// Position of the error in a filter, in characters from 0.
    position: Option<usize>,
    /// The parameter of a query that is not valid, if it is not the filter.
    #[schema(example = "order_by")]
    parameter: Option<String>,
}

/// One error of a description.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes the body; `spec` writes it")]
pub(crate) struct FieldError {
    /// JSON pointer to the value.
    #[schema(example = "/alpha")]
    pointer: String,
    /// Message with the field, its value and the limit.
    #[schema(example = "alpha is 1.2; must be in 0..=1")]
    message: String,
    /// The rejected value.
    value: Option<serde_json::Value>,
    /// The limit.
    #[schema(example = "0..=1")]
    limit: Option<String>,
    /// The allowed names.
    allowed: Option<Vec<String>>,
    /// The nearest allowed name.
    did_you_mean: Option<String>,
}

#[derive(utoipa::OpenApi)]
#[openapi(
    info(title = "Fathom", version = env!("CARGO_PKG_VERSION"), license(name = "MIT OR Apache-2.0")),
    components(responses(Problem), schemas(Problem, FieldError, PictureFormat)),
    modifiers(&Bearer, &ProblemTypes),
    security(("token" = [])),
    tags((name = "jobs", description = "Submitting descriptions and following them"),
         (name = "images", description = "Rendered images"),
         (name = "datasets", description = "Collections of images"),
         (name = "sets", description = "Datasets in a folder or a bucket, made without this service"),
         (name = "scenes", description = "Your images and ranges"),
         (name = "pictures", description = "Enhancing and measuring your images"),
         (name = "waters", description = "Optical waters"),
         (name = "styles", description = "Style waters: networks that repaint a frame"),
         (name = "lists", description = "Identifiers accepted in requests"),
         (name = "operations", description = "Operation of the service"))
)]
struct Frame;

struct Bearer;

impl Modify for Bearer {
    fn modify(&self, document: &mut OpenApi) {
        let scheme = SecurityScheme::Http(Http::new(HttpAuthScheme::Bearer));
        document
            .components
            .get_or_insert_default()
            .add_security_scheme("token", scheme);
    }
}

struct ProblemTypes;

impl Modify for ProblemTypes {
    fn modify(&self, document: &mut OpenApi) {
        let mut text = String::from(
            "Underwater image datasets on demand. Every error response is a problem (RFC 9457) of one of these types.\n\n\
             | type | status | meaning |\n|---|---|---|\n",
        );
        for slug in Slug::ALL {
            let row = format!(
                "| `/problems/{}` | {} | {} |\n",
                slug.name(),
                slug.status().as_u16(),
                slug.meaning()
            );
            text.push_str(&row);
        }
        document.info.description = Some(text);
    }
}

/// The document without paths, which the router adds.
pub(crate) fn frame() -> OpenApi {
    Frame::openapi()
}
