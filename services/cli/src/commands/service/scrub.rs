//! `fathom scrub`: verifies everything that a stopped service has stored, and optionally repairs it.

mod findings;
mod repair;
mod replica;
mod space;

use std::path::PathBuf;

use api::{Data, SetFiles, Unread};
use catalogue::{CatalogueError, ImportedArtifact, JobRow};
use cli::exit::Failure;
use cli::progress::Progress;
use cli::styles::StyleArguments;
use serde_json::json;
use store::Scrubbed;

use crate::commands::sharded::buckets;
use findings::{Damaged, Findings, Row, Unnamed};
use repair::Repair;

/// Options of `fathom scrub`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Data folder of the service, which must be stopped
    #[arg(long, env = "FATHOM_DATA", default_value = "data", value_name = "DIR")]
    data: PathBuf,
    /// Render damaged images again, store those with the same digest, and free unreferenced space
    #[arg(long)]
    repair: bool,
    /// Restore a lost catalogue from the newest backup in the folder, or lost packs by rendering every image again; then repair
    #[arg(long)]
    rebuild: bool,
    /// Rebuild the columnar replica (folder mirror), from which images are counted
    #[arg(long)]
    mirror: bool,
    /// Print the findings as one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    style: StyleArguments,
}

/// Rows of one query to the catalogue.
const BATCH: u32 = 1000;

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.rebuild {
        if let Some(backup) = Data::rebuild(&arguments.data).map_err(Failure::input)? {
            eprintln!("the catalogue is that of {}", backup.display());
        }
    } else if !arguments.data.join("catalogue.sqlite").is_file() {
        let message = format!(
            "{} has no catalogue.sqlite; `--rebuild` restores it from the newest backup",
            arguments.data.display()
        );
        return Err(Failure::BadInput(message));
    }
    let runtime = tokio::runtime::Runtime::new().map_err(anyhow::Error::from)?;
    // Readers of buckets have threads that cannot be ended within the runtime.
    let sets = SetFiles::new(buckets::reader());
    let findings = runtime.block_on(scrub(arguments, sets.clone()))?;
    if arguments.json {
        println!("{}", json!(findings));
    } else {
        findings.print();
    }
    match findings.left() {
        0 => Ok(()),
        left => Err(Failure::Other(anyhow::anyhow!(
            "{left} findings are not repaired"
        ))),
    }
}

/// Verifies everything.
async fn scrub(arguments: &Arguments, sets: SetFiles) -> Result<Findings, Failure> {
    let library = arguments.style.library_of_service(&arguments.data)?;
    let vocabulary = renderer::vocabulary(&library, false);
    let opened = match arguments.rebuild {
        true => Data::open_without_packs(&arguments.data, &vocabulary.metrics).await,
        false => Data::open(&arguments.data, &vocabulary.metrics).await,
    };
    let data = opened.map_err(Failure::input)?;
    let wants_repair = arguments.repair || arguments.rebuild;
    let jobs = data
        .catalogue
        .imported_jobs()
        .await
        .map_err(anyhow::Error::from)?;
    let mut findings = Findings {
        packs_set_aside: data.store.stats().set_aside,
        ..Findings::default()
    };
    // Scenes first: a frame of a damaged scene cannot be rendered.
    scenes(&data, &mut findings).await?;
    let mut repair = wants_repair.then(|| Repair::new(library, arguments.style.onnxruntime.as_deref()));
    rows(&data, repair.as_mut(), &mut findings).await?;
    artifacts(&data, repair.as_mut(), &mut findings).await?;
    findings
        .rows
        .extend(repair.map(|repair| repair.false_records).into_iter().flatten());
    for job in jobs {
        imported(&data, &sets, &job, wants_repair, &mut findings).await?;
    }
    replica::verify(&data, wants_repair, arguments.mirror, &mut findings).await?;
    space::look(&data, &arguments.data, wants_repair, &mut findings).await?;
    data.close().await;
    Ok(findings)
}

