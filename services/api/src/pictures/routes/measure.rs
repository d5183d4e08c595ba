use quality::MetricId;
use serde::Deserialize;
use utoipa::{IntoParams, ToSchema};

use crate::decode::{MeasureRequest, Measured, Request};
use crate::http::form::{Form, Kind};
use crate::http::{Json, MultipartBody, Problem, Query, State, Topic};
use crate::pictures::Pictures;

/// The default metrics of a job.
const USUAL: &str = "entropy,uicm,uism,uiconm,uiqm,uciqe";

/// Selection of metrics.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(crate) struct Parameters {
    /// Metrics, separated by commas; `GET /v1/lists/metrics` lists them.
    #[param(default = "entropy,uicm,uism,uiconm,uiqm,uciqe", example = "uiqm,uiqm@table1")]
    metrics: Option<String>,
}

/// A user image.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes the body; the handler reads it")]
pub(crate) struct MeasureUpload {
    /// PNG, JPEG or WebP of at most 16 Mpx.
    #[schema(value_type = String, format = Binary)]
    picture: Vec<u8>,
    /// The clean image of the same size, for metrics that compare with it.
    #[schema(value_type = Option<String>, format = Binary)]
    clean: Option<Vec<u8>>,
}

/// Measure your image. Nothing is stored.
#[utoipa::path(post, path = "/v1/measure", tag = "pictures", operation_id = "measure_picture", params(Parameters),
    request_body(content = MeasureUpload, content_type = "multipart/form-data"),
    responses((status = 200, description = "The values.", body = Measured)))]
pub(crate) async fn measure(
    State(pictures): Topic<Pictures>,
    Query(query): Query<Parameters>,
    MultipartBody(body): MultipartBody,
) -> Result<Json<Measured>, Problem> {
    let metrics = metrics(query.metrics.as_deref().unwrap_or(USUAL))?;
    let fields = [("picture", Kind::File), ("clean", Kind::File)];
    let mut form = Form::read(body, &fields).await?;
    form.require("picture");
    form.check()?;
    let request = Request::Measure(MeasureRequest {
        picture: "picture".to_owned(),
        clean: form.get("clean").map(|_| "clean".to_owned()),
        metrics: metrics.iter().map(ToString::to_string).collect(),
    });
    let measured = pictures.run(&request, &form, &["picture", "clean"]).await?;
    Ok(Json(measured.reply))
}

fn metrics(list: &str) -> Result<Vec<MetricId>, Problem> {
    list.split(',')
        .map(str::trim)
        .map(|name| {
            MetricId::parse(name).ok_or_else(|| {
                let known: Vec<String> = MetricId::all().map(|id| id.to_string()).collect();
                let message = format!(
                    "metric `{name}` does not exist; must be one of {}",
                    known.join(", ")
                );
                Problem::field("/metrics", message)
            })
        })
        .collect()
}
