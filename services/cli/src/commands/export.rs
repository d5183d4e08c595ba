//! `fathom export`: the images of a dataset in a form that training scripts and their libraries read.
//!
//! ```text
//! OUT/README.md, croissant.json  the card of the export, for people and for catalogs
//! OUT/fields.json                unit and meaning of every array and column
//! OUT/metadata.jsonl             one line per image: where its files are, parameters, labels, metrics
//! OUT/categories.json            id and name of every class, where semantics or boxes were exported
//! OUT/SHA256SUMS                 every file with its digest, as `sha256sum --check` reads it
//! OUT/JOB/FRAME/KIND.EXTENSION   the files of a job as `fathom render` writes them; other formats have others
//! ```
//!
//! With `--split`, each part is a folder with lists of its own: `OUT/train/metadata.jsonl` and so on.

mod archive;
mod card;
mod class_numbers;
mod coco;
mod colmap;
mod croissant;
mod documents;
mod fields;
mod format;
mod frame;
mod hf;
mod lists;
mod objects;
mod origins;
mod parquet;
mod part;
mod poses;
mod rle;
mod selection;
mod sequences;
mod shards;
mod split;
pub mod tables;
mod target;
mod transforms;
mod view;
mod webdataset;
mod yolo;

use std::path::PathBuf;

use anyhow::Context;
use cli::classes::{Named, SceneClasses};
use cli::exit::Failure;
use cli::images::Question;
use cli::progress::Progress;
use cli::remote::{Remote, ServerArguments};
use rayon::prelude::*;
use serde_json::Value;
use spec::ArtifactKind;

use super::cluster::hand_over;
use class_numbers::ClassNumbers;
use documents::Documents;
use format::Format;
use frame::{Frame, Order, Place};
use origins::Met;
use part::{Body, Content, Finish, Part, Task};
use selection::Selection;
use sequences::Sequences;
use shards::Writer;
use split::Splits;
use tables::WriteTable;
use target::Target;

/// Options of `fathom export`.
#[derive(clap::Args)]
pub struct Arguments {
    /// The dataset
    dataset: String,
    /// How the export is laid out
    #[arg(long, value_enum, default_value = "folder")]
    format: Format,
    /// Which images, such as 'uiqm > 0.8 and water.style in ("muddy")' [default: all]
    #[arg(long, default_value = "")]
    filter: String,
    /// Kinds of artifacts, comma-separated; the first one becomes the `file_name` column. Formats add those that they are made of
    #[arg(long, value_delimiter = ',', default_value = "rgb", value_parser = kind)]
    kinds: Vec<String>,
    /// Parts with their shares, such as train=.8,val=.1,test=.1, each in a folder of its name; images of one scene are never in
    /// two parts, and no image changes its part when the dataset grows
    #[arg(long, value_name = "PARTS", value_parser = Splits::parse)]
    split: Option<Splits>,
    /// Frames of each file of the formats webdataset and parquet
    #[arg(long, default_value_t = 1000, value_name = "FRAMES", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    shard_size: u32,
    /// License that the card states, such as cc-by-4.0; those of waters and styles stand in the card, too
    #[arg(long, default_value = "other", value_name = "LICENSE")]
    license: String,
    /// The folder to fill; what is already there with the right digest is kept
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

/// Runs the command. Without `tables` it becomes `fathom-cluster` for the formats that hold Parquet.
pub fn run(arguments: &Arguments, tables: Option<WriteTable>) -> Result<(), Failure> {
    let format = arguments.format;
    if format.needs_tables() && tables.is_none() {
        return hand_over();
    }
    let remote = Remote::new(&arguments.server);
    let selection = Selection::ask(&remote, arguments)?;
    let split = arguments.split.as_ref();
    let shard_size = arguments.shard_size as usize;
    let card = format.card(
        &arguments.dataset,
        split.map(Splits::to_string),
        &selection.kinds,
        shard_size,
    );
    let target = Target::open(&arguments.out, &card)?;
    let columns = selection.column_names();
    let threads = rayon::ThreadPoolBuilder::new().num_threads(DOWNLOADS).build();
    let names: Vec<Option<String>> = match split {
        Some(split) => split.names().map(|name| Some(name.to_owned())).collect(),
        None => vec![None],
    };
    let parts = names
        .into_iter()
        .map(|name| Part::open(&target, name, format, shard_size));
    let mut export = Export {
        arguments,
        tables,
        remote: &remote,
        selection: &selection,
        order: Order {
            remote: &remote,
            target: &target,
            kinds: &selection.kinds,
            columns: &columns,
        },
        threads: threads.context("cannot start threads")?,
        parts: parts.collect::<Result<_, _>>()?,
        sequences: Sequences::new(&remote, &arguments.dataset),
        scenes: SceneClasses::new(&remote),
        classes: ClassNumbers::default(),
        met: Met::default(),
        images: 0,
        fetched: 0,
    };
    let question = Question {
        dataset: Some(&arguments.dataset),
        filter: &arguments.filter,
        order_by: None,
        fields: &columns,
        limit: usize::MAX,
    };
    let mut progress = Progress::new("export", "images", selection.images);
    question.pages(&remote, |rows| {
        export.take(rows)?;
        progress.set(export.images);
        Ok(())
    })?;
    progress.finish();
    export.finish()
}

/// An export under way.
struct Export<'a> {
    arguments: &'a Arguments,
    tables: Option<WriteTable>,
    remote: &'a Remote,
    selection: &'a Selection,
    order: Order<'a>,
    threads: rayon::ThreadPool,
    parts: Vec<Part>,
    sequences: Sequences<'a>,
    scenes: SceneClasses<'a>,
    /// Classes under the numbers that they have in all parts.
    classes: ClassNumbers,
    met: Met,
    images: u64,
    fetched: usize,
}

