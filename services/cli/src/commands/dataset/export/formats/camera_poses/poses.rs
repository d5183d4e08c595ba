//! Frames with poses, sequence by sequence, with the poses of each in one model.

use std::collections::BTreeMap;

use cli::exit::Failure;

use crate::commands::dataset::export::files::target::{Target, write};
use crate::commands::dataset::export::format::Format;
use crate::commands::dataset::export::formats::colmap::{Shot, model};
use crate::commands::dataset::export::formats::transforms::{TRANSFORMS, transforms};
use crate::commands::dataset::export::formats::view::View;
use crate::commands::dataset::export::input::frame::{Frame, Home, Place};
use crate::commands::dataset::export::input::sequences::Spot;

/// The folder of a sequence's pictures.
const IMAGES: &str = "images";
/// The folder of a model for COLMAP's tools.
const MODEL: [&str; 2] = ["sparse", "0"];

/// The sequences of a part.
#[derive(Default)]
pub(crate) struct Poses {
    sequences: BTreeMap<String, Vec<Shot>>,
}

impl Poses {
    /// Where the files of a frame go: side by side, since readers of such folders expect it.
    pub(crate) fn home(place: &Place, spot: &Spot) -> Home {
        Home {
            folders: vec![spot.sequence.clone(), IMAGES.to_owned()],
            prefix: spec::shard_member(place.frame, ""),
        }
    }

    pub(crate) fn add(&mut self, frame: &Frame, spot: &Spot, view: View) {
        let picture = frame.files.first().map_or("", |file| file.name.as_str());
        let shot = Shot {
            name: picture.rsplit('/').next().unwrap_or_default().to_owned(),
            view,
        };
        self.sequences
            .entry(spot.sequence.clone())
            .or_default()
            .push(shot);
    }

    /// Writes the models; returns the names of their files.
    pub(crate) fn finish(
        self,
        format: Format,
        target: &Target,
        part: Option<&str>,
    ) -> Result<Vec<String>, Failure> {
        let mut names = Vec::new();
        for (sequence, shots) in self.sequences {
            let below: &[&str] = if format == Format::Colmap { &MODEL } else { &[] };
            let above = part.into_iter().chain([sequence.as_str()]);
            let folders: Vec<&str> = above.chain(below.iter().copied()).collect();
            let folder = target.folder(&folders)?;
            let files = match format {
                Format::Colmap => Vec::from(model(&shots)),
                _ => vec![(TRANSFORMS, transforms(&shots, IMAGES))],
            };
            let inside = [&[sequence.as_str()], below].concat().join("/");
            for (name, text) in files {
                write(&folder.join(name), text.as_bytes())?;
                names.push(format!("{inside}/{name}"));
            }
        }
        Ok(names)
    }
}
