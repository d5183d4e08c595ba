//! `fathom export`: the images of a dataset as a folder that training scripts read.
//!
//! ```text
//! OUT/metadata.jsonl        one line per image: file_name, the files of the other kinds, parameters, metrics
//! OUT/categories.json       id and name of every class, where labels were exported
//! OUT/SHA256SUMS            every picture with its digest, as `sha256sum --check` reads it
//! OUT/rgb/JOB-FRAME.png     a folder per kind
//! ```

use std::collections::BTreeSet;
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use cli::exit::Failure;
use cli::files;
use cli::images::Question;
use cli::progress::Progress;
use cli::remote::{Remote, ServerArguments, query_value};
use rayon::prelude::*;
use scenes::categories::CATEGORIES;
use serde_json::{Map, Value, json};
use spec::{SceneCategory, sha256};

/// Options of `fathom export`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The dataset
    dataset: String,
    /// Which images, such as 'uiqm > 0.8 and water.style in ("muddy")'; without it all
    #[arg(long, default_value = "")]
    filter: String,
    /// Kinds of artifacts, comma-separated; the first one is what `file_name` says
    #[arg(long, value_delimiter = ',', default_value = "rgb")]
    kinds: Vec<String>,
    /// The folder to fill; what is there already and has the right digest is kept
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    server: ServerArguments,
}

/// Downloads side by side: enough to keep a local service busy, few enough to leave it room for others.
const DOWNLOADS: usize = 4;

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let remote = Remote::new(&arguments.server);
    let mut progress = Progress::new("export", "images", count(&remote, arguments)?);
    let question = Question {
        dataset: Some(&arguments.dataset),
        filter: &arguments.filter,
        order_by: None,
        fields: &[],
        limit: usize::MAX,
    };
    std::fs::create_dir_all(&arguments.out)
        .with_context(|| format!("cannot create {}", arguments.out.display()))?;
    let mut lists = Lists::create(&arguments.out)?;
    let (mut images, mut fetched) = (0, 0);
    let threads = rayon::ThreadPoolBuilder::new().num_threads(DOWNLOADS).build();
    let threads = threads.context("cannot start threads")?;
    question.pages(&remote, |rows| {
        let fetch = || {
            rows.par_iter()
                .map(|row| image(&remote, arguments, row))
                .collect()
        };
        let page: Result<Vec<Image>, Failure> = threads.install(fetch);
        for image in page? {
            lists.add(&image)?;
            fetched += image.fetched;
            images += 1;
        }
        progress.set(images);
        Ok(())
    })?;
    progress.finish();
    lists.finish()?;
    let out = arguments.out.display();
    println!("{images} images in {out} ({fetched} files fetched, the others were there)");
    println!("metadata  {}", arguments.out.join(METADATA).display());
    println!("check     cd {out} && sha256sum --check --quiet {SUMS}");
    Ok(())
}

/// How many images the question has; also says early that a filter is wrong or a dataset unknown.
fn count(remote: &Remote, arguments: &Arguments) -> Result<u64, Failure> {
    let dataset = query_value(&arguments.dataset);
    let mut path = format!("/v1/datasets/{dataset}/stats?metrics=total_ms");
    if !arguments.filter.trim().is_empty() {
        path.push_str(&format!("&filter={}", query_value(&arguments.filter)));
    }
    let stats = remote.get(&path)?;
    let groups = stats["groups"].as_array().into_iter().flatten();
    Ok(groups.filter_map(|group| group["count"].as_u64()).sum())
}

/// An image whose files are in the folder.
struct Image {
    metadata: Value,
    /// Digest and path below the folder.
    files: Vec<(String, String)>,
    /// Codes and names of its classes.
    categories: Vec<(u8, String)>,
    fetched: usize,
}

fn image(remote: &Remote, arguments: &Arguments, row: &Value) -> Result<Image, Failure> {
    let job = row["job"].as_str().unwrap_or_default();
    let frame = row["frame"].as_u64().unwrap_or_default();
    let record = remote.get(&format!("/v1/images/{job}/{frame}"))?;
    let (mut files, mut fetched) = (Vec::new(), 0);
    let mut names = Map::new();
    for (position, kind) in arguments.kinds.iter().enumerate() {
        let artifact = find(&record, kind).ok_or_else(|| missing(&record, job, frame, kind))?;
        let media_type = artifact["media_type"].as_str().unwrap_or_default();
        let name = format!("{kind}/{job}-{frame:08}.{}", renderer::extension(media_type));
        let digest = artifact["digest"].as_str().unwrap_or_default().to_owned();
        let path = arguments.out.join(&name);
        if !std::fs::read(&path).is_ok_and(|bytes| sha256(&bytes) == digest) {
            let kind = query_value(kind);
            let bytes = remote.get_bytes(&format!("/v1/images/{job}/{frame}/artifacts/{kind}"))?;
            if sha256(&bytes) != digest {
                let message = format!("{kind} of {job}/{frame} arrived with another digest than {digest}");
                return Err(anyhow::anyhow!(message).into());
            }
            files::write(&path, &bytes)?;
            fetched += 1;
        }
        let column = if position == 0 { "file_name" } else { kind };
        names.insert(column.to_owned(), name.clone().into());
        files.push((digest, name));
    }
    names.extend(row.as_object().cloned().unwrap_or_default());
    Ok(Image {
        metadata: Value::Object(names),
        files,
        categories: categories(&record["scene"]),
        fetched,
    })
}

