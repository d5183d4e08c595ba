use axum::http::header;
use axum::response::{IntoResponse, Response};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use style::ModelCard;
use utoipa::{IntoParams, ToSchema};

use crate::http::stored::GUARDED;
use crate::http::{Json, Path, Problem, Query, State, Topic, bounds};
use crate::openapi::{Bytes, StyleCard};
use crate::styles::Styles;
use crate::styles::trainings::{Progress, Training};

/// State of a training.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum TrainingState {
    /// Waiting for another training.
    Queued,
    /// Running.
    Running,
    /// Its style is available.
    Done,
    /// Failed; see `error`.
    Failed,
    /// Cancelled by the user.
    Cancelled,
}

/// A training.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Training)]
pub(crate) struct TrainingView {
    /// `trn_…`
    id: String,
    /// The name of the style.
    name: String,
    /// State.
    #[schema(example = "running")]
    state: TrainingState,
    /// Total steps.
    steps: u32,
    /// Random seed.
    seed: u64,
    /// Whether its network has a range input.
    range: bool,
    /// Steps done.
    done: u64,
    /// The losses of the newest steps.
    #[schema(value_type = Option<style::LossTerms>)]
    losses: Value,
    /// Time of its preview, Unix time in milliseconds; null: none.
    preview_ms: Option<u64>,
    /// Why it failed.
    error: Option<String>,
    /// The card of the style, as in the list of styles.
    #[schema(value_type = Option<StyleCard>)]
    card: Option<ModelCard>,
}

impl TrainingView {
    pub(crate) fn new(training: &Training) -> Self {
        let order = &training.order;
        let progress = training.progress();
        let (state, error, card) = match training.state() {
            Progress::Open if progress.is_some() => (TrainingState::Running, None, None),
            Progress::Open => (TrainingState::Queued, None, None),
            Progress::Done(card) => (TrainingState::Done, None, Some(*card)),
            Progress::Failed(why) => (TrainingState::Failed, Some(why), None),
            Progress::Cancelled => (TrainingState::Cancelled, None, None),
        };
        let progress = progress.unwrap_or_default();
        let done = match state {
            TrainingState::Done => u64::from(order.steps),
            _ => progress["done"].as_u64().unwrap_or_default(),
        };
        Self {
            id: training.id.clone(),
            name: order.name.clone(),
            state,
            steps: order.steps,
            seed: order.seed,
            range: order.range,
            done,
            losses: progress["losses"].clone(),
            preview_ms: training.previewed_ms(),
            error,
            card,
        }
    }
}

/// Long-poll parameters.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(crate) struct Parameters {
    /// Maximum seconds to wait for its end, 0..=60.
    #[param(default = 0, maximum = 60)]
    wait: Option<u64>,
}

/// Get a training, or wait for its end.
#[utoipa::path(get, path = "/v1/styles/trainings/{id}", tag = "styles", operation_id = "get_training",
    params(("id" = String, Path, description = "`trn_…`"), Parameters),
    responses((status = 200, description = "The present state of the training.", body = TrainingView)))]
pub(crate) async fn get(
    State(styles): Topic<Styles>,
    Path(id): Path<String>,
    Query(query): Query<Parameters>,
) -> Result<Json<TrainingView>, Problem> {
    let limit = bounds::check_wait(query.wait)?;
    let training = styles.trainings.get(&id)?;
    styles.wait(&training, limit).await;
    Ok(Json(TrainingView::new(&training)))
}

/// Get a preview of the style in training: a scene rendered with it.
///
/// It is updated every few seconds while the training runs; `preview_ms` of the training is its time. Only the newest
/// is kept, and only until the training ends.
#[utoipa::path(get, path = "/v1/styles/trainings/{id}/preview", tag = "styles", operation_id = "get_training_preview",
    params(("id" = String, Path, description = "`trn_…`")),
    responses((status = 200, description = "The image.", body = Bytes, content_type = "image/png")))]
pub(crate) async fn preview(
    State(styles): Topic<Styles>,
    Path(id): Path<String>,
) -> Result<Response, Problem> {
    let training = styles.trainings.get(&id)?;
    let found = styles.processes.compute.run(move || training.preview()).await?;
    let bytes = found.ok_or_else(|| Problem::not_found(format!("no preview of training `{id}` now")))?;
    let head = [
        (header::CONTENT_TYPE, "image/png"),
        (header::CACHE_CONTROL, "no-store"),
    ];
    Ok((head, GUARDED, bytes).into_response())
}

/// Cancel a training.
///
/// Its results are deleted. Cancelling a training that has ended has no effect.
#[utoipa::path(delete, path = "/v1/styles/trainings/{id}", tag = "styles", operation_id = "cancel_training",
    params(("id" = String, Path, description = "`trn_…`")),
    responses((status = 200, description = "The present state of the training.", body = TrainingView)))]
pub(crate) async fn delete(
    State(styles): Topic<Styles>,
    Path(id): Path<String>,
) -> Result<Json<TrainingView>, Problem> {
    let training = styles.cancel(&id).await?;
    Ok(Json(TrainingView::new(&training)))
}
