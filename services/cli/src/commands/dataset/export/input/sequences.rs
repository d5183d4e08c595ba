//! Sequences: frames of a job along one camera path.

use std::collections::HashMap;

use cli::exit::Failure;
use client::{Client, ImageQuery, ImageRow};

use crate::commands::dataset::export::input::frame::{Place, untrusted};
use crate::commands::dataset::export::input::posed::PosedScenes;

/// A frame's place in a sequence.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Spot {
    /// `JOB-NUMBER`, which may be the name of a folder.
    pub(crate) sequence: String,
    /// Position on the camera path, or among the scenes of the sequence, from 0.
    pub(crate) index: u64,
}

/// The sequences of a dataset; the grid of each job is requested once.
pub(crate) struct Sequences<'a> {
    client: &'a Client,
    dataset: &'a str,
    /// Cells of the grid of each job.
    cells: HashMap<String, u64>,
    posed: PosedScenes<'a>,
    uploads: Uploads,
}

/// The sequences of uploaded scenes with poses.
#[derive(Default)]
struct Uploads {
    /// Frames so far of each scene in each job.
    visits: HashMap<(String, String), u64>,
    /// Frames so far of each sequence.
    lengths: HashMap<String, u64>,
}

impl Uploads {
    /// The next place: the n-th frame of a scene in a job belongs to its n-th sequence.
    fn next(&mut self, job: &str, scene: &str) -> Spot {
        let visits = self.visits.entry((job.to_owned(), scene.to_owned())).or_default();
        let sequence = format!("{job}-{visits}");
        *visits += 1;
        let length = self.lengths.entry(sequence.clone()).or_default();
        *length += 1;
        Spot {
            sequence,
            index: *length - 1,
        }
    }
}

impl<'a> Sequences<'a> {
    pub(crate) fn new(client: &'a Client, dataset: &'a str) -> Self {
        Self {
            client,
            dataset,
            cells: HashMap::new(),
            posed: PosedScenes::new(client),
            uploads: Uploads::default(),
        }
    }

    /// The place of a frame, called in the order of frames; `None` without a camera path and without a posed scene.
    pub(crate) fn spot(&mut self, row: &ImageRow, place: &Place) -> Result<Option<Spot>, Failure> {
        let Some(frames) = row.count("camera.path.frames") else {
            return self.uploaded(row, place);
        };
        if frames == 0 {
            return Err(untrusted("a camera path of no frames".to_owned()));
        }
        let index = row.count("camera.path.frame").unwrap_or(0);
        let cells = match self.cells.get(&place.job) {
            Some(cells) => *cells,
            None => {
                let cells = self.cells_of(&place.job)?;
                self.cells.insert(place.job.clone(), cells);
                cells
            }
        };
        let number = number(place.frame, frames, cells);
        Ok(Some(Spot {
            sequence: format!("{}-{number}", place.job),
            index,
        }))
    }

    fn uploaded(&mut self, row: &ImageRow, place: &Place) -> Result<Option<Spot>, Failure> {
        let Some(id) = row.text("scene.id") else {
            return Ok(None);
        };
        let posed = self.posed.contains(id)?;
        Ok(posed.then(|| self.uploads.next(&place.job, id)))
    }

    /// The number of cells of a job's grid. Each cell runs through the whole path and the cells alternate, so the index of the first frame
    /// at the second position of the path is the number of cells.
    fn cells_of(&self, job: &str) -> Result<u64, Failure> {
        let filter = format!("job = \"{job}\" and camera.path.frame = 1");
        let rows = self.client.images(ImageQuery {
            dataset: Some(self.dataset),
            filter: &filter,
            order_by: Some("frame"),
            fields: &["frame".to_owned()],
            limit: 1,
        })?;
        let frame = rows.first().and_then(|row| row.count("frame"));
        Ok(frame.unwrap_or(1).max(1))
    }
}

/// Number of the sequence of a frame: cell by cell, and then the next pass of all cells.
fn number(frame: u64, frames: u64, cells: u64) -> u64 {
    let pass = frame / cells / frames;
    pass * cells + frame % cells
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_round_of_uploaded_scenes_is_a_sequence() {
        let mut uploads = Uploads::default();
        let spots: Vec<Spot> = ["a", "b", "c", "a", "b", "c"]
            .iter()
            .map(|scene| uploads.next("job", scene))
            .collect();
        let places: Vec<(&str, u64)> = spots
            .iter()
            .map(|spot| (spot.sequence.as_str(), spot.index))
            .collect();
        let rounds = ["job-0", "job-0", "job-0", "job-1", "job-1", "job-1"];
        assert_eq!(
            places,
            rounds.into_iter().zip([0, 1, 2, 0, 1, 2]).collect::<Vec<_>>()
        );
        assert_eq!(uploads.next("other", "a").sequence, "other-0");
    }

    #[test]
    fn cells_take_turns_and_passes_follow_each_other() {
        // Three places, two cells: cells alternate, and after six frames both begin again.
        let numbers: Vec<u64> = (0..12).map(|frame| number(frame, 3, 2)).collect();
        assert_eq!(numbers, [0, 1, 0, 1, 0, 1, 2, 3, 2, 3, 2, 3]);
        assert_eq!(number(7, 1, 1), 7);
    }
}
