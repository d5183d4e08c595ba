use axum::http::{HeaderName, HeaderValue, header};
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use spec::{Enhancement, FieldError, Invalid};
use utoipa::{IntoParams, ToSchema};

use crate::decode::{EnhanceRequest, Request};
use crate::http::form::{Form, Kind};
use crate::http::picture::PictureFormat;
use crate::http::stored::GUARDED;
use crate::http::{MultipartBody, Problem, Query, State, Topic};
use crate::openapi::Bytes;
use crate::pictures::Pictures;

/// Codes of the method's known failures with this image.
const WARNINGS: HeaderName = HeaderName::from_static("fathom-warnings");

/// Method and output.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(crate) struct Parameters {
    /// A method, as in `hscm` or `hscm:cutoff=16,mask=paper`, or an enhancement in JSON as in a job.
    #[param(value_type = String, example = "hscm")]
    method: String,
    /// Image format of the response.
    #[serde(default)]
    #[param(default = "png")]
    format: PictureFormat,
}

/// A user image.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes the body; the handler reads it")]
pub(crate) struct EnhanceUpload {
    /// PNG, JPEG or WebP of at most 16 Mpx.
    #[schema(value_type = String, format = Binary)]
    picture: Vec<u8>,
}

/// Enhance your image. Nothing is stored.
///
/// `Fathom-Warnings` lists known failures of the method with this image.
#[utoipa::path(post, path = "/v1/enhance", tag = "pictures", operation_id = "enhance_picture", params(Parameters),
    request_body(content = EnhanceUpload, content_type = "multipart/form-data"),
    responses((status = 200, description = "The enhanced image, 8 bit.",
               content((Bytes = "image/png"), (Bytes = "image/webp")))))]
pub(crate) async fn enhance(
    State(pictures): Topic<Pictures>,
    Query(query): Query<Parameters>,
    MultipartBody(body): MultipartBody,
) -> Result<Response, Problem> {
    Enhancement::parse(&query.method).map_err(|Invalid(errors)| {
        let in_parameter = errors.into_iter().map(|error| FieldError {
            pointer: format!("/method{}", error.pointer),
            ..error
        });
        Problem::from(Invalid(in_parameter.collect()))
    })?;
    let mut form = Form::read(body, &[("picture", Kind::File)]).await?;
    form.require("picture");
    form.check()?;
    let media_type = match query.format {
        PictureFormat::Png => "image/png",
        PictureFormat::Webp => "image/webp",
    };
    let request = Request::Enhance(EnhanceRequest {
        picture: "picture".to_owned(),
        method: query.method,
        is_webp: matches!(query.format, PictureFormat::Webp),
    });
    let enhanced = pictures.run::<String>(&request, &form, &["picture"]).await?;
    let (bytes, warnings) = (enhanced.result().await?, &enhanced.reply);
    let media_type = [(header::CONTENT_TYPE, media_type)];
    let mut response = (media_type, GUARDED, bytes).into_response();
    if let Ok(codes) = HeaderValue::from_str(warnings) {
        response.headers_mut().insert(WARNINGS, codes);
    }
    Ok(response)
}
