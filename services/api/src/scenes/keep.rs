//! Keeping a scene: decoded first, then its bytes, then the row that names them.

use std::convert::Infallible;
use std::sync::Arc;

use catalogue::SceneRow;
use imaging::codec::{Radiance, decode_radiance};
use imaging::geometry::Intrinsics;
use scenes::SceneError;
use scenes::uploaded::decode;
use spec::SceneFiles;
use store::Blob;
use uuid::Uuid;

use crate::app::Shared;
use crate::http::problem::Problem;
use crate::scenes::form::Form;

/// Stores a scene unless one with the same content is there; says whether it is new. Goes on to its end when the
/// client goes away.
pub(crate) async fn keep(app: &Shared, form: Form) -> Result<(SceneRow, bool), Problem> {
    app.space.room().await?;
    let created_ms = app.clock.unix_ms();
    let (row, blobs) = app.compute.run(move || checked(form, created_ms)).await??;
    let app = Arc::clone(app);
    let task = tokio::spawn(async move {
        let id = row.id.clone();
        let _turn = app.naming.beside_others().await;
        app.store.put_all(blobs).await?;
        let stored = app.catalogue.insert_scene(row).await?;
        let row = app.catalogue.scene(&stored).await?;
        let row =
            row.ok_or_else(|| Problem::internal(&format!("scene {stored} vanished after it was stored")))?;
        Ok((row, stored == id))
    });
    task.await.map_err(|error| Problem::internal(&error))?
}

/// Decodes everything once, so that no worker meets a scene that cannot be read.
fn checked(form: Form, created_ms: u64) -> Result<(SceneRow, Vec<Blob>), Problem> {
    let camera = camera(&form)?;
    let files = form.files(camera);
    let scene = decode(&files).map_err(|error| refusal(&error))?;
    let mut blobs = Vec::new();
    let Ok(files) = files.try_map(|bytes| -> Result<_, Infallible> {
        let digest = spec::sha256(bytes);
        blobs.push(Blob {
            digest: digest.clone(),
            bytes: bytes.to_vec(),
        });
        Ok(digest)
    });
    let row = SceneRow {
        id: format!("scn_{}", Uuid::now_v7().simple()),
        content_digest: content_digest(&files),
        files,
        width: side(scene.radiance.width()),
        height: side(scene.radiance.height()),
        created_ms,
    };
    Ok((row, blobs))
}

/// The camera needs the picture's size, which only decoding tells for every format.
fn camera(form: &Form) -> Result<Option<Intrinsics>, Problem> {
    if !form.has_camera() {
        return Ok(None);
    }
    let picture = decode_radiance(form.rgb.as_deref().unwrap_or_default());
    let (width, height) = match picture.map_err(|error| Problem::field("/rgb", format!("rgb: {error}")))? {
        Radiance::Encoded(raster) => (raster.width(), raster.height()),
        Radiance::Linear(picture) => (picture.width(), picture.height()),
    };
    Ok(form.camera(width, height))
}

/// SHA-256 over everything that a render of the scene depends on.
fn content_digest(files: &SceneFiles<String>) -> String {
    let (range, camera) = (files.range.as_ref(), files.intrinsics.as_ref());
    let content = serde_json::json!([
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
    spec::sha256(format!("fathom-scene-v1{content}"))
}

fn refusal(error: &SceneError) -> Problem {
    Problem::field(&format!("/{}", error.field()), error.to_string())
}

fn side(pixels: usize) -> u32 {
    u32::try_from(pixels).expect("the decoders refuse sides over 16384")
}
