//! `fathom export`: the images of a dataset as a folder that training scripts read.
//!
//! ```text
//! OUT/metadata.jsonl        one line per image: file_name, the files of the other kinds, parameters, metrics
//! OUT/SHA256SUMS            every picture with its digest, as `sha256sum --check` reads it
//! OUT/rgb/JOB-FRAME.png     a folder per kind
//! ```

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use anyhow::Context;
use cli::exit::Failure;
use cli::files;
use cli::images::Question;
use cli::progress::Progress;
use cli::remote::{Remote, ServerArguments, query_value};
use serde_json::{Map, Value};
use spec::sha256;

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
    let mut progress = Progress::new("export", count(&remote, arguments)?);
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
    question.pages(&remote, |rows| {
        for image in parallel(&rows, |row| image(&remote, arguments, row))? {
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
    let stats = remote.get(&path)?.json()?;
    let groups = stats
        .get("groups")
        .and_then(Value::as_array)
        .into_iter()
        .flatten();
    Ok(groups.filter_map(|group| group.get("count")?.as_u64()).sum())
}

/// An image whose files are in the folder.
struct Image {
    metadata: Value,
    /// Digest and path below the folder.
    files: Vec<(String, String)>,
    fetched: usize,
}

fn image(remote: &Remote, arguments: &Arguments, row: &Value) -> Result<Image, Failure> {
    let job = row.get("job").and_then(Value::as_str).unwrap_or_default();
    let frame = row.get("frame").and_then(Value::as_u64).unwrap_or_default();
    let record = remote.get(&format!("/v1/images/{job}/{frame}"))?.json()?;
    let (mut files, mut fetched) = (Vec::new(), 0);
    let mut names = Map::new();
    for (position, kind) in arguments.kinds.iter().enumerate() {
        let artifact = find(&record, kind).ok_or_else(|| missing(&record, job, frame, kind))?;
        let (digest, media_type) = artifact;
        let name = format!("{kind}/{job}-{frame:08}.{}", extension(&media_type));
        let path = arguments.out.join(&name);
        if !std::fs::read(&path).is_ok_and(|bytes| sha256(&bytes) == digest) {
            let answer = remote.get(&format!(
                "/v1/images/{job}/{frame}/artifacts/{}",
                query_value(kind)
            ))?;
            if sha256(&answer.bytes) != digest {
                return Err(anyhow::anyhow!(
                    "{kind} of {job}/{frame} arrived with another digest than {digest}"
                )
                .into());
            }
            files::write(&path, &answer.bytes)?;
            fetched += 1;
        }
        let column = if position == 0 { "file_name" } else { kind };
        names.insert(column.to_owned(), name.clone().into());
        files.push((digest, name));
    }
    let parameters = row.as_object().cloned().unwrap_or_default();
    names.extend(parameters);
    Ok(Image {
        metadata: Value::Object(names),
        files,
        fetched,
    })
}

/// Digest and media type of an artifact.
fn find(record: &Value, kind: &str) -> Option<(String, String)> {
    let artifacts = record.get("artifacts")?.as_array()?;
    let artifact = artifacts
        .iter()
        .find(|a| a.get("kind").and_then(Value::as_str) == Some(kind))?;
    let text = |name: &str| artifact.get(name).and_then(Value::as_str).map(str::to_owned);
    Some((text("digest")?, text("media_type")?))
}

fn missing(record: &Value, job: &str, frame: u64, kind: &str) -> Failure {
    let artifacts = record
        .get("artifacts")
        .and_then(Value::as_array)
        .into_iter()
        .flatten();
    let kinds: Vec<&str> = artifacts.filter_map(|a| a.get("kind")?.as_str()).collect();
    Failure::BadInput(format!(
        "image {job}/{frame} has no artifact `{kind}`; it has: {}",
        kinds.join(", ")
    ))
}

fn extension(media_type: &str) -> &'static str {
    match media_type {
        "image/png" => "png",
        "image/jpeg" => "jpg",
        "image/webp" => "webp",
        _ => "npy",
    }
}

/// Works on all items with a few threads; answers in their order, or the first error.
fn parallel<T: Sync, R: Send>(
    items: &[T],
    work: impl Fn(&T) -> Result<R, Failure> + Sync,
) -> Result<Vec<R>, Failure> {
    let next = AtomicUsize::new(0);
    let results: Vec<Mutex<Option<Result<R, Failure>>>> = items.iter().map(|_| Mutex::new(None)).collect();
    std::thread::scope(|scope| {
        for _ in 0..DOWNLOADS.min(items.len()) {
            scope.spawn(|| {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(item) = items.get(index) else { break };
                    let result = work(item);
                    if result.is_err() {
                        next.store(items.len(), Ordering::Relaxed);
                    }
                    *results[index].lock().unwrap_or_else(PoisonError::into_inner) = Some(result);
                }
            });
        }
    });
    let done = results
        .into_iter()
        .filter_map(|cell| cell.into_inner().unwrap_or_else(PoisonError::into_inner));
    done.collect()
}

const METADATA: &str = "metadata.jsonl";
const SUMS: &str = "SHA256SUMS";

/// The two lists, visible under their names only when they are whole.
struct Lists {
    out: PathBuf,
    metadata: std::io::BufWriter<std::fs::File>,
    sums: std::io::BufWriter<std::fs::File>,
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
        })
    }

    fn add(&mut self, image: &Image) -> Result<(), Failure> {
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
        let Self { out, metadata, sums } = self;
        for (list, name) in [(metadata, METADATA), (sums, SUMS)] {
            let file = list.into_inner().map_err(|error| error.into_error());
            file.and_then(|file| file.sync_all())
                .and_then(|()| std::fs::rename(out.join(format!(".{name}.part")), out.join(name)))
                .with_context(|| format!("cannot write {}", out.join(name).display()))?;
        }
        Ok(())
    }
}
