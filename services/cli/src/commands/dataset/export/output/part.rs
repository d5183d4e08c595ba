//! A part of an export: a folder with separate lists, or the whole export.

use std::path::PathBuf;

use cli::classes::Named;
use cli::exit::Failure;
use cli::plural::count;
use client::ImageRow;

use crate::commands::dataset::export::files::lists::{Lists, METADATA, SUMS};
use crate::commands::dataset::export::files::target::Target;
use crate::commands::dataset::export::format::Format;
use crate::commands::dataset::export::formats::class_numbers::ClassNumbers;
use crate::commands::dataset::export::formats::coco::{Coco, Picture};
use crate::commands::dataset::export::formats::croissant::RowFile;
use crate::commands::dataset::export::formats::objects::{Object, objects};
use crate::commands::dataset::export::formats::poses::Poses;
use crate::commands::dataset::export::formats::sequences::body::Sequences;
use crate::commands::dataset::export::formats::sequences::layout::SequencePlace;
use crate::commands::dataset::export::formats::sequences::timed_frame::TimedFrame;
use crate::commands::dataset::export::formats::view::View;
use crate::commands::dataset::export::formats::yolo::{IMAGES, Labeled, Yolo};
use crate::commands::dataset::export::formats::{hf, parquet};
use crate::commands::dataset::export::input::frame::{Frame, Home, Place};
use crate::commands::dataset::export::input::selection::Selection;
use crate::commands::dataset::export::input::sequences::Spot;
use crate::commands::dataset::export::object_filter::ObjectFilter;
use crate::commands::dataset::export::output::recordings::Recordings;
use crate::commands::dataset::export::output::shards::Shards;

/// A part that is being filled.
pub(crate) struct Part {
    pub(crate) name: Option<String>,
    pub(crate) folder: PathBuf,
    pub(crate) lists: Lists,
    pub(crate) body: Body,
}

/// The format-specific state of a part.
pub(crate) enum Body {
    Files,
    Shards(Shards),
    Coco(Coco),
    Yolo(Yolo),
    Poses(Poses),
    Sequences(Sequences),
    Recordings(Recordings),
}

/// A frame to fetch.
pub(crate) struct Task {
    pub(crate) row: ImageRow,
    pub(crate) place: Place,
    pub(crate) spot: Option<Spot>,
    /// Its place in a format with times.
    pub(crate) timed: Option<SequencePlace>,
    /// Position of its part.
    pub(crate) part: usize,
    pub(crate) home: Home,
}

/// The format-specific content of a frame's files.
pub(crate) enum Content {
    Files,
    Objects(Vec<Object>),
    View(View),
    Timed(TimedFrame),
}

impl Task {
    /// Where the files of a frame go.
    pub(crate) fn home(format: Format, place: &Place, spot: Option<&Spot>) -> Home {
        match spot {
            Some(spot) if format.needs_poses() && !format.has_times() => Poses::home(place, spot),
            _ if format == Format::Yolo => Home::nested(&[IMAGES], place),
            _ => Home::nested(&[], place),
        }
    }
}

impl Content {
    /// Reads the content that a format needs from a frame's files in a folder.
    pub(crate) fn read(
        format: Format,
        filter: &ObjectFilter,
        folder: &std::path::Path,
        frame: &Frame,
    ) -> Result<Self, Failure> {
        match format {
            Format::Coco | Format::Yolo => {
                let mut objects = objects(folder, frame, format == Format::Coco)?;
                objects.retain(|object| filter.takes(&object.record));
                Ok(Self::Objects(objects))
            }
            Format::Colmap | Format::Transforms => View::read(folder, frame).map(Self::View),
            _ => Ok(Self::Files),
        }
    }
}

impl Part {
    pub(crate) fn open(
        target: &Target,
        name: Option<String>,
        format: Format,
        shard_size: usize,
    ) -> Result<Self, Failure> {
        let folder = target.folder(name.as_deref().as_slice())?;
        let below = |inside: &str| {
            let names: Vec<&str> = name.as_deref().into_iter().chain([inside]).collect();
            target.folder(&names)
        };
        let body = match format {
            Format::Folder | Format::Hf => Body::Files,
            Format::WebDataset => Body::Shards(Shards::new(folder.clone(), shard_size)),
            Format::Parquet => Body::Shards(Shards::new(below(parquet::FOLDER)?, shard_size)),
            Format::Coco => Body::Coco(Coco::create(&folder)?),
            Format::Yolo => Body::Yolo(Yolo::new(&folder)),
            Format::Colmap | Format::Transforms => Body::Poses(Poses::default()),
            Format::Tum | Format::Euroc | Format::Kitti => Body::Sequences(Sequences::default()),
            Format::Mcap => Body::Recordings(Recordings::new(folder.clone())),
        };
        Ok(Self {
            lists: Lists::create(&folder)?,
            name,
            folder,
            body,
        })
    }

