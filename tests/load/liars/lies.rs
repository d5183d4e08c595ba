//! Changes of a true frame that no check of a single message can find.

use imaging::codec::{decode_picture, encode_png};
use imaging::{Plane, Rgb8};
use serde_json::json;
use spec::FrameRecord;
use wire::messages::Artifact;

/// A rendered frame on its way to the service.
#[derive(Clone)]
pub(super) struct Delivered {
    pub(super) record: FrameRecord,
    pub(super) files: Vec<Artifact>,
}

/// A kind of lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Lie {
    Black,
    FlatRange,
    Metric,
    EmptyPlan,
    NoSceneFacts,
    MirroredPicture,
    OneCode,
}

impl Lie {
    pub(super) const ALL: [Self; 7] = [
        Self::Black,
        Self::FlatRange,
        Self::Metric,
        Self::EmptyPlan,
        Self::NoSceneFacts,
        Self::MirroredPicture,
        Self::OneCode,
    ];

    /// Applies it to a true frame.
    pub(super) fn apply(self, delivered: &mut Delivered) {
        let record = &mut delivered.record;
        match self {
            Self::Black => delivered.repaint(|_, _, _| [0; 3]),
            Self::MirroredPicture => {
                delivered.repaint(|picture, x, y| picture.pixel(picture.width() - 1 - x, y))
            }
            Self::OneCode => delivered.repaint(|picture, x, y| {
                let [red, green, blue] = picture.pixel(x, y);
                [if (x, y) == (3, 2) { red ^ 1 } else { red }, green, blue]
            }),
            Self::FlatRange => {
                let (width, height) = (16, 12);
                let flat = Plane::filled(width, height, 2000_u16);
                delivered.replace("range", encode_png(&flat.into()).expect("a file"));
            }
            Self::Metric => {
                let rgb = record.measurements.get_mut("rgb").expect("measured");
                rgb.insert("uiqm".to_owned(), 1e9);
            }
            Self::EmptyPlan => record.plan = json!([]),
            Self::NoSceneFacts => record.scene = None,
        }
    }
}

impl Delivered {
    fn repaint(&mut self, color: impl Fn(&Rgb8, usize, usize) -> [u8; 3]) {
        let rgb = self
            .files
            .iter()
            .find(|file| file.kind == "rgb")
            .expect("a picture");
        let picture = decode_picture(&rgb.data).expect("a picture").to_rgb8();
        let changed = Rgb8::from_fn(picture.width(), picture.height(), |x, y| color(&picture, x, y));
        self.replace("rgb", encode_png(&changed.into()).expect("a file"));
    }

    fn replace(&mut self, kind: &str, bytes: Vec<u8>) {
        let digest = spec::sha256(&bytes);
        let entries = self.record.artifacts.iter_mut();
        for entry in entries.filter(|entry| entry.kind == kind) {
            entry.digest.clone_from(&digest);
            entry.bytes = bytes.len() as u64;
        }
        for file in self.files.iter_mut().filter(|file| file.kind == kind) {
            file.digest.clone_from(&digest);
            file.data.clone_from(&bytes);
        }
    }
}
