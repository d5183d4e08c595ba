//! A running export: rows are added, files are written, part by part.

use std::collections::BTreeSet;

use anyhow::Context;
use cli::classes::{Named, SceneClasses};
use cli::exit::Failure;
use cli::plural::count;
use client::ImageRow;
use rayon::prelude::*;

use crate::commands::dataset::export::arguments::Arguments;
use crate::commands::dataset::export::format::Format;
use crate::commands::dataset::export::formats::class_numbers::ClassNumbers;
use crate::commands::dataset::export::formats::sequences::timed_frame::FrameOrder;
use crate::commands::dataset::export::input::frame::{Frame, Place};
use crate::commands::dataset::export::input::order::Order;
use crate::commands::dataset::export::input::origins::UsedNames;
use crate::commands::dataset::export::input::selection::Selection;
use crate::commands::dataset::export::input::sequences::Sequences;
use crate::commands::dataset::export::input::times::{SEQUENCE, STAMP, Timed, Times};
use crate::commands::dataset::export::output::documents::Documents;
use crate::commands::dataset::export::output::part::{Body, Content, Finish, Part, Task};
use crate::commands::dataset::export::output::shards::Writer;

/// Concurrent downloads: enough to keep a local service busy, few enough to leave it room for others.
const DOWNLOADS: usize = 4;

/// A running export.
pub(crate) struct Export<'a> {
    arguments: &'a Arguments,
    selection: &'a Selection,
    order: Order<'a>,
    threads: rayon::ThreadPool,
    parts: Vec<Part>,
    sequences: Sequences<'a>,
    times: Times<'a>,
    scenes: SceneClasses<'a>,
    /// Classes under the numbers that they have in all parts.
    classes: ClassNumbers,
    /// Names of all classes of the scenes.
    class_names: BTreeSet<String>,
    used_names: UsedNames,
    images: u64,
    fetched: usize,
}

impl<'a> Export<'a> {
    /// Opens the folders of all parts.
    pub(crate) fn begin(
        arguments: &'a Arguments,
        selection: &'a Selection,
        order: Order<'a>,
    ) -> Result<Self, Failure> {
        let threads = rayon::ThreadPoolBuilder::new().num_threads(DOWNLOADS).build();
        let names: Vec<Option<String>> = match &arguments.split {
            Some(split) => split.names().map(|name| Some(name.to_owned())).collect(),
            None => vec![None],
        };
        let shard_size = arguments.frames_per_shard();
        Ok(Self {
            parts: names
                .into_iter()
                .map(|name: Option<String>| Part::open(order.target, name, arguments.format, shard_size))
                .collect::<Result<_, _>>()?,
            threads: threads.context("cannot start threads")?,
            sequences: Sequences::new(order.client, &arguments.dataset),
            times: Times::new(order.client, &arguments.dataset),
            scenes: SceneClasses::new(order.client),
            classes: ClassNumbers::default(),
            class_names: BTreeSet::new(),
            used_names: UsedNames::default(),
            images: 0,
            fetched: 0,
            arguments,
            selection,
            order,
        })
    }

    /// Images so far.
    pub(crate) fn images(&self) -> u64 {
        self.images
    }

    /// Adds the next rows, in the order of jobs and frames.
    pub(crate) fn add(&mut self, mut rows: Vec<ImageRow>) -> Result<(), Failure> {
        self.images += rows.len() as u64;
        let has_classes = self
            .selection
            .kinds
            .iter()
            .any(|kind| matches!(kind.as_str(), "semantics" | "semantics.visible" | "boxes"));
        for row in &rows {
            self.used_names.add(row);
            if has_classes {
                let mut classes = Named::new();
                self.scenes.add(row, &mut classes)?;
                self.class_names
                    .extend(classes.iter().map(|(_, name)| name.clone()));
                let taken = classes.iter().filter(|(_, name)| {
                    !self.arguments.format.has_objects() || self.arguments.objects.takes_class(name)
                });
                self.classes.add(&taken.cloned().collect());
                let part = self.part_of(row);
                self.parts[part].add_classes(classes);
            }
        }
        let format = self.arguments.format;
        if format.has_times() {
            rows.iter_mut().try_for_each(|row| self.add_time(row))?;
        }
        match format.shares_files() {
            true => self.gather(rows),
            false => self.fetch(rows),
        }
    }

    /// Adds the columns of the sequence and the time.
    fn add_time(&mut self, row: &mut ImageRow) -> Result<(), Failure> {
        let Timed { sequence, stamp_ns } = self.times.assign_time(row, &Place::read(row)?)?;
        row.0.insert(SEQUENCE.to_owned(), sequence.into());
        row.0.insert(STAMP.to_owned(), stamp_ns.into());
        Ok(())
    }

    fn part_of(&self, row: &ImageRow) -> usize {
        let split = self.arguments.split.as_ref();
        split.map_or(0, |split| split.part_of(row))
    }

