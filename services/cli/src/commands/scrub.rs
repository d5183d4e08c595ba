//! `fathom scrub`: verifies everything that a stopped service has stored, and optionally repairs it.

mod repair;

use std::path::PathBuf;

use api::Data;
use cli::exit::Failure;
use cli::progress::Progress;
use cli::styles::StyleArguments;
use serde::Serialize;
use serde_json::json;
use store::Scrubbed;

use repair::Repair;

/// Options of `fathom scrub`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Data folder of the service, which must be stopped
    #[arg(long, env = "FATHOM_DATA", default_value = "data", value_name = "DIR")]
    data: PathBuf,
    /// Render damaged artifacts again, and store them if their digest is the same
    #[arg(long)]
    repair: bool,
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
    if !arguments.data.join("catalogue.sqlite").is_file() {
        let message = format!("{} holds no catalogue.sqlite", arguments.data.display());
        return Err(Failure::BadInput(message));
    }
    let runtime = tokio::runtime::Runtime::new().map_err(anyhow::Error::from)?;
    let findings = runtime.block_on(scrub(arguments))?;
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

/// The findings of a scrub.
#[derive(Default, Serialize)]
struct Findings {
    /// Blobs that were read.
    blobs: u64,
    bytes: u64,
    /// Errors in the catalogue itself.
    catalogue: Vec<String>,
    /// Packs that cannot be read at all.
    packs_set_aside: u64,
    damaged: Vec<Damaged>,
}

/// A damaged or missing blob that a row names.
#[derive(Serialize)]
struct Damaged {
    digest: String,
    state: &'static str,
    /// Such as `rgb of job_…/3`.
    owner: String,
    /// None: repair was not requested.
    repaired: Option<bool>,
    /// Why it was not repaired.
    reason: Option<String>,
}

impl Damaged {
    fn new(digest: String, state: Scrubbed, owner: String, repair: Option<Result<(), String>>) -> Self {
        Self {
            digest,
            state: match state {
                Scrubbed::Good => "good",
                Scrubbed::Corrupt => "corrupt",
                Scrubbed::Missing => "missing",
            },
            owner,
            repaired: repair.as_ref().map(Result::is_ok),
            reason: repair.and_then(Result::err),
        }
    }
}

impl Findings {
    fn left(&self) -> usize {
        let left = self
            .damaged
            .iter()
            .filter(|damaged| damaged.repaired != Some(true));
        // A pack that was set aside is no loss once all its blobs are restored.
        self.catalogue.len() + left.count()
    }

    fn print(&self) {
        println!("{} blobs, {} MB read", self.blobs, self.bytes / 1_000_000);
        for finding in &self.catalogue {
            println!("catalogue: {finding}");
        }
        if self.packs_set_aside > 0 {
            println!(
                "{} packs could not be read and were set aside",
                self.packs_set_aside
            );
        }
        for damaged in &self.damaged {
            let Damaged {
                digest, state, owner, ..
            } = damaged;
            let outcome = match (damaged.repaired, &damaged.reason) {
                (Some(true), _) => "; rendered again".to_owned(),
                (_, Some(reason)) => format!("; not repaired: {reason}"),
                (_, None) => String::new(),
            };
            println!("{state} {digest}: {owner}{outcome}");
        }
        if self.left() == 0 {
            println!("all is well");
        }
    }
}

async fn scrub(arguments: &Arguments) -> Result<Findings, Failure> {
    let library = arguments.style.library_of_service(&arguments.data)?;
    let vocabulary = renderer::vocabulary(&library, false);
    let opened = Data::open(&arguments.data, &vocabulary.metrics).await;
    let data = opened.map_err(Failure::input)?;
    let integrity = data.catalogue.integrity_check().await;
    let mut findings = Findings {
        catalogue: integrity.map_err(anyhow::Error::from)?,
        packs_set_aside: data.store.stats().set_aside,
        ..Findings::default()
    };
    // Scenes first: a frame of a damaged scene cannot be rendered.
    scenes(&data, &mut findings).await?;
    let mut repair = arguments
        .repair
        .then(|| Repair::new(library, arguments.style.onnxruntime.as_deref()));
    artifacts(&data, repair.as_mut(), &mut findings).await?;
    data.close().await;
    Ok(findings)
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