/// Rows of the catalogue: those that follow from an intact record are restored, other images are rendered again.
async fn rows(data: &Data, mut repair: Option<&mut Repair>, findings: &mut Findings) -> anyhow::Result<()> {
    let mut integrity = whole(data).await?;
    let damaged = match data.catalogue.damaged_rows().await {
        Ok(rows) => rows,
        Err(CatalogueError::Damaged { what, .. }) => {
            integrity.push(format!("{what}: restore a backup"));
            Vec::new()
        }
        Err(error) => return Err(error.into()),
    };
    let any = !integrity.is_empty() || !damaged.is_empty();
    for row in damaged {
        let repair = match (repair.as_deref_mut(), &row.image) {
            (None, _) => None,
            (Some(repair), Some((job, frame))) => Some(repair.image(data, job, *frame).await),
            (Some(_), None) => Some(Err(anyhow::anyhow!("restore a backup"))),
        };
        findings.rows.push(Row {
            what: row.what,
            repaired: repair.as_ref().map(Result::is_ok),
            reason: repair.and_then(Result::err).map(|error| error.to_string()),
        });
    }
    if any && repair.is_some() {
        data.catalogue.restore_sums().await?;
        integrity = whole(data).await?;
        let left = data.catalogue.damaged_rows().await?;
        for row in &mut findings.rows {
            // Sums of datasets have been recomputed.
            if left.iter().all(|left| left.what != row.what) {
                (row.repaired, row.reason) = (Some(true), None);
            }
        }
    }
    findings.catalogue = integrity;
    Ok(())
}

/// Damage of the catalogue's file, which may be too large for SQLite's own check.
async fn whole(data: &Data) -> anyhow::Result<Vec<String>> {
    match data.catalogue.integrity_check().await {
        Err(CatalogueError::Damaged { what, .. }) => Ok(vec![what]),
        other => Ok(other?),
    }
}

async fn scenes(data: &Data, findings: &mut Findings) -> anyhow::Result<()> {
    let mut cursor = None;
    loop {
        let page = data.catalogue.scenes(BATCH, cursor).await?;
        for scene in page.items {
            for (name, digest) in scene.files.named() {
                let state = data.store.scrub(digest).await?;
                findings.blobs += 1;
                if state != Scrubbed::Good {
                    let owner = format!("{name} of scene {}", scene.id);
                    let repair = Some(Err("upload the same file again".to_owned()));
                    let damaged = Damaged::new(digest.clone(), state, owner, repair);
                    findings.damaged.push(damaged);
                }
            }
        }
        cursor = page.next_cursor;
        if cursor.is_none() {
            return Ok(());
        }
    }
}

async fn artifacts(
    data: &Data,
    mut repair: Option<&mut Repair>,
    findings: &mut Findings,
) -> anyhow::Result<()> {
    let mut progress = Progress::new("scrub", "files", data.store.stats().blobs);
    let mut after: Option<String> = None;
    loop {
        let batch = data.catalogue.artifacts_after(after.as_deref(), BATCH).await?;
        let Some(last) = batch.last() else { break };
        after = Some(last.digest.clone());
        for artifact in batch {
            let state = data.store.scrub(&artifact.digest).await?;
            findings.blobs += 1;
            findings.bytes += artifact.bytes;
            progress.set(findings.blobs);
            if state != Scrubbed::Good {
                let repair = match repair.as_deref_mut() {
                    Some(repair) => Some(repair.artifact(data, &artifact).await),
                    None => None,
                };
                let owner = format!("{} of {}/{}", artifact.kind, artifact.job_id, artifact.frame);
                let repair = repair.map(|repair| repair.map_err(|error| error.to_string()));
                let damaged = Damaged::new(artifact.digest, state, owner, repair);
                findings.damaged.push(damaged);
            }
        }
    }
    progress.finish();
    Ok(())
}

/// Artifacts of an imported job, in the tars of its set.
async fn imported(
    data: &Data,
    sets: &SetFiles,
    job: &JobRow,
    wants_repair: bool,
    findings: &mut Findings,
) -> Result<(), Failure> {
    let mut progress = Progress::new("scrub", "images", job.done);
    let mut last: Option<ImportedArtifact> = None;
    loop {
        let batch = data
            .catalogue
            .imported_artifacts(&job.id, last.as_ref(), BATCH)
            .await
            .map_err(anyhow::Error::from)?;
        last = batch.last().cloned();
        if last.is_none() {
            break;
        }
        for ImportedArtifact {
            job_id,
            frame,
            entry,
            place,
        } in batch
        {
            findings.imported += 1;
            findings.bytes += entry.bytes;
            progress.set(frame);
            let state = match sets.read(&place, &entry).await {
                Ok(_) => continue,
                Err(Unread::Gone(_)) => Scrubbed::Missing,
                Err(Unread::Differs(_)) => Scrubbed::Corrupt,
                Err(Unread::Unreachable(reason)) => return Err(Failure::Later(reason)),
            };
            let advice =
                "remove the marker of its shard from done/ of the set, render the set, and import it again";
            let owner = format!("{} of {job_id}/{frame} in {}", entry.kind, place.tar);
            let repair = wants_repair.then(|| Err(advice.to_owned()));
            findings
                .damaged
                .push(Damaged::new(entry.digest, state, owner, repair));
        }
    }
    progress.finish();
    Ok(())
}
