//! Storing a scene: decode, store its bytes, then the row that references them; and deleting it.

use std::convert::Infallible;
use std::sync::Arc;

use axum::body::Bytes;
use catalogue::{SceneRow, UnixMs};
use client::SceneSummary;
use spec::SceneFiles;
use store::Blob;

use super::Scenes;
use super::upload::SceneForm;
use crate::clock::ordered_id;
use crate::decode::{Request, SceneFacts, SceneRequest};
use crate::http::problem::Problem;
use crate::processes::compute::to_the_end;
use crate::processes::decoding::Files;

/// Memory per pixel while decoding a scene: floats of three channels as read, split and scaled, range and instances.
const PIXEL_BYTES: usize = 64;

/// A scene of an upload.
pub(super) struct KeptScene {
    pub(super) row: SceneRow,
    pub(super) summary: SceneSummary,
    /// Whether no scene of the same content existed.
    pub(super) is_new: bool,
}

impl Scenes {
    /// Stores a scene, unless one with the same content exists. Completes even if the client disconnects.
    pub(super) async fn keep(self: &Arc<Self>, form: SceneForm) -> Result<KeptScene, Problem> {
        self.bytes.space.room().await?;
        let created_at = self.clock.wall();
        let (collection, name) = (form.collection.clone(), form.name.clone());
        let (row, summary, blobs) = self.checked(form, created_at).await?;
        let scenes = Arc::clone(self);
        to_the_end(async move {
            let _turn = scenes.bytes.naming.beside_others().await;
            scenes.bytes.store.put_all(blobs).await?;
            let (row, is_new) = scenes.catalogue.insert_scene(row).await?;
            if let Some(collection) = collection {
                scenes
                    .collect(&collection, name.as_deref().unwrap_or(&row.id), &row.id)
                    .await?;
            }
            Ok(KeptScene { row, summary, is_new })
        })
        .await
    }

    /// Deletes an unused scene; its space is reclaimed in the background.
    pub(super) async fn delete(self: &Arc<Self>, id: String) -> Result<(), Problem> {
        let scenes = Arc::clone(self);
        to_the_end(async move {
            // No job that references the scene may be stored meanwhile.
            let _alone = scenes.bytes.naming.alone().await;
            scenes.catalogue.delete_scene(&id).await?;
            scenes.bytes.reclaim.notify_one();
            tracing::info!(scene = id, "scene deleted");
            Ok(())
        })
        .await
    }

    /// Adds a stored scene to a collection.
    async fn collect(&self, collection: &str, name: &str, id: &str) -> Result<(), Problem> {
        let most = spec::MAX_COLLECTION;
        if self.catalogue.collect_scene(collection, name, id, most).await? {
            return Ok(());
        }
        let message = format!(
            "the collection `{collection}` has {most} scenes, the limit; scene `{id}` is stored, but not in it"
        );
        Err(Problem::field("/collection", message))
    }
}

impl Scenes {
    /// Decodes all files once, so that workers only receive readable scenes.
    async fn checked(
        &self,
        form: SceneForm,
        created_at: UnixMs,
    ) -> Result<(SceneRow, SceneSummary, Vec<Blob>), Problem> {
        let camera = form.camera();
        let mut files = form.files();
        let request = Request::Scene(SceneRequest {
            files: named(&files),
            camera,
        });
        let to_decode = Files {
            field: "rgb",
            named: files.named().collect(),
            bytes_per_pixel: PIXEL_BYTES,
        };
        let decoded = self
            .processes
            .decoding
            .run::<SceneFacts>(&request, to_decode)
            .await?;
        let SceneFacts {
            width,
            height,
            camera,
            summary,
        } = decoded.reply;
        files.intrinsics = camera;
        let (files, blobs) = self.processes.compute.run(move || hashed(&files)).await?;
        let row = SceneRow {
            id: format!("scn_{}", ordered_id().simple()),
            content_digest: content_digest(&files),
            files,
            width: side(width),
            height: side(height),
            created_at,
        };
        Ok((row, summary, blobs))
    }
}

/// The files by the names used for decoding.
fn named(files: &SceneFiles<Bytes>) -> SceneFiles<String> {
    let mut names = files.named().map(|(name, _)| name.to_owned());
    let Ok(named) = files.try_map(|_| Ok::<_, Infallible>(names.next().unwrap_or_default()));
    named
}

/// The files by their digests, and their bytes.
fn hashed(files: &SceneFiles<Bytes>) -> (SceneFiles<String>, Vec<Blob>) {
    let mut blobs = Vec::new();
    let Ok(files) = files.try_map(|bytes| -> Result<_, Infallible> {
        let digest = spec::sha256(bytes);
        blobs.push(Blob {
            digest: digest.clone(),
            bytes: bytes.to_vec(),
        });
        Ok(digest)
    });
    (files, blobs)
}

/// SHA-256 over everything that affects a render of the scene. Scenes without classes and pose keep the digest of
/// versions without them.
fn content_digest(files: &SceneFiles<String>) -> String {
    let (range, camera) = (files.range.as_ref(), files.intrinsics.as_ref());
    let mut content = serde_json::json!([
        files.rgb,
        range.map(|range| &range.file),
        range.map(|range| range.kind),
        range.and_then(|range| range.unit_m),
        range.and_then(|range| range.invalid_code),
        files.instances,
        camera.map(|camera| camera.focal_px),
        camera.map(|camera| camera.cx),
        camera.map(|camera| camera.cy),
    ]);
    if let Some(content) = content.as_array_mut() {
        content.extend(files.classes.iter().map(|classes| serde_json::json!(classes)));
        let pose = files.world_from_camera.iter();
        content.extend(pose.map(|pose| serde_json::json!({"world_from_camera": pose})));
        content.extend(
            files
                .hfov_deg
                .map(|hfov_deg| serde_json::json!({"hfov_deg": hfov_deg})),
        );
        content.extend(files.scale.map(|scale| serde_json::json!({"scale": scale})));
    }
    spec::sha256(format!("fathom-scene-v1{content}"))
}

fn side(pixels: usize) -> u32 {
    u32::try_from(pixels).expect("the decoders refuse sides over 16384")
}