    /// Adds a frame whose files are in the folder.
    pub(crate) fn add(
        &mut self,
        target: &Target,
        task: &Task,
        frame: &Frame,
        content: Content,
        classes: &mut ClassNumbers,
    ) -> Result<(), Failure> {
        self.lists.add(&frame.metadata)?;
        for file in &frame.files {
            self.lists.add_sum(&file.digest, &file.name)?;
        }
        match (&mut self.body, content) {
            (Body::Coco(coco), Content::Objects(objects)) => {
                let spot = task.spot.as_ref();
                let place = &task.place;
                coco.add(
                    &Picture {
                        frame,
                        place,
                        spot,
                        objects,
                    },
                    classes,
                )
            }
            (Body::Yolo(yolo), Content::Objects(objects)) => {
                let labeled = Labeled {
                    target,
                    part: self.name.as_deref(),
                    home: &task.home,
                    frame,
                    objects: &objects,
                };
                yolo.add(&labeled, classes, &mut self.lists)
            }
            (Body::Poses(poses), Content::View(view)) => {
                if let Some(spot) = &task.spot {
                    poses.add(frame, spot, view);
                }
                Ok(())
            }
            (Body::Sequences(sequences), Content::Timed(timed)) => match &task.timed {
                Some(place) => sequences.add(place, timed),
                None => Ok(()),
            },
            _ => Ok(()),
        }
    }

    /// Adds the classes of the objects of a frame.
    pub(crate) fn add_classes(&mut self, classes: Named) {
        self.lists.classes.extend(classes);
    }

    /// Writes the files that depend on all frames; returns the list of rows.
    pub(crate) fn finish(&mut self, export: &Finish<'_>) -> Result<RowFile, Failure> {
        let body = std::mem::replace(&mut self.body, Body::Files);
        let mut files = match body {
            Body::Files | Body::Shards(_) | Body::Recordings(_) => Vec::new(),
            Body::Coco(coco) => vec![coco.finish(export.dataset, export.classes)?],
            Body::Yolo(yolo) => vec![yolo.finish()?],
            Body::Poses(poses) => poses.finish(export.format, export.target, self.name.as_deref())?,
            Body::Sequences(sequences) => {
                sequences.finish(export.format, export.target, self.name.as_deref())?
            }
        };
        let rows = self.lists.finish_rows()?;
        let list = match export.format {
            Format::Hf => {
                let Selection { columns, kinds, .. } = export.selection;
                hf::write(&self.folder, rows, columns, kinds)?
            }
            _ => {
                rows.keep()?;
                METADATA.to_owned()
            }
        };
        println!("metadata  {}", self.folder.join(&list).display());
        let sha256 = crate::commands::dataset::export::files::lists::digest_of(&self.folder.join(&list))?;
        files.push(list.clone());
        self.lists.add_files(&files)?;
        self.lists.finish_classes()?;
        let above = self
            .name
            .as_ref()
            .map_or_else(String::new, |name| format!("{name}/"));
        let name = format!("{above}{list}");
        let columns = std::mem::take(&mut self.lists.columns);
        Ok(RowFile {
            name,
            sha256,
            columns,
        })
    }

    /// Completes the sums.
    pub(crate) fn close(self) -> Result<(), Failure> {
        if let Some(name) = &self.name {
            println!("{name}: {}", count(self.lists.frames, "image"));
        }
        self.lists.finish()?;
        println!(
            "check     cd {} && sha256sum --check --quiet {SUMS}",
            self.folder.display()
        );
        Ok(())
    }
}

/// Settings of the whole export for the end of a part.
pub(crate) struct Finish<'a> {
    pub(crate) dataset: &'a str,
    pub(crate) format: Format,
    pub(crate) target: &'a Target,
    pub(crate) selection: &'a Selection,
    pub(crate) classes: &'a ClassNumbers,
}
