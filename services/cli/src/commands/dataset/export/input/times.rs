//! The times of frames in their sequences.

use std::collections::HashMap;

use cli::exit::Failure;
use client::{Client, ImageRow};
use spec::Camera;

use crate::commands::dataset::export::input::frame::{Place, untrusted};
use crate::commands::dataset::export::input::sequences::{Sequences, Spot};

/// Column of the sequence of a frame, `JOB-NUMBER`.
pub(crate) const SEQUENCE: &str = "sequence";
/// Column of the time of a frame.
pub(crate) const STAMP: &str = "stamp_ns";

const NS_PER_S: u64 = 1_000_000_000;
/// Time of the first position of a path: ROS reads 0 as "no time".
const START_NS: u64 = NS_PER_S;
/// Digits of a name that is a time in nanoseconds; shorter ones are numbers of frames.
const MIN_NS_DIGITS: usize = 16;

/// A frame of a sequence with its time.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Timed {
    pub(crate) sequence: String,
    pub(crate) stamp_ns: u64,
}

impl Timed {
    /// Sequence and time from the columns of a row.
    pub(crate) fn read(row: &ImageRow) -> Result<Self, Failure> {
        match (row.text(SEQUENCE), row.count(STAMP)) {
            (Some(sequence), Some(stamp_ns)) => Ok(Self {
                sequence: sequence.to_owned(),
                stamp_ns,
            }),
            _ => Err(untrusted("an image without a sequence".to_owned())),
        }
    }
}

/// Assigns times; each collection is requested once.
pub(crate) struct Times<'a> {
    client: &'a Client,
    sequences: Sequences<'a>,
    /// Times of the scenes of each collection; `None` if its names are no times.
    collections: HashMap<String, Option<HashMap<String, u64>>>,
    /// The latest time of each sequence.
    latest_ns: HashMap<String, u64>,
}

impl<'a> Times<'a> {
    pub(crate) fn new(client: &'a Client, dataset: &'a str) -> Self {
        Self {
            client,
            sequences: Sequences::new(client, dataset),
            collections: HashMap::new(),
            latest_ns: HashMap::new(),
        }
    }

    /// Sequence and time of a frame, called in the order of frames.
    pub(crate) fn assign_time(&mut self, row: &ImageRow, place: &Place) -> Result<Timed, Failure> {
        let Some(Spot { sequence, index }) = self.sequences.spot(row, place)? else {
            return Err(untrusted(format!(
                "the image {}/{} without a camera path or a scene with a pose",
                place.job, place.frame
            )));
        };
        let stamp_ns = match self.find_recorded(row)? {
            Some(stamp_ns) => stamp_ns,
            None => compute_stamp(row, index)?,
        };
        let latest = self.latest_ns.insert(sequence.clone(), stamp_ns);
        if let Some(latest) = latest.filter(|latest| *latest >= stamp_ns) {
            return Err(Failure::BadInput(format!(
                "the frame {}/{} of {sequence} has the time {stamp_ns} ns, the frame before it {latest} ns; times must grow: give \
                 the scenes of the collection names that are increasing times",
                place.job, place.frame
            )));
        }
        Ok(Timed { sequence, stamp_ns })
    }

    /// The time in the name of an uploaded scene, if all names of its collection are times.
    fn find_recorded(&mut self, row: &ImageRow) -> Result<Option<u64>, Failure> {
        let (Some(id), Some(name)) = (row.text("scene.id"), row.text("scene.name")) else {
            return Ok(None);
        };
        if !self.collections.contains_key(name) {
            let scenes = self.client.collection(name)?.unwrap_or_default();
            let times = scenes
                .into_iter()
                .map(|scene| Some((scene.id, parse_time(&scene.name)?)));
            self.collections.insert(name.to_owned(), times.collect());
        }
        let times = self.collections.get(name).and_then(Option::as_ref);
        Ok(times.and_then(|times| times.get(id).copied()))
    }
}

/// The time of a position by the rate of its camera.
fn compute_stamp(row: &ImageRow, index: u64) -> Result<u64, Failure> {
    let usual = || Camera::pinhole(1, 1, 1.0).frames_per_s;
    let frames_per_s = row.number("camera.frames_per_s").unwrap_or_else(usual);
    let since_ns = index as f64 / frames_per_s * NS_PER_S as f64;
    match frames_per_s > 0.0 && since_ns < u64::MAX as f64 / 2.0 {
        true => Ok(START_NS + since_ns.round() as u64),
        false => Err(untrusted(format!("a camera of {frames_per_s} frames per second"))),
    }
}

/// The time in the last part of a name: nanoseconds as in EuRoC, or seconds with decimals as in the TUM benchmark.
fn parse_time(name: &str) -> Option<u64> {
    let last = name.rsplit('/').next()?;
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    match last.split_once('.') {
        None if is_number(last) && last.len() >= MIN_NS_DIGITS => last.parse().ok(),
        Some((seconds, decimals)) if is_number(seconds) && is_number(decimals) && decimals.len() <= 9 => {
            let seconds: u64 = seconds.parse().ok()?;
            let fraction: u64 = format!("{decimals:0<9}").parse().ok()?;
            seconds.checked_mul(NS_PER_S)?.checked_add(fraction)
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn names_of_recordings_are_times_and_numbers_are_not() {
        for (name, time) in [
            ("1403636579763555584", Some(1_403_636_579_763_555_584)),
            ("rgb/1305031102.175304", Some(1_305_031_102_175_304_000)),
            ("0.5", Some(500_000_000)),
            ("000012", None),
            ("frame-0001", None),
            ("1.0000000001", None),
            ("99999999999999999999", None),
            (".5", None),
            ("", None),
        ] {
            assert_eq!(parse_time(name), time, "{name}");
        }
    }

    #[test]
    fn positions_of_a_path_have_the_rate_of_the_camera() {
        let stamp = |rate: serde_json::Value, index| {
            let row = serde_json::from_value(json!({"camera.frames_per_s": rate})).unwrap();
            compute_stamp(&row, index).ok()
        };
        assert_eq!(stamp(json!(25.0), 0), Some(1_000_000_000));
        assert_eq!(stamp(json!(3.0), 1), Some(1_333_333_333));
        assert_eq!(stamp(json!(null), 2), Some(1_080_000_000));
        assert_eq!(stamp(json!(0.0), 1), None);
    }
}
