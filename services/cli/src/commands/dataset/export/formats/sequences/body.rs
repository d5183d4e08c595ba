//! The sequences of a part, with the lists of each.

use std::collections::BTreeMap;

use cli::exit::Failure;

use crate::commands::dataset::export::files::target::{Target, write};
use crate::commands::dataset::export::format::Format;
use crate::commands::dataset::export::formats::sequences::layout::{
    SequencePlace, depth_codes_per_m, sequence_folder,
};
use crate::commands::dataset::export::formats::sequences::sequence::{Sequence, TextFile};
use crate::commands::dataset::export::formats::sequences::timed_frame::TimedFrame;
use crate::commands::dataset::export::formats::sequences::{euroc, kitti, tum};
use crate::commands::dataset::export::input::times::Timed;

/// The sequences of a part in the order of their first frames.
#[derive(Default)]
pub(crate) struct Sequences {
    numbers: BTreeMap<String, usize>,
    sequences: Vec<Sequence>,
}

impl Sequences {
    /// The place of the next frame of its sequence.
    pub(crate) fn assign_place(&mut self, timed: &Timed) -> SequencePlace {
        let next = self.sequences.len();
        let number = *self.numbers.entry(timed.sequence.clone()).or_insert(next);
        if number == next {
            self.sequences.push(Sequence {
                name: timed.sequence.clone(),
                placed: 0,
                frames: Vec::new(),
            });
        }
        let sequence = &mut self.sequences[number];
        sequence.placed += 1;
        SequencePlace {
            sequence: timed.sequence.clone(),
            number,
            position: sequence.placed - 1,
            stamp_ns: timed.stamp_ns,
        }
    }

    /// Adds a frame that has a place. Its camera must be that of the other frames.
    pub(crate) fn add(&mut self, place: &SequencePlace, frame: TimedFrame) -> Result<(), Failure> {
        let sequence = &mut self.sequences[place.number];
        let first = sequence.frames.first();
        if first.is_some_and(|first| !first.view.has_camera_of(&frame.view)) {
            return Err(Failure::BadInput(format!(
                "the camera of {} changes at {} ns; a sequence has one camera: choose the format mcap",
                place.sequence, place.stamp_ns
            )));
        }
        sequence.frames.push(frame);
        Ok(())
    }

    /// Writes the lists; returns the names of their files.
    pub(crate) fn finish(
        self,
        format: Format,
        target: &Target,
        part: Option<&str>,
    ) -> Result<Vec<String>, Failure> {
        let mut names = Vec::new();
        let mut far_pixels = 0;
        for (number, sequence) in self.sequences.iter().enumerate() {
            let above = sequence_folder(format, &sequence.name, number);
            let mut texts = match format {
                Format::Euroc => euroc::texts(sequence),
                Format::Kitti => kitti::texts(sequence),
                _ => tum::texts(sequence),
            };
            texts
                .iter_mut()
                .for_each(|text| text.folders = [&above[..], &text.folders].concat());
            if format == Format::Kitti {
                let name = format!("{number:02}.txt");
                texts.push(TextFile::new(&["poses"], &name, kitti::list_poses(sequence)));
            }
            for text in &texts {
                let below = text.folders.iter().map(String::as_str);
                let folders: Vec<&str> = part.into_iter().chain(below).collect();
                write(&target.folder(&folders)?.join(&text.name), text.text.as_bytes())?;
                names.push(format!("{}/{}", text.folders.join("/"), text.name));
            }
            far_pixels += sequence.frames.iter().map(|frame| frame.far_pixels).sum::<u64>();
        }
        if far_pixels > 0 {
            let most_m = f64::from(u16::MAX) / depth_codes_per_m(format);
            eprintln!(
                "warning: {far_pixels} pixels have a depth above {most_m:.1} m, which a depth picture of the format {} cannot hold; \
                 they are 0 there, as without a return",
                format.name()
            );
        }
        Ok(names)
    }
}
