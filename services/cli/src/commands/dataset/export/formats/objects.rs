//! The objects of a frame, from its file of boxes, with the runs of each in the instance mask.

use std::collections::BTreeMap;
use std::path::Path;

use cli::exit::Failure;
use imaging::codec::{FilePlane, decode_plane};
use spec::{InstanceRecord, SceneRecord};

use crate::commands::dataset::export::files::target::read_written;
use crate::commands::dataset::export::formats::rle::{Runs, runs_of};
use crate::commands::dataset::export::input::frame::{Frame, untrusted};

/// An object with its mask.
pub(crate) struct Object {
    pub(crate) record: InstanceRecord,
    /// Absent in formats without masks.
    pub(crate) runs: Option<Runs>,
}

/// The objects of a frame whose files are in a folder; with `masks`, the runs of each.
pub(crate) fn objects(folder: &Path, frame: &Frame, masks: bool) -> Result<Vec<Object>, Failure> {
    let name = frame.file("boxes");
    let boxes = read_written(&folder.join(name))?;
    let scene: SceneRecord = serde_json::from_slice(&boxes)
        .map_err(|error| untrusted(format!("{name}, which is not a file of boxes: {error}")))?;
    let mut runs = match masks {
        true => runs_of_file(folder, frame.file("instances"))?,
        false => BTreeMap::new(),
    };
    scene
        .instances
        .unwrap_or_default()
        .into_iter()
        .map(|record: InstanceRecord| {
            let runs = runs.remove(&record.number);
            if masks && runs.as_ref().is_none_or(|runs| runs.area != record.pixels) {
                let number = record.number;
                return Err(untrusted(format!(
                    "{name}, whose object {number} has another size than in the mask"
                )));
            }
            Ok(Object { record, runs })
        })
        .collect()
}

fn runs_of_file(folder: &Path, name: &str) -> Result<BTreeMap<u16, Runs>, Failure> {
    let file = read_written(&folder.join(name))?;
    match decode_plane(&file) {
        Ok(FilePlane::Codes(mask)) => Ok(runs_of(&mask)),
        Ok(_) => Err(untrusted(format!(
            "{name}, which has floats instead of numbers of objects"
        ))),
        Err(error) => Err(untrusted(format!("{name}, which is not a mask: {error}"))),
    }
}
