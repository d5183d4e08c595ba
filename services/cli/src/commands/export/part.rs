//! A part of an export: a folder with separate lists, or the whole export.

use std::path::PathBuf;

use cli::classes::Named;
use cli::exit::Failure;
use client::ImageRow;

use super::class_numbers::ClassNumbers;
use super::coco::{Coco, Picture};
use super::croissant::RowFile;
use super::format::Format;
use super::frame::{Frame, Home, Place};
use super::hf;
use super::lists::{Lists, METADATA, SUMS};
use super::objects::{Object, objects};
use super::parquet;
use super::poses::Poses;
use super::selection::Selection;
use super::sequences::Spot;
use super::shards::Shards;
use super::tables::WriteTable;
use super::target::Target;
use super::view::View;
use super::yolo::{IMAGES, Labeled, Yolo};

/// A part that is being filled.
pub(super) struct Part {
    pub(super) name: Option<String>,
    pub(super) folder: PathBuf,
    pub(super) lists: Lists,
    pub(super) body: Body,
}

/// The format-specific state of a part.
pub(super) enum Body {
    Files,
    Shards(Shards),
    Coco(Coco),
    Yolo(Yolo),
    Poses(Poses),
}

/// A frame to fetch.
pub(super) struct Task {
    pub(super) row: ImageRow,
    pub(super) place: Place,
    pub(super) spot: Option<Spot>,
    /// Position of its part.
    pub(super) part: usize,
    pub(super) home: Home,
}

/// The format-specific content of a frame's files.
pub(super) enum Content {
    Files,
    Objects(Vec<Object>),
    View(View),
}

impl Task {
    /// Where the files of a frame go.
    pub(super) fn home(format: Format, place: &Place, spot: Option<&Spot>) -> Home {
        match spot {
            Some(spot) if format.needs_poses() => Poses::home(place, spot),
            _ if format == Format::Yolo => Home::nested(&[IMAGES], place),
            _ => Home::nested(&[], place),
        }
    }
}

impl Content {
    /// Reads the content that a format needs from a frame's files in a folder.
    pub(super) fn read(format: Format, folder: &std::path::Path, frame: &Frame) -> Result<Self, Failure> {
        match format {
            Format::Coco => objects(folder, frame, true).map(Self::Objects),
            Format::Yolo => objects(folder, frame, false).map(Self::Objects),
            Format::Colmap | Format::Transforms => View::read(folder, frame).map(Self::View),
            Format::Folder | Format::WebDataset | Format::Parquet | Format::Hf => Ok(Self::Files),
        }
    }
}

impl Part {
    pub(super) fn open(
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
        };
        Ok(Self {
            lists: Lists::create(&folder)?,
            name,
            folder,
            body,
        })
    }

    /// Adds a frame whose files are in the folder.
    pub(super) fn add(
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
            _ => Ok(()),
        }
    }

    /// Adds the classes of the objects of a frame.
    pub(super) fn add_classes(&mut self, classes: Named) {
        self.lists.classes.extend(classes);
    }

    /// Writes the files that depend on all frames; returns the list of rows.
    pub(super) fn finish(&mut self, export: &Finish<'_>) -> Result<RowFile, Failure> {
        let body = std::mem::replace(&mut self.body, Body::Files);
        let mut files = match body {
            Body::Files | Body::Shards(_) => Vec::new(),
            Body::Coco(coco) => vec![coco.finish(export.dataset, export.classes)?],
            Body::Yolo(yolo) => vec![yolo.finish()?],
            Body::Poses(poses) => poses.finish(export.format, export.target, self.name.as_deref())?,
        };
        let rows = self.lists.finish_rows()?;
        let list = match export.tables.filter(|_| export.format == Format::Hf) {
            Some(tables) => {
                let Selection { columns, kinds, .. } = export.selection;
                hf::write(tables, &self.folder, rows, columns, kinds)?
            }
            None => {
                rows.keep()?;
                METADATA.to_owned()
            }
        };
        println!("metadata  {}", self.folder.join(&list).display());
        let sha256 = super::lists::digest_of(&self.folder.join(&list))?;
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
    pub(super) fn close(self) -> Result<(), Failure> {
        if let Some(name) = &self.name {
            println!("{name}: {} images", self.lists.frames);
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
pub(super) struct Finish<'a> {
    pub(super) dataset: &'a str,
    pub(super) format: Format,
    pub(super) target: &'a Target,
    pub(super) selection: &'a Selection,
    pub(super) classes: &'a ClassNumbers,
    pub(super) tables: Option<WriteTable>,
}