/// The classes of a frame with labels: its own, or those that all procedural scenes share.
fn categories(scene: &Value) -> Vec<(u8, String)> {
    let own: Option<Vec<SceneCategory>> = serde_json::from_value(scene["categories"].clone()).ok();
    match own {
        Some(own) => own
            .into_iter()
            .map(|category| (category.id, category.name))
            .collect(),
        None if scene["instances"].is_array() => {
            let fixed = CATEGORIES.iter();
            fixed
                .map(|(category, name)| (*category as u8, (*name).to_owned()))
                .collect()
        }
        None => Vec::new(),
    }
}

fn artifacts(record: &Value) -> impl Iterator<Item = &Value> {
    record["artifacts"].as_array().into_iter().flatten()
}

fn find<'a>(record: &'a Value, kind: &str) -> Option<&'a Value> {
    artifacts(record).find(|artifact| artifact["kind"] == kind)
}

fn missing(record: &Value, job: &str, frame: u64, kind: &str) -> Failure {
    let kinds: Vec<&str> = artifacts(record)
        .filter_map(|artifact| artifact["kind"].as_str())
        .collect();
    Failure::BadInput(format!(
        "image {job}/{frame} has no artifact `{kind}`; it has: {}",
        kinds.join(", ")
    ))
}

const METADATA: &str = "metadata.jsonl";
const SUMS: &str = "SHA256SUMS";
const CATEGORIES_FILE: &str = "categories.json";

/// The two lists, visible under their names only when they are whole.
struct Lists {
    out: PathBuf,
    metadata: std::io::BufWriter<std::fs::File>,
    sums: std::io::BufWriter<std::fs::File>,
    categories: BTreeSet<(u8, String)>,
}

impl Lists {
    fn create(out: &Path) -> Result<Self, Failure> {
        let open = |name: &str| {
            let path = out.join(format!(".{name}.part"));
            std::fs::File::create(&path)
                .map(std::io::BufWriter::new)
                .with_context(|| format!("cannot write {}", path.display()))
        };
        Ok(Self {
            out: out.to_owned(),
            metadata: open(METADATA)?,
            sums: open(SUMS)?,
            categories: BTreeSet::new(),
        })
    }

    fn add(&mut self, image: &Image) -> Result<(), Failure> {
        self.categories.extend(image.categories.iter().cloned());
        let mut write = || {
            writeln!(self.metadata, "{}", image.metadata)?;
            image
                .files
                .iter()
                .try_for_each(|(digest, name)| writeln!(self.sums, "{digest}  {name}"))
        };
        Ok(write().context("cannot write the lists of the export")?)
    }

    fn finish(self) -> Result<(), Failure> {
        let Self {
            out,
            metadata,
            sums,
            categories,
        } = self;
        write_categories(&out, &categories)?;
        for (list, name) in [(metadata, METADATA), (sums, SUMS)] {
            let file = list.into_inner().map_err(|error| error.into_error());
            file.and_then(|file| file.sync_all())
                .and_then(|()| std::fs::rename(out.join(format!(".{name}.part")), out.join(name)))
                .with_context(|| format!("cannot write {}", out.join(name).display()))?;
        }
        Ok(())
    }
}

/// Writes the classes of all images, and warns of a code that means different things in different scenes.
fn write_categories(out: &Path, categories: &BTreeSet<(u8, String)>) -> Result<(), Failure> {
    if categories.is_empty() {
        return Ok(());
    }
    let pairs = categories.iter().zip(categories.iter().skip(1));
    for ((id, name), (_, other)) in pairs.filter(|((id, _), (next, _))| id == next) {
        eprintln!(
            "warning: code {id} is `{name}` in some scenes and `{other}` in others; give their classes ids of your own"
        );
    }
    let list: Vec<Value> = categories
        .iter()
        .map(|(id, name)| json!({"id": id, "name": name}))
        .collect();
    files::write(
        &out.join(CATEGORIES_FILE),
        format!("{:#}\n", json!(list)).as_bytes(),
    )
}
