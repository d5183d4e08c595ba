//! `fathom import`: the images of a set in the data folder of a service, without their bytes.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Instant;

use anyhow::Context;
use api::Data;
use cli::exit::Failure;
use cli::progress::Progress;
use cli::styles::StyleArguments;
use serde_json::json;
use sets::{Location, Set};
use spec::{Draft, Uploads};

use super::failure;
use crate::import::{Import, ImportError};

/// Options of `fathom import`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Folder or s3://BUCKET/PREFIX
    set: String,
    /// Folder of the catalogue and the artifacts; its service must be stopped
    #[arg(long, env = "FATHOM_DATA", default_value = "data", value_name = "DIR")]
    data: PathBuf,
    /// Print what was imported as one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    style: StyleArguments,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let set = Set::open(&location(&arguments.set)?).map_err(failure)?;
    let library = arguments.style.library_of_service(&arguments.data)?;
    let mut vocabulary = renderer::vocabulary(&library, true);
    let metrics = vocabulary.metrics.clone();
    // The frames are rendered: their styles need not be here.
    vocabulary.styles.extend(set.job().styles());
    Draft::read(set.card().job.as_bytes(), &vocabulary)
        .and_then(|draft| draft.check(&Uploads::Known(BTreeMap::new())))
        .map_err(|invalid| cli::job::refused(&PathBuf::from(&arguments.set).join("job.json"), &invalid))?;
    let runtime = tokio::runtime::Runtime::new().context("cannot start the asynchronous runtime")?;
    let data = runtime.block_on(Data::open(&arguments.data, &metrics));
    let data = data.map_err(Failure::input)?;
    let imported = import(arguments, &set, &data, &runtime);
    runtime.block_on(data.close());
    imported
}

fn import(
    arguments: &Arguments,
    set: &Set,
    data: &Data,
    runtime: &tokio::runtime::Runtime,
) -> Result<(), Failure> {
    let begun = Instant::now();
    let mut bar: Option<Progress> = None;
    let import = Import {
        set,
        catalogue: &data.catalogue,
        runtime,
        threads: cli::render::cores(),
    };
    let imported = import.run(|stored, all| {
        bar.get_or_insert_with(|| Progress::new("import", "shards", all))
            .set(stored);
    });
    let (job, tally) = imported.map_err(|error| match error {
        ImportError::Set(error) => failure(error),
        ImportError::Catalogue(error) => Failure::Other(error.into()),
    })?;
    if let Some(bar) = bar {
        bar.finish();
    }
    let seconds = begun.elapsed().as_secs_f64();
    if arguments.json {
        println!(
            "{}",
            json!({"job": job, "shards": tally.shards, "images": tally.images, "seconds": seconds})
        );
        return Ok(());
    }
    println!(
        "{} shards with {} images in {seconds:.1} s ({:.0} images/s)",
        tally.shards,
        tally.images,
        tally.images as f64 / seconds.max(1e-9)
    );
    println!(
        "{} · dataset {} · {} · {} of {} frames, {} failed",
        job.id, job.dataset, job.state, job.done, job.frames, job.failed
    );
    if let Some(digest) = &job.digest {
        println!("digest {digest}");
    }
    Ok(())
}

/// Where the set lies, as it stays the same whatever folder a service is started in.
fn location(text: &str) -> Result<Location, Failure> {
    match Location::parse(text).map_err(failure)? {
        Location::Folder(path) => {
            let whole = path.canonicalize();
            let whole = whole.map_err(|error| Failure::BadInput(format!("{}: {error}", path.display())))?;
            match whole.to_str() {
                Some(_) => Ok(Location::Folder(whole)),
                None => Err(Failure::BadInput(format!("{} is not UTF-8", whole.display()))),
            }
        }
        bucket => Ok(bucket),
    }
}
