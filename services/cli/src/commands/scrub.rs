//! `fathom scrub`: reads everything that a stopped service has stored, and renders again what is damaged.

mod repair;

use std::path::PathBuf;

use api::Data;
use catalogue::NamedDigest;
use cli::exit::Failure;
use cli::progress::Progress;
use cli::styles::StyleArguments;
use serde_json::{Value, json};
use store::Scrubbed;

use repair::Repair;

/// Options of `fathom scrub`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Folder of the catalogue and the artifacts; its service must be stopped
    #[arg(long, env = "FATHOM_DATA", default_value = "data", value_name = "DIR")]
    data: PathBuf,
    /// Render damaged artifacts again and put them back if they come out with the same digest
    #[arg(long)]
    repair: bool,
    /// Print the findings as one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    style: StyleArguments,
}

/// Digests that one question to the catalogue asks for.
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
        println!("{}", findings.json());
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

/// What a scrub found.
#[derive(Default)]
struct Findings {
    /// Blobs that were read.
    blobs: u64,
    bytes: u64,
    /// What is wrong with the catalogue itself.
    catalogue: Vec<String>,
    /// Packs that cannot be read at all.
    packs_set_aside: u64,
    damaged: Vec<Damaged>,
}

/// A blob that a row names and that is not as it should be.
struct Damaged {
    digest: String,
    state: Scrubbed,
    /// Such as `rgb of job_…/3`.
    owner: String,
    /// What became of it; none: repair was not asked for.
    repaired: Option<Result<(), String>>,
}

impl Findings {
    fn left(&self) -> usize {
        let lost = self
            .damaged
            .iter()
            .filter(|damaged| !matches!(damaged.repaired, Some(Ok(()))));
        // A pack that is set aside is no loss once all that it held is back.
        self.catalogue.len() + lost.count()
    }

    fn json(&self) -> Value {
        let damaged = self.damaged.iter().map(|damaged| {
            json!({
                "digest": damaged.digest, "state": state(damaged.state), "owner": damaged.owner,
                "repaired": damaged.repaired.as_ref().map(Result::is_ok),
                "reason": damaged.repaired.as_ref().and_then(|result| result.as_ref().err()),
            })
        });
        json!({
            "blobs": self.blobs, "bytes": self.bytes, "catalogue": self.catalogue,
            "packs_set_aside": self.packs_set_aside, "damaged": damaged.collect::<Vec<_>>(),
        })
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
            let outcome = match &damaged.repaired {
                None => String::new(),
                Some(Ok(())) => "; rendered again".to_owned(),
                Some(Err(reason)) => format!("; not repaired: {reason}"),
            };
            println!(
                "{} {}: {}{outcome}",
                state(damaged.state),
                damaged.digest,
                damaged.owner
            );
        }
        if self.left() == 0 {
            println!("all is well");
        }
    }
}

fn state(state: Scrubbed) -> &'static str {
    match state {
        Scrubbed::Good => "good",
        Scrubbed::Corrupt => "corrupt",
        Scrubbed::Missing => "missing",
    }
}

async fn scrub(arguments: &Arguments) -> Result<Findings, Failure> {
    let library = arguments.style.library_of_service(&arguments.data)?;
    let vocabulary = renderer::vocabulary(&library, false);
    let opened = Data::open(&arguments.data, &vocabulary.metrics).await;
    let data = opened.map_err(Failure::input)?;
    let mut findings = Findings {
        catalogue: data
            .catalogue
            .integrity_check()
            .await
            .map_err(anyhow::Error::from)?,
        packs_set_aside: data.store.stats().set_aside,
        ..Findings::default()
    };
    // Scenes first: a frame of a damaged scene cannot be rendered again.
    scenes(&data, &mut findings).await?;
    let mut repair = arguments
        .repair
        .then(|| Repair::new(library, arguments.style.onnxruntime.as_deref()));
    artifacts(&data, repair.as_mut(), &mut findings).await?;
    data.close().await;
    Ok(findings)
}

async fn scenes(data: &Data, findings: &mut Findings) -> Result<(), Failure> {
    let mut cursor = None;
    loop {
        let page = data
            .catalogue
            .scenes(BATCH, cursor)
            .await
            .map_err(anyhow::Error::from)?;
        for scene in page.items {
            for (name, digest) in scene.files.named() {
                let state = data.store.scrub(digest).await.map_err(anyhow::Error::from)?;
                findings.blobs += 1;
                if state != Scrubbed::Good {
                    findings.damaged.push(Damaged {
                        digest: digest.clone(),
                        state,
                        owner: format!("{name} of scene {}", scene.id),
                        repaired: Some(Err("upload the same file again".to_owned())),
                    });
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
) -> Result<(), Failure> {
    let mut progress = Progress::new("scrub", "files", data.store.stats().blobs);
    let mut after: Option<String> = None;
    loop {
        let batch = data
            .catalogue
            .artifacts_after(after.as_deref(), BATCH)
            .await
            .map_err(anyhow::Error::from)?;
        let Some(last) = batch.last() else { break };
        after = Some(last.digest.clone());
        for artifact in batch {
            let state = data
                .store
                .scrub(&artifact.digest)
                .await
                .map_err(anyhow::Error::from)?;
            findings.blobs += 1;
            findings.bytes += artifact.bytes;
            progress.set(findings.blobs);
            if state != Scrubbed::Good {
                let repaired = match repair.as_deref_mut() {
                    Some(repair) => Some(repair.artifact(data, &artifact).await),
                    None => None,
                };
                let NamedDigest {
                    job_id,
                    frame,
                    kind,
                    digest,
                    ..
                } = artifact;
                let owner = format!("{kind} of {job_id}/{frame}");
                findings.damaged.push(Damaged {
                    digest,
                    state,
                    owner,
                    repaired,
                });
            }
        }
    }
    progress.finish();
    Ok(())
}