impl Export<'_> {
    /// Takes the next rows, in the order of jobs and frames.
    fn take(&mut self, rows: Vec<Value>) -> Result<(), Failure> {
        self.images += rows.len() as u64;
        let has_classes = self
            .selection
            .kinds
            .iter()
            .any(|kind| kind == "semantics" || kind == "boxes");
        for row in &rows {
            self.met.add(row);
            if has_classes {
                let mut classes = Named::new();
                self.scenes.add(row, &mut classes)?;
                self.classes.add(&classes);
                let part = self.part_of(row);
                self.parts[part].add_classes(classes);
            }
        }
        match self.arguments.format.is_sharded() {
            true => self.gather(rows),
            false => self.fetch(rows),
        }
    }

    fn part_of(&self, row: &Value) -> usize {
        let split = self.arguments.split.as_ref();
        split.map_or(0, |split| split.part_of(row))
    }

    /// Adds rows to the shards of their parts.
    fn gather(&mut self, rows: Vec<Value>) -> Result<(), Failure> {
        for row in rows {
            let part = self.part_of(&row);
            let writer = writer(
                &self.order,
                &self.threads,
                self.arguments.format,
                self.selection,
                self.tables,
            );
            let Part { body, lists, .. } = &mut self.parts[part];
            if let Body::Shards(shards) = body {
                self.fetched += shards.add(&writer, lists, row)?;
            }
        }
        Ok(())
    }

    /// Fetches the files of frames into the folders of their parts.
    fn fetch(&mut self, rows: Vec<Value>) -> Result<(), Failure> {
        let format = self.arguments.format;
        let needs_spots = format.needs_poses() || format == Format::Coco;
        let mut tasks = Vec::with_capacity(rows.len());
        for row in rows {
            let place = Place::of(&row)?;
            let spot = match needs_spots {
                true => self.sequences.spot(&row, &place)?,
                false => None,
            };
            tasks.push(Task {
                part: self.part_of(&row),
                home: Task::home(format, &place, spot.as_ref()),
                row,
                place,
                spot,
            });
        }
        let (parts, order) = (&self.parts, &self.order);
        let fetch = |task: &Task| {
            let part = &parts[task.part];
            let frame = order.carry_out(&task.row, &task.place, part.name.as_deref(), &task.home)?;
            let content = Content::read(format, &part.folder, &frame)?;
            Ok((frame, content))
        };
        let frames: Result<Vec<(Frame, Content)>, Failure> =
            self.threads.install(|| tasks.par_iter().map(fetch).collect());
        for (task, (frame, content)) in tasks.iter().zip(frames?) {
            self.fetched += frame.fetched;
            let part = &mut self.parts[task.part];
            part.add(self.order.target, task, &frame, content, &mut self.classes)?;
        }
        Ok(())
    }

    fn finish(mut self) -> Result<(), Failure> {
        let format = self.arguments.format;
        let writer = writer(&self.order, &self.threads, format, self.selection, self.tables);
        for Part { body, lists, .. } in &mut self.parts {
            if let Body::Shards(shards) = body {
                self.fetched += shards.finish(&writer, lists)?;
            }
        }
        println!(
            "{} images in {} ({} files fetched, the others were there)",
            self.images,
            self.order.target.root().display(),
            self.fetched
        );
        let whole = Finish {
            dataset: &self.arguments.dataset,
            format,
            target: self.order.target,
            selection: self.selection,
            classes: &self.classes,
            tables: self.tables,
        };
        let rows = self.parts.iter_mut().map(|part| part.finish(&whole));
        let rows = rows.collect::<Result<Vec<_>, _>>()?;
        let documents = Documents {
            arguments: self.arguments,
            selection: self.selection,
            target: self.order.target,
            classes: &self.classes,
            origins: &self.met.origins(self.remote)?,
            rows: &rows,
        };
        documents.write(self.parts)
    }
}

fn writer<'a>(
    order: &'a Order<'a>,
    threads: &'a rayon::ThreadPool,
    format: Format,
    selection: &'a Selection,
    tables: Option<WriteTable>,
) -> Writer<'a> {
    Writer {
        order,
        threads,
        format,
        columns: &selection.columns,
        tables,
    }
}
