//! Lists of a sequence as in the TUM RGB-D benchmark. The center of the first pixel is (0, 0), as in the record.

use std::fmt::Write;

use crate::commands::dataset::export::format::Format;
use crate::commands::dataset::export::formats::quaternion::quaternion;
use crate::commands::dataset::export::formats::sequences::layout::{depth_codes_per_m, format_seconds};
use crate::commands::dataset::export::formats::sequences::orb_slam::{SETTINGS, settings};
use crate::commands::dataset::export::formats::sequences::sequence::{Sequence, TextFile};

/// The lists of a sequence: one for each folder of files, associations of pictures and depth, poses, and a camera.
pub(super) fn texts(sequence: &Sequence) -> Vec<TextFile> {
    let mut texts: Vec<TextFile> = Vec::new();
    let kinds = sequence.frames.first().map_or(&[][..], |frame| &frame.files);
    for index in 0..kinds.len() {
        let folder = kinds[index].1.split('/').next().unwrap_or_default();
        let text = sequence.list(&format!("# timestamp {folder}"), |frame| {
            format!("{} {}", format_seconds(frame.stamp_ns), frame.files[index].1)
        });
        texts.push(TextFile::new(&[], &format!("{folder}.txt"), text));
    }
    texts.push(TextFile::new(&[], "associations.txt", associations(sequence)));
    let poses = sequence.list("# timestamp tx ty tz qx qy qz qw", |frame| {
        let [w, x, y, z] = quaternion(frame.view.rotation());
        let [tx, ty, tz] = frame.view.position();
        format!(
            "{} {tx} {ty} {tz} {x} {y} {z} {w}",
            format_seconds(frame.stamp_ns)
        )
    });
    texts.push(TextFile::new(&[], "groundtruth.txt", poses));
    if let Some(first) = sequence.frames.first() {
        let text = settings(&first.view, sequence.rate_hz(), depth_codes_per_m(Format::Tum));
        texts.push(TextFile::new(&[], SETTINGS, text));
    }
    texts
}

/// A line for each picture with the depth of the same time, without a comment: ORB-SLAM reads every line.
fn associations(sequence: &Sequence) -> String {
    let mut text = String::new();
    for frame in &sequence.frames {
        let stamp = format_seconds(frame.stamp_ns);
        let depth = frame.files.iter().find(|(kind, _)| kind == "range");
        if let (Some((_, rgb)), Some((_, depth))) = (frame.files.first(), depth) {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{stamp} {rgb} {stamp} {depth}");
        }
    }
    text
}
