//! `annotations.json` as the COCO tools read it: pictures, categories, and for each object its box, area, mask and visibility.
//! Frames of a camera path are videos, and an object keeps its track from frame to frame.

use std::collections::HashMap;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use anyhow::Context;
use cli::exit::Failure;
use serde_json::{Value, json};

use crate::commands::dataset::export::files::target::{create, draft_of};
use crate::commands::dataset::export::formats::class_numbers::ClassNumbers;
use crate::commands::dataset::export::formats::objects::Object;
use crate::commands::dataset::export::input::frame::{Frame, Place};
use crate::commands::dataset::export::input::sequences::Spot;

const ANNOTATIONS: &str = "annotations.json";

/// A frame as the file describes it.
pub(crate) struct Picture<'a> {
    pub(crate) frame: &'a Frame,
    pub(crate) place: &'a Place,
    pub(crate) spot: Option<&'a Spot>,
    pub(crate) objects: Vec<Object>,
}

/// The file of a part that is being written.
pub(crate) struct Coco {
    path: PathBuf,
    pictures: BufWriter<File>,
    /// Joins the other draft in the end, since a file of JSON has one place for each list.
    annotations: BufWriter<File>,
    pictures_written: u64,
    annotations_written: u64,
    /// Numbers of the sequences and, within them, of the objects.
    videos: HashMap<String, u64>,
    tracks: HashMap<(u64, u16), u64>,
}

impl Coco {
    pub(crate) fn create(folder: &Path) -> Result<Self, Failure> {
        let path = folder.join(ANNOTATIONS);
        let open = |path: PathBuf| {
            let file = create(&path).map(BufWriter::new);
            file.with_context(|| format!("cannot write {}", path.display()))
        };
        Ok(Self {
            pictures: open(draft_of(&path))?,
            annotations: open(objects_of(&path))?,
            path,
            pictures_written: 0,
            annotations_written: 0,
            videos: HashMap::new(),
            tracks: HashMap::new(),
        })
    }

    /// Adds a frame with its objects.
    pub(crate) fn add(&mut self, picture: &Picture<'_>, classes: &mut ClassNumbers) -> Result<(), Failure> {
        let metadata = &picture.frame.metadata;
        let (width, height) = (&metadata["camera.width"], &metadata["camera.height"]);
        let id = self.pictures_written + 1;
        let video = picture.spot.map(|spot| self.video(&spot.sequence));
        let mut image = json!({
            "id": id, "file_name": metadata["file_name"], "width": width, "height": height,
            "job": picture.place.job, "frame": picture.place.frame
        });
        if let (Some(video), Some(spot)) = (video, picture.spot) {
            image["video_id"] = video.into();
            image["frame_id"] = spot.index.into();
        }
        let opening = if id == 1 { "{\"images\": [\n" } else { ",\n" };
        let path = &self.path;
        write!(self.pictures, "{opening}{image}").with_context(|| unwritable(path))?;
        self.pictures_written = id;
        for object in &picture.objects {
            let number = self.annotations_written + 1;
            let mut annotation = annotation(object, [height, width], classes);
            annotation["id"] = number.into();
            annotation["image_id"] = id.into();
            if let Some(video) = video {
                annotation["track_id"] = self.track(video, object.record.number).into();
            }
            let comma = if number == 1 { "" } else { ",\n" };
            write!(self.annotations, "{comma}{annotation}").with_context(|| unwritable(&self.path))?;
            self.annotations_written = number;
        }
        Ok(())
    }

    /// Completes the file; returns its name.
    pub(crate) fn finish(mut self, dataset: &str, classes: &ClassNumbers) -> Result<String, Failure> {
        let path = self.path.clone();
        self.join(dataset, classes).with_context(|| unwritable(&path))?;
        Ok(ANNOTATIONS.to_owned())
    }

    fn join(&mut self, dataset: &str, classes: &ClassNumbers) -> io::Result<()> {
        let categories = classes
            .all()
            .iter()
            .map(|(name, number)| json!({"id": number, "name": name}));
        let mut videos: Vec<(&String, &u64)> = self.videos.iter().collect();
        videos.sort_unstable_by_key(|(_, id)| **id);
        let videos = videos
            .into_iter()
            .map(|(name, id)| json!({"id": id, "name": name}));
        let (categories, videos): (Vec<Value>, Vec<Value>) = (categories.collect(), videos.collect());
        let info = json!({"description": dataset, "version": env!("CARGO_PKG_VERSION")});
        let opening = if self.pictures_written == 0 {
            "{\"images\": ["
        } else {
            ""
        };
        write!(
            self.pictures,
            "{opening}],\n\"info\": {info},\n\"categories\": {},\n\"videos\": {},\n\"annotations\": [\n",
            json!(categories),
            json!(videos)
        )?;
        self.annotations.flush()?;
        let objects = objects_of(&self.path);
        io::copy(&mut File::open(&objects)?, &mut self.pictures)?;
        writeln!(self.pictures, "]}}")?;
        self.pictures.flush()?;
        self.pictures.get_ref().sync_all()?;
        fs::rename(draft_of(&self.path), &self.path)?;
        fs::remove_file(objects)
    }

    fn video(&mut self, sequence: &str) -> u64 {
        let next = self.videos.len() as u64 + 1;
        *self.videos.entry(sequence.to_owned()).or_insert(next)
    }

    fn track(&mut self, video: u64, number: u16) -> u64 {
        let next = self.tracks.len() as u64 + 1;
        *self.tracks.entry((video, number)).or_insert(next)
    }
}

fn annotation(object: &Object, size: [&Value; 2], classes: &mut ClassNumbers) -> Value {
    let record = &object.record;
    let [left, top, right, bottom] = record.bounds;
    let runs = object.runs.as_ref();
    json!({
        "category_id": classes.number(&record.category),
        "bbox": [left, top, right.saturating_sub(left), bottom.saturating_sub(top)],
        "area": record.pixels,
        "segmentation": runs.map(|runs| json!({"size": size, "counts": runs.compressed()})),
        "iscrowd": 0,
        "instance": record.number,
        "range_m": record.range_m,
        "transmittance": record.transmittance,
        "contrast": record.contrast,
        "visibility": record.visibility,
        "visible": record.visible,
    })
}

/// Where the objects are gathered.
fn objects_of(path: &Path) -> PathBuf {
    draft_of(&path.with_extension("objects"))
}

fn unwritable(path: &Path) -> String {
    format!("cannot write {}", path.display())
}
