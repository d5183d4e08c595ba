//! Keeping a scene: decoded first, then its bytes, then the row that names them.

use std::sync::Arc;

use catalogue::SceneRow;
use imaging::codec::{Radiance, decode_radiance};
use imaging::geometry::Intrinsics;
use scenes::SceneError;
use scenes::uploaded::decode;
use sha2::{Digest, Sha256};
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
    let (row, blobs) = app.compute.run(move || checked(&form, created_ms)).await??;
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
fn checked(form: &Form, created_ms: u64) -> Result<(SceneRow, Vec<Blob>), Problem> {
    let camera = camera(form)?;
    let scene = decode(&form.upload(camera)).map_err(|error| refusal(&error))?;
    let files = [&form.rgb, &form.range, &form.z_depth, &form.instances];
    let blobs: [Option<Blob>; 4] = files.map(|file| file.as_ref().map(|bytes| blob(bytes)));
    let [rgb, range, z_depth, instances] = blobs
        .each_ref()
        .map(|blob| blob.as_ref().map(|blob| blob.digest.clone()));
    let range_kind = match (&range, &z_depth) {
        (Some(_), _) => Some("range"),
        (None, Some(_)) => Some("z_depth"),
        (None, None) => None,
    };
    let mut row = SceneRow {
        id: format!("scn_{}", Uuid::now_v7().simple()),
        rgb_digest: rgb.unwrap_or_default(),
        range_digest: range.or(z_depth),
        range_kind: range_kind.map(str::to_owned),
        unit_m: form.unit_m,
        invalid_code: form.invalid_code,
        instances_digest: instances,
        width: side(scene.radiance.width()),
        height: side(scene.radiance.height()),
        focal_px: camera.map(|camera| camera.focal_px),
        cx: camera.map(|camera| camera.cx),
        cy: camera.map(|camera| camera.cy),
        content_digest: String::new(),
        created_ms,
    };
    row.content_digest = content_digest(&row);
    Ok((row, blobs.into_iter().flatten().collect()))
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

fn blob(bytes: &[u8]) -> Blob {
    Blob {
        digest: spec::hex(&Sha256::digest(bytes)),
        bytes: bytes.to_vec(),
    }
}

/// SHA-256 over everything that a render of the scene depends on.
fn content_digest(row: &SceneRow) -> String {
    let content = serde_json::json!([
        row.rgb_digest,
        row.range_digest,
        row.range_kind,
        row.unit_m,
        row.invalid_code,
        row.instances_digest,
        row.focal_px,
        row.cx,
        row.cy,
    ]);
    spec::hex(&Sha256::digest(format!("fathom-scene-v1{content}")))
}

fn refusal(error: &SceneError) -> Problem {
    Problem::field(&format!("/{}", error.field()), error.to_string())
}

fn side(pixels: usize) -> u32 {
    u32::try_from(pixels).expect("the decoders refuse sides over 16384")
}
