//! `fathom export`: the images of a dataset as a folder that training scripts read.
//!
//! ```text
//! OUT/metadata.jsonl           one line per image: file_name, the files of the other kinds, parameters, labels, metrics
//! OUT/categories.json          id and name of every class, where semantics or boxes were exported
//! OUT/SHA256SUMS               every file with its digest, as `sha256sum --check` reads it
//! OUT/JOB/FRAME/KIND.EXTENSION the files of a job as `fathom render` writes them
//! ```
//!
//! With `--split`, each part is such a folder: `OUT/train/metadata.jsonl` and so on.

mod frame;
mod lists;
mod split;
mod target;

use std::path::PathBuf;

use anyhow::Context;
use cli::classes::SceneClasses;
use cli::exit::Failure;
use cli::images::Question;
use cli::known;
use cli::progress::Progress;
use cli::remote::{Remote, ServerArguments, encode, with_query};
use rayon::prelude::*;
use serde_json::Value;
use spec::ArtifactKind;

use frame::{Frame, Order};
use lists::{Lists, METADATA, SUMS};
use split::Splits;
use target::Target;

/// Options of `fathom export`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The dataset
    dataset: String,
    /// Which images, such as 'uiqm > 0.8 and water.style in ("muddy")' [default: all]
    #[arg(long, default_value = "")]
    filter: String,
    /// Kinds of artifacts, comma-separated; the first one becomes the `file_name` column
    #[arg(long, value_delimiter = ',', default_value = "rgb", value_parser = kind)]
    kinds: Vec<String>,
    /// Parts with their shares, such as train=.8,val=.1,test=.1, each in a folder of its name; images of one scene are never in
    /// two parts, and no image changes its part when the dataset grows
    #[arg(long, value_name = "PARTS", value_parser = Splits::parse)]
    split: Option<Splits>,
    /// The folder to fill; files that are already there with the right digest are kept
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    server: ServerArguments,
}

/// Concurrent downloads: enough to keep a local service busy, few enough to leave it room for others.
const DOWNLOADS: usize = 4;

/// A kind of artifact whose name can be that of a file.
fn kind(name: &str) -> Result<String, String> {
    let is_plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_' || c == '.';
    if ArtifactKind::parse(name).is_some() && name.chars().all(is_plain) {
        return Ok(name.to_owned());
    }
    let known: Vec<&str> = ArtifactKind::FIXED.iter().map(|(name, _)| *name).collect();
    Err(format!("the kinds are {} and enhanced.METHOD", known.join(", ")))
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let remote = Remote::new(&arguments.server);
    let columns = columns(&known::dataset(&remote, &arguments.dataset)?, &arguments.kinds)?;
    let mut progress = Progress::new("export", "images", count(&remote, arguments)?);
    let split = arguments.split.as_ref();
    let target = Target::open(&arguments.out, &arguments.dataset, split.map(Splits::to_string))?;
    let mut parts = parts(&target, split)?;
    let question = Question {
        dataset: Some(&arguments.dataset),
        filter: &arguments.filter,
        order_by: None,
        fields: &columns,
        limit: usize::MAX,
    };
    let order = Order {
        remote: &remote,
        target: &target,
        kinds: &arguments.kinds,
        columns: &columns,
    };
    let has_classes = arguments
        .kinds
        .iter()
        .any(|kind| kind == "semantics" || kind == "boxes");
    let mut classes = SceneClasses::new(&remote);
    let (mut images, mut fetched) = (0, 0);
    let threads = rayon::ThreadPoolBuilder::new().num_threads(DOWNLOADS).build();
    let threads = threads.context("cannot start threads")?;
    question.pages(&remote, |rows| {
        let part_of = |row: &Value| split.map_or(0, |split| split.part_of(row));
        let fetch = |row: &Value| order.carry_out(row, parts[part_of(row)].name.as_deref());
        let frames: Result<Vec<Frame>, Failure> = threads.install(|| rows.par_iter().map(fetch).collect());
        for (row, frame) in rows.iter().zip(frames?) {
            let lists = &mut parts[part_of(row)].lists;
            lists.add(&frame)?;
            if has_classes {
                classes.add(row, &mut lists.classes)?;
            }
            fetched += frame.fetched;
            images += 1;
        }
        progress.set(images);
        Ok(())
    })?;
    progress.finish();
    println!(
        "{images} images in {} ({fetched} files fetched, the others were there)",
        target.root().display()
    );
    parts.into_iter().try_for_each(|part| part.finish(&target))
}

/// The columns of a dataset, among them the digests of the kinds wanted.
fn columns(dataset: &Value, kinds: &[String]) -> Result<Vec<String>, Failure> {
    let columns = dataset["columns"].as_array().into_iter().flatten();
    let names = columns.filter_map(|column| column["name"].as_str());
    // A column may not pass for the path of a file, which is what readers of image folders take such names for.
    let names: Vec<String> = names
        .filter(|name| !name.ends_with("file_name"))
        .map(str::to_owned)
        .collect();
    let there: Vec<&str> = names
        .iter()
        .filter_map(|name| name.strip_prefix("artifacts."))
        .collect();
    for kind in kinds {
        if !there.is_empty() && !there.contains(&kind.as_str()) {
            let dataset = dataset["name"].as_str().unwrap_or_default();
            let message = format!(
                "no image of `{dataset}` has an artifact `{kind}`; there is {}",
                there.join(", ")
            );
            return Err(Failure::BadInput(message));
        }
    }
    Ok(names)
}

/// How many images will be exported; fails early where the filter is wrong.
fn count(remote: &Remote, arguments: &Arguments) -> Result<u64, Failure> {
    let path = format!("/v1/datasets/{}/stats", encode(&arguments.dataset));
    let parameters = [
        ("metrics", Some("total_ms")),
        ("filter", Some(arguments.filter.as_str())),
    ];
    let stats = remote.get(&with_query(&path, &parameters))?;
    let groups = stats["groups"].as_array().into_iter().flatten();
    Ok(groups.filter_map(|group| group["count"].as_u64()).sum())
}

/// A folder with lists of its own: that of a part, or the whole export.
struct Part {
    name: Option<String>,
    lists: Lists,
}

fn parts(target: &Target, split: Option<&Splits>) -> Result<Vec<Part>, Failure> {
    let names: Vec<Option<String>> = match split {
        Some(split) => split.names().map(|name| Some(name.to_owned())).collect(),
        None => vec![None],
    };
    let part = |name: Option<String>| {
        let folder = target.folder(name.as_deref().as_slice())?;
        let lists = Lists::create(&folder)?;
        Ok(Part { name, lists })
    };
    names.into_iter().map(part).collect()
}

impl Part {
    fn finish(self, target: &Target) -> Result<(), Failure> {
        let folder = target.folder(self.name.as_deref().as_slice())?;
        if let Some(name) = &self.name {
            println!("{name}: {} images", self.lists.frames);
        }
        self.lists.finish()?;
        println!("metadata  {}", folder.join(METADATA).display());
        println!(
            "check     cd {} && sha256sum --check --quiet {SUMS}",
            folder.display()
        );
        Ok(())
    }
}
