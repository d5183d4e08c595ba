use std::sync::Arc;

use catalogue::StoredArtifact;
use serde::{Deserialize, Serialize};
use spec::{Agreement, ArtifactEntry, FrameRecord, RecordDifference, compare_records};
use store::StoreError;
use utoipa::ToSchema;

use crate::bytes::sets::Unread;
use crate::http::{Json, JsonBytes, Path, Problem, Slug, State, Topic};
use crate::images::Images;
use crate::images::rerender::{Again, difference};

/// Options of a verification.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Wish {
    /// Also render the frame again and compare.
    #[serde(default)]
    #[schema(default = false)]
    rerender: bool,
}

/// Condition of stored bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum StoredBytes {
    /// Unchanged.
    Good,
    /// Changed.
    Corrupt,
    /// Missing.
    Missing,
}

/// Result for one artifact.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct VerifiedArtifact {
    /// Such as `rgb`.
    kind: String,
    /// SHA-256 in the image's record.
    digest: String,
    /// Condition of its bytes.
    stored: StoredBytes,
    /// SHA-256 of the artifact rendered again; null: not rendered, or the frame no longer has it.
    rerendered_digest: Option<String>,
    /// Maximum difference of the two, in codes of an image or in the unit of a linear layer; null: not compared.
    largest_difference: Option<f64>,
}

/// Result of a verification.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct Verified {
    /// Whether every artifact is unchanged.
    intact: bool,
    /// Whether the frame renders to the same bytes and the same record now; null: not rendered.
    reproduced: Option<bool>,
    /// Where the stored record differs from that of the frame rendered now: parameters, plan, metrics, labels, counts,
    /// warnings, artifacts. Times and provenance are not compared, except the inputs.
    record_differences: Vec<RecordDifference>,
    /// One entry per artifact.
    artifacts: Vec<VerifiedArtifact>,
    /// Differences of program, machine or models that explain different bytes; these are not errors.
    differences: Vec<String>,
}

/// Verify an image: hash its stored bytes, and optionally render it again.
///
/// A separate process renders it, for at most two minutes. Bytes are reproducible on one build, one ONNX Runtime and
/// one CPU feature set; otherwise `largest_difference` is the deviation.
#[utoipa::path(post, path = "/v1/images/{job}/{frame}/verify", tag = "images", operation_id = "verify_image",
    params(("job" = String, Path, description = "`job_…`"), ("frame" = u64, Path, description = "From 0")),
    request_body(content = Wish, content_type = "application/json"),
    responses((status = 200, description = "The result.", body = Verified)))]
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
    let (record_differences, differences) = match &again {
        Some(again) => {
            let record = &again.record;
            let stored = FrameRecord::deserialize(&image).map_err(|error| Problem::internal(&error))?;
            (
                compare_records(record, &stored, Agreement::Exact),
                stored.provenance.describe_changes(&record.provenance),
            )
        }
        None => (Vec::new(), Vec::new()),
    };
    Ok(Json(Verified {
        intact: artifacts
            .iter()
            .all(|artifact| artifact.stored == StoredBytes::Good),
        reproduced: again.as_ref().map(|_| {
            record_differences.is_empty()
                && artifacts.iter().all(|artifact: &VerifiedArtifact| {
                    artifact.rerendered_digest.as_ref() == Some(&artifact.digest)
                })
        }),
        record_differences,
        artifacts,
        differences,
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
            images
                .processes
                .compute
                .run(move || again.bytes(&kind).and_then(|again| difference(&bytes, &again)))
                .await?
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

/// Whether the bytes of an artifact are unchanged, and the bytes if so.
pub(crate) async fn condition(
    images: &Images,
    artifact: &StoredArtifact,
) -> Result<(StoredBytes, Option<Vec<u8>>), Problem> {
    let Some(place) = &artifact.place else {
        return match images.read_pack(artifact).await {
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
