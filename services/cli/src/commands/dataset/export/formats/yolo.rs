//! Boxes for YOLO: for each picture below `images/` a text file below `labels/` with one line for each object, and a list of the
//! pictures; next to the parts a `data.yaml` with classes and lists.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use cli::exit::Failure;
use serde_json::{Value, json};

use crate::commands::dataset::export::files::lists::Lists;
use crate::commands::dataset::export::files::target::{Target, read, write};
use crate::commands::dataset::export::formats::class_numbers::ClassNumbers;
use crate::commands::dataset::export::formats::objects::Object;
use crate::commands::dataset::export::input::frame::{Frame, Home, untrusted};

/// The folder that a loader replaces in the path of a picture to find its labels.
pub(crate) const IMAGES: &str = "images";
const LABELS: &str = "labels";
const LIST: &str = "images.txt";

/// The labels of a part.
pub(crate) struct Yolo {
    folder: PathBuf,
    /// The pictures, one a line.
    pictures: String,
}

impl Yolo {
    pub(crate) fn new(folder: &Path) -> Self {
        Self {
            folder: folder.to_owned(),
            pictures: String::new(),
        }
    }

    /// Writes the labels of a frame.
    pub(crate) fn add(
        &mut self,
        labeled: &Labeled<'_>,
        classes: &mut ClassNumbers,
        lists: &mut Lists,
    ) -> Result<(), Failure> {
        let Labeled {
            frame, part, home, ..
        } = labeled;
        let text = lines(labeled, classes)?;
        let folders = home
            .folders
            .iter()
            .map(|name| if name == IMAGES { LABELS } else { name });
        let below: Vec<&str> = folders.collect();
        let picture = frame.files.first().map_or("", |file| file.name.as_str());
        let stem = picture.rsplit('/').next().unwrap_or_default().rsplit_once('.');
        let name = format!("{}.txt", stem.map_or("", |(stem, _)| stem));
        let names: Vec<&str> = part.iter().copied().chain(below.iter().copied()).collect();
        let path = labeled.target.folder(&names)?.join(&name);
        if read(&path)?.as_deref() != Some(text.as_bytes()) {
            write(&path, text.as_bytes())?;
        }
        lists.add_sum(
            &spec::sha256(text.as_bytes()),
            &format!("{}/{name}", below.join("/")),
        )?;
        // Writing to a string cannot fail.
        let _ = writeln!(self.pictures, "./{picture}");
        Ok(())
    }

    /// Writes the list of pictures; returns its name.
    pub(crate) fn finish(self) -> Result<String, Failure> {
        write(&self.folder.join(LIST), self.pictures.as_bytes())?;
        Ok(LIST.to_owned())
    }
}

/// A frame with its objects.
pub(crate) struct Labeled<'a> {
    pub(crate) target: &'a Target,
    pub(crate) part: Option<&'a str>,
    pub(crate) home: &'a Home,
    pub(crate) frame: &'a Frame,
    pub(crate) objects: &'a [Object],
}

/// A line for each object: its class, the middle of its box, its width and height, as shares of the picture.
fn lines(labeled: &Labeled<'_>, classes: &mut ClassNumbers) -> Result<String, Failure> {
    let metadata = &labeled.frame.metadata;
    let side = |name: &str| metadata[name].as_f64().filter(|side| *side >= 1.0);
    let (Some(width), Some(height)) = (side("camera.width"), side("camera.height")) else {
        return Err(untrusted("an image without its size".to_owned()));
    };
    let mut text = String::new();
    for object in labeled.objects {
        let [left, top, right, bottom] = object.record.bounds.map(|edge| edge as f64);
        let class = classes.place(&object.record.category);
        let [x, y] = [Extent::new(left, right, width), Extent::new(top, bottom, height)];
        // Writing to a string cannot fail. The shortest decimals that parse to the same numbers keep the edges inside.
        let _ = writeln!(
            text,
            "{class} {} {} {} {}",
            x.middle, y.middle, x.length, y.length
        );
    }
    Ok(text)
}

/// Middle and length of an interval as shares of a side.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Extent {
    middle: f64,
    length: f64,
}

impl Extent {
    /// The interval, clipped to the side. Both edges, computed in single or double precision, are within 0 and 1.
    fn new(low: f64, high: f64, side: f64) -> Self {
        let (low, high) = (low.clamp(0.0, side), high.clamp(0.0, side));
        let middle = (low + high) / 2.0 / side;
        let mut length = (high - low) / side;
        while !(Self { middle, length }).is_inside() && length > 0.0 {
            length -= f64::from(f32::EPSILON) / 4.0;
        }
        Self {
            middle,
            length: length.max(0.0),
        }
    }

    fn is_inside(self) -> bool {
        let (middle, half) = (self.middle as f32, self.length as f32 / 2.0);
        let edges = [self.middle - self.length / 2.0, self.middle + self.length / 2.0];
        let single = [middle - half, middle + half];
        edges.iter().all(|edge| (0.0..=1.0).contains(edge))
            && single.iter().all(|edge| (0.0..=1.0).contains(edge))
    }
}

/// `data.yaml`: each line is a value of JSON, which YAML reads too.
pub(crate) fn data_yaml(parts: &[Option<String>], classes: &ClassNumbers) -> String {
    let mut text = "# The folder of this file is the root: YOLO reads the lists next to it.\n".to_owned();
    let lists: Vec<(&str, String)> = match parts {
        [None] => vec![("train", LIST.to_owned()), ("val", LIST.to_owned())],
        parts => {
            let named = parts.iter().flatten();
            named
                .map(|name| (name.as_str(), format!("{name}/{LIST}")))
                .collect()
        }
    };
    for (part, list) in lists {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{part}: {}", Value::from(list));
    }
    text.push_str("names:\n");
    for (place, (name, _)) in classes.all().iter().enumerate() {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  {place}: {}", json!(name));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_are_within_the_picture_for_every_box_and_side() {
        for side in [1.0, 3.0, 7.0, 120.0, 160.0, 641.0, 1023.0] {
            let edges = |edge: u32| f64::from(edge);
            for low in 0..side as u32 {
                for high in [low + 1, side as u32] {
                    let extent = Extent::new(edges(low), edges(high), side);
                    let text = (extent.middle.to_string(), extent.length.to_string());
                    let parsed = Extent {
                        middle: text.0.parse().unwrap(),
                        length: text.1.parse().unwrap(),
                    };
                    assert!(parsed.is_inside(), "{side} {low} {high} {extent:?}");
                    assert!((parsed.length * side - edges(high - low)).abs() < 1e-4);
                }
            }
        }
        assert_eq!(
            Extent::new(-3.0, 9.0, 6.0),
            Extent {
                middle: 0.5,
                length: 1.0
            }
        );
    }

    #[test]
    fn every_part_has_its_list_and_every_class_its_place() {
        let mut classes = ClassNumbers::default();
        classes.add(&[(2, "pile".to_owned()), (9, "a: \"b\"".to_owned())].into());
        let parts = [Some("train".to_owned()), Some("val".to_owned())];
        let text = data_yaml(&parts, &classes);
        assert!(
            text.contains("train: \"train/images.txt\"\nval: \"val/images.txt\"\n"),
            "{text}"
        );
        assert!(
            text.ends_with("names:\n  0: \"pile\"\n  1: \"a: \\\"b\\\"\"\n"),
            "{text}"
        );
        assert!(data_yaml(&[None], &classes).contains("train: \"images.txt\"\nval: \"images.txt\"\n"));
    }
}
