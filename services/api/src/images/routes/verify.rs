//! `POST /v1/images/{job}/{frame}/verify`.

use std::sync::Arc;

use catalogue::StoredArtifact;
use serde::{Deserialize, Serialize};
use spec::ArtifactEntry;
use store::StoreError;
use utoipa::ToSchema;

use crate::bytes::sets::Unread;
use crate::http::{Json, JsonBytes, Path, Problem, Slug, State, Topic};
use crate::images::Images;
use crate::images::rerender::{Again, difference};

/// What to verify.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Wish {
    /// Also render the frame again and compare.
    #[serde(default)]
    #[schema(default = false)]
    rerender: bool,
}

/// What became of stored bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum StoredBytes {
    /// They are as they were stored.
    Good,
    /// They are others.
    Corrupt,
    /// They are gone.
    Missing,
}

/// An artifact and what was found.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct VerifiedArtifact {
    /// Such as `rgb`.
    kind: String,
    /// SHA-256 that its record names.
    digest: String,
    /// What became of its bytes.
    stored: StoredBytes,
    /// SHA-256 of what the frame renders to now; null: it was not rendered, or has no such artifact any more.
    rerendered_digest: Option<String>,
    /// Largest difference of the two in codes of a picture, or in the unit of a linear layer; null: not compared.
    largest_difference: Option<f64>,
}

/// What was found.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct Verified {
    /// Whether every artifact is stored as it was.
    intact: bool,
    /// Whether the frame renders to the same bytes now; null: it was not rendered.
    reproduced: Option<bool>,
    /// One entry for each artifact.
    artifacts: Vec<VerifiedArtifact>,
    /// What is different about this program, machine or models, where the bytes are; a reason, not a fault.
    differences: Vec<String>,
}

/// Verify an image: hash its stored bytes, and render it again if wished.
///
/// It is rendered by a process of its own, which may take two minutes. Bytes are the same on one build, one ONNX Runtime
/// and one CPU feature set; elsewhere `largest_difference` says how far they are apart.
#[utoipa::path(post, path = "/v1/images/{job}/{frame}/verify", tag = "images", operation_id = "verify_image",
    params(("job" = String, Path, description = "`job_…`"), ("frame" = u64, Path, description = "From 0")),
    request_body(content = Wish, content_type = "application/json"),
    responses((status = 200, description = "What was found.", body = Verified)))]
pub(crate) async fn verify(
    State(images): Topic<Images>,
    Path((job, frame)): Path<(String, u64)>,
    JsonBytes(body): JsonBytes,
) -> Result<Json<Verified>, Problem> {
    let wish: Wish =
        serde_json::from_slice(&body).map_err(|error| Problem::new(Slug::InvalidBody, error.to_string()))?;
    let image = images.get(&job, frame).await?;
    let entries = Vec::<ArtifactEntry>::deserialize(&image["artifacts"]);
    let entries = entries.map_err(|error| Problem::internal(&error))?;
    let again = match wish.rerender {
        true => Some(Arc::new(images.rerender(&job, frame).await?)),
        false => None,
    };
    let mut artifacts = Vec::with_capacity(entries.len());
    for entry in entries {
        let artifact = images.artifact(&job, frame, &entry.kind).await?;
        artifacts.push(compared(&images, artifact, again.clone()).await?);
    }
    let same = |artifact: &VerifiedArtifact| artifact.rerendered_digest.as_ref() == Some(&artifact.digest);
    Ok(Json(Verified {
        intact: artifacts
            .iter()
            .all(|artifact| artifact.stored == StoredBytes::Good),
        reproduced: again.as_ref().map(|_| artifacts.iter().all(same)),
        differences: again.map_or_else(Vec::new, |again| differences(&image, &again)),
        artifacts,
    }))
}

async fn compared(
    images: &Images,
    artifact: StoredArtifact,
    again: Option<Arc<Again>>,
) -> Result<VerifiedArtifact, Problem> {
    let (stored, bytes) = condition(images, &artifact).await?;
    let entry = artifact.entry;
    let rerendered = again.as_ref().and_then(|again| {
        let artifacts = &again.record.artifacts;
        artifacts
            .iter()
            .find(|artifact| artifact.kind == entry.kind)
            .cloned()
    });
    let largest_difference = match (again, bytes) {
        (Some(again), Some(bytes)) => {
            let kind = entry.kind.clone();
            let compare = move || again.bytes(&kind).and_then(|again| difference(&bytes, &again));
            images.processes.compute.run(compare).await?
        }
        _ => None,
    };
    Ok(VerifiedArtifact {
        kind: entry.kind,
        digest: entry.digest,
        stored,
        rerendered_digest: rerendered.map(|artifact| artifact.digest),
        largest_difference,
    })
}

/// Whether the bytes of an artifact are what was stored, and the bytes if they are.
pub(crate) async fn condition(
    images: &Images,
    artifact: &StoredArtifact,
) -> Result<(StoredBytes, Option<Vec<u8>>), Problem> {
    let Some(place) = &artifact.place else {
        return match images.bytes.store.get(&artifact.entry.digest).await {
            Ok(Some(bytes)) => Ok((StoredBytes::Good, Some(bytes))),
            Ok(None) => Ok((StoredBytes::Missing, None)),
            Err(StoreError::Corrupt { .. }) => Ok((StoredBytes::Corrupt, None)),
            Err(error) => Err(error.into()),
        };
    };
    match images.bytes.sets.read(place, &artifact.entry).await {
        Ok(bytes) => Ok((StoredBytes::Good, Some(bytes))),
        Err(Unread::Gone(_)) => Ok((StoredBytes::Missing, None)),
        Err(Unread::Differs(_)) => Ok((StoredBytes::Corrupt, None)),
        Err(error) => Err(error.into()),
    }
}

/// Where the circumstances differ from those of the record.
fn differences(record: &serde_json::Value, again: &Again) -> Vec<String> {
    let now = serde_json::to_value(&again.record.provenance).unwrap_or_default();
    let names = ["code_version", "onnx_runtime", "cpu_features", "inputs"];
    let changed = names.into_iter().filter_map(|name| {
        let (then, now) = (record.pointer(&format!("/provenance/{name}"))?, now.get(name)?);
        (then != now).then(|| format!("{name} was {then} and is {now}"))
    });
    changed.collect()
}