    /// Adds rows to the shards of their parts.
    fn gather(&mut self, rows: Vec<ImageRow>) -> Result<(), Failure> {
        for row in rows {
            let part = self.part_of(&row);
            let writer = writer(&self.order, &self.threads, self.arguments.format, self.selection);
            let Part { body, lists, .. } = &mut self.parts[part];
            self.fetched += match body {
                Body::Shards(shards) => shards.add(&writer, lists, row)?,
                Body::Recordings(recordings) => recordings.add(&writer, lists, row)?,
                _ => 0,
            };
        }
        Ok(())
    }

    /// Fetches the files of frames into the folders of their parts.
    fn fetch(&mut self, rows: Vec<ImageRow>) -> Result<(), Failure> {
        let tasks = self.place_frames(rows)?;
        let (parts, order, arguments) = (&self.parts, &self.order, self.arguments);
        let frames: Result<Vec<(Frame, Content)>, Failure> = self.threads.install(|| {
            let frames = tasks.par_iter().map(|task| {
                let part = &parts[task.part];
                complete_frame(order, arguments, part, task)
            });
            frames.collect()
        });
        for (task, (frame, content)) in tasks.iter().zip(frames?) {
            self.fetched += frame.fetched;
            let part = &mut self.parts[task.part];
            part.add(self.order.target, task, &frame, content, &mut self.classes)?;
        }
        Ok(())
    }

    /// Where the files of frames go.
    fn place_frames(&mut self, rows: Vec<ImageRow>) -> Result<Vec<Task>, Failure> {
        let format = self.arguments.format;
        let needs_spots = !format.has_times() && (format.needs_poses() || format == Format::Coco);
        let mut tasks = Vec::with_capacity(rows.len());
        for row in rows {
            let place = Place::read(&row)?;
            let spot = match needs_spots {
                true => self.sequences.spot(&row, &place)?,
                false => None,
            };
            let part = self.part_of(&row);
            let timed = match &mut self.parts[part].body {
                Body::Sequences(sequences) => Some(sequences.assign_place(&Timed::read(&row)?)),
                _ => None,
            };
            tasks.push(Task {
                part,
                home: Task::home(format, &place, spot.as_ref()),
                row,
                place,
                spot,
                timed,
            });
        }
        Ok(tasks)
    }

    /// Completes all parts and their documents.
    pub(crate) fn finish(mut self) -> Result<(), Failure> {
        let format = self.arguments.format;
        let writer = writer(&self.order, &self.threads, format, self.selection);
        for Part { body, lists, .. } in &mut self.parts {
            self.fetched += match body {
                Body::Shards(shards) => shards.finish(&writer, lists)?,
                Body::Recordings(recordings) => recordings.write(&writer, lists)?,
                _ => 0,
            };
        }
        let present = self.class_names.iter().map(String::as_str);
        for class in self.arguments.objects.list_absent(present) {
            eprintln!("warning: no scene has the class `{class}` of --classes");
        }
        println!(
            "{} in {} ({} fetched, the others were there)",
            count(self.images, "image"),
            self.order.target.root().display(),
            count(self.fetched, "file")
        );
        let whole = Finish {
            dataset: &self.arguments.dataset,
            format,
            target: self.order.target,
            selection: self.selection,
            classes: &self.classes,
        };
        let rows = self.parts.iter_mut().map(|part| part.finish(&whole));
        let rows = rows.collect::<Result<Vec<_>, _>>()?;
        let documents = Documents {
            arguments: self.arguments,
            selection: self.selection,
            target: self.order.target,
            classes: &self.classes,
            origins: &self.used_names.origins(self.order.client)?,
            rows: &rows,
        };
        documents.write(self.parts)
    }
}

/// Fetches the files of a frame that are missing, and reads what the format needs of them.
fn complete_frame(
    order: &Order<'_>,
    arguments: &Arguments,
    part: &Part,
    task: &Task,
) -> Result<(Frame, Content), Failure> {
    let format = arguments.format;
    let name = part.name.as_deref();
    if let Some(spot) = &task.timed {
        let frame = FrameOrder {
            order,
            format,
            part: name,
            row: &task.row,
            place: &task.place,
            spot,
        };
        let (frame, timed) = frame.complete()?;
        return Ok((frame, Content::Timed(timed)));
    }
    let frame = order.complete(&task.row, &task.place, name, &task.home)?;
    let content = Content::read(format, &arguments.objects, &part.folder, &frame)?;
    Ok((frame, content))
}

fn writer<'a>(
    order: &'a Order<'a>,
    threads: &'a rayon::ThreadPool,
    format: Format,
    selection: &'a Selection,
) -> Writer<'a> {
    Writer {
        order,
        threads,
        format,
        columns: &selection.columns,
    }
}
