use catalogue::{SealedImage, VersionJob};
use client::{DamagedImage, VerifiedVersion};
use serde::Deserialize;
use spec::{FrameRecord, MerkleTree};
use utoipa::ToSchema;

use crate::datasets::Datasets;
use crate::http::{Json, JsonBytes, Path, Problem, Slug, State, Topic};
use crate::images::routes::verify::{StoredBytes, condition};
use crate::limits::RECORDS_BATCH;

/// Maximum number of damaged images in a response.
const MAX_NAMED: usize = 100;

/// Options of a verification.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = VersionWish)]
pub(crate) struct Wish {
    /// Also read and hash the bytes of every artifact.
    #[serde(default)]
    #[schema(default = false)]
    bytes: bool,
}

/// Verify a sealed version: compute its root again from the records of its images.
///
/// Each record is compared with its digest and list of artifacts in the catalogue. With `bytes`, every artifact is
/// read and compared with its digest, for at most five minutes.
#[utoipa::path(post, path = "/v1/datasets/{name}/versions/{version}/verify", tag = "datasets", operation_id = "verify_sealed_version",
    params(("name" = String, Path, description = "Name of the dataset"), ("version" = u64, Path, description = "From 1")),
    request_body(content = Wish, content_type = "application/json"),
    responses((status = 200, description = "The result.", body = VerifiedVersion)))]
pub(crate) async fn verify(
    State(datasets): Topic<Datasets>,
    Path((name, version)): Path<(String, u64)>,
    JsonBytes(body): JsonBytes,
) -> Result<Json<VerifiedVersion>, Problem> {
    let wish: Wish =
        serde_json::from_slice(&body).map_err(|error| Problem::new(Slug::InvalidBody, error.to_string()))?;
    let row = datasets.version(&name, version).await?;
    let mut verification = Verification::default();
    let mut tree = MerkleTree::default();
    for job in datasets.catalogue.version_jobs(&name, version).await? {
        let computed = verification.job(&datasets, &job, wish.bytes).await?;
        if computed != job.root {
            verification.add(
                &job,
                None,
                "the root of its images differs from the sealed one".to_owned(),
            );
        }
        tree.push(computed);
    }
    let Verification {
        images,
        artifacts,
        damages,
        damaged,
    } = verification;
    let computed = tree.root();
    Ok(Json(VerifiedVersion {
        intact: damages == 0 && computed == row.root,
        root: row.root,
        computed,
        images,
        artifacts,
        damages,
        damaged,
    }))
}

/// The findings so far.
#[derive(Default)]
struct Verification {
    images: u64,
    artifacts: u64,
    damages: u64,
    damaged: Vec<DamagedImage>,
}

impl Verification {
    /// Verifies the images of a job and returns their root.
    async fn job(&mut self, datasets: &Datasets, job: &VersionJob, bytes: bool) -> Result<String, Problem> {
        let (mut tree, mut after) = (MerkleTree::default(), None);
        loop {
            let images = datasets
                .catalogue
                .sealed_images(&job.id, after, RECORDS_BATCH)
                .await?;
            let Some(last) = images.last() else { break };
            after = Some(last.frame);
            for image in datasets
                .processes
                .compute
                .run(move || images.iter().map(Checked::new).collect::<Vec<_>>())
                .await?
            {
                self.images += 1;
                tree.push(&image.digest);
                for reason in image.wrong {
                    self.add(job, Some(image.frame), reason);
                }
                for kind in image.kinds.iter().filter(|_| bytes) {
                    self.artifact(datasets, job, image.frame, kind).await?;
                }
            }
        }
        Ok(tree.root())
    }

    async fn artifact(
        &mut self,
        datasets: &Datasets,
        job: &VersionJob,
        frame: u64,
        kind: &str,
    ) -> Result<(), Problem> {
        self.artifacts += 1;
        let stored = datasets.images.artifact(&job.id, frame, kind).await?;
        let what = match condition(&datasets.images, &stored).await?.0 {
            StoredBytes::Good => return Ok(()),
            StoredBytes::Corrupt => "damaged",
            StoredBytes::Missing => "missing",
        };
        self.add(job, Some(frame), format!("the bytes of `{kind}` are {what}"));
        Ok(())
    }

    fn add(&mut self, job: &VersionJob, frame: Option<u64>, reason: String) {
        self.damages += 1;
        if self.damaged.len() < MAX_NAMED {
            let job = job.id.clone();
            self.damaged.push(DamagedImage { job, frame, reason });
        }
    }
}

/// An image with data from its record.
struct Checked {
    frame: u64,
    /// Digest computed from the record.
    digest: String,
    /// Its artifact kinds.
    kinds: Vec<String>,
    wrong: Vec<String>,
}

impl Checked {
    fn new(image: &SealedImage) -> Self {
        let kinds = image.artifacts.iter().map(|(kind, _)| kind.clone()).collect();
        let mut wrong = Vec::new();
        let digest = match serde_json::from_str::<FrameRecord>(&image.record) {
            Ok(record) => {
                let mut artifacts = record
                    .artifacts
                    .iter()
                    .map(|entry| (&entry.kind, &entry.digest))
                    .collect::<Vec<_>>();
                artifacts.sort_unstable();
                let stored = image.artifacts.iter().map(|(kind, digest)| (kind, digest));
                if !stored.eq(artifacts) {
                    wrong.push("its artifacts differ from those in its record".to_owned());
                }
                record.digest()
            }
            Err(error) => {
                wrong.push(format!("its record cannot be read: {error}"));
                String::new()
            }
        };
        if digest != image.digest && wrong.is_empty() {
            wrong.push("the digest of its record differs from its row".to_owned());
        }
        Self {
            frame: image.frame,
            digest,
            kinds,
            wrong,
        }
    }
}
