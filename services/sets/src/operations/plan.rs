//! Which shards a call works on.

use std::collections::BTreeSet;
use std::ops::Range;
use std::str::FromStr;

use crate::error::SetError;
use crate::set::job::Card;
use crate::set::opened::Set;

/// One of several parts of a set: every shard k with k ≡ `number` modulo `parts`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Part {
    /// Below `parts`.
    pub number: u64,
    /// At least 1.
    pub parts: u64,
}

impl FromStr for Part {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("`{text}` is not I/N with I below N, such as 0/8");
        let (number, parts) = text.split_once('/').ok_or_else(wrong)?;
        let read = |text: &str| text.parse::<u64>().map_err(|_| wrong());
        let part = Self {
            number: read(number)?,
            parts: read(parts)?,
        };
        if part.number < part.parts {
            Ok(part)
        } else {
            Err(wrong())
        }
    }
}

/// Reads `A..B`: frames from A up to and without B.
///
/// # Errors
/// The text has another form.
pub fn parse_frames(text: &str) -> Result<Range<u64>, String> {
    let wrong = || format!("`{text}` is not A..B with A below B, such as 0..5000");
    let (start, end) = text.split_once("..").ok_or_else(wrong)?;
    let read = |text: &str| text.parse::<u64>().map_err(|_| wrong());
    let frames = read(start)?..read(end)?;
    if frames.is_empty() {
        Err(wrong())
    } else {
        Ok(frames)
    }
}

fn refuse(option: &str) -> impl Fn(String) -> SetError {
    move |reason| SetError::Refused(format!("{option}: {reason}"))
}

/// A shard is written as a whole, so a range must not cut one.
fn check_alignment(frames: &Range<u64>, card: &Card) -> Result<(), SetError> {
    let size = card.frames_per_shard;
    let is_whole = |frame: u64| frame.is_multiple_of(size) || frame == card.frames;
    if is_whole(frames.start) && is_whole(frames.end) {
        return Ok(());
    }
    let (start, end) = (
        frames.start / size * size,
        frames.end.next_multiple_of(size).min(card.frames),
    );
    Err(SetError::Refused(format!(
        "--frames is {}..{}, but the shards have {size} frames each; give {start}..{end}, or render into a plain folder",
        frames.start, frames.end
    )))
}

/// The shards that a call should render.
#[derive(Debug, Clone, Default)]
pub struct Selection {
    /// Part of the set; all of it without.
    pub part: Option<Part>,
    /// Only shards of this range, which consists of whole shards.
    pub frames: Option<Range<u64>>,
}

impl Selection {
    /// Reads `I/N` and `A..B`.
    ///
    /// # Errors
    /// [`SetError::Refused`]: one of them has another form.
    pub fn parse(part: Option<&str>, frames: Option<&str>) -> Result<Self, SetError> {
        Ok(Self {
            part: part.map(str::parse).transpose().map_err(refuse("--shard"))?,
            frames: frames.map(parse_frames).transpose().map_err(refuse("--frames"))?,
        })
    }

    /// The selected shards, done or not.
    ///
    /// # Errors
    /// [`SetError::Refused`]: the frames are not in the job, or not whole shards.
    pub fn shards(&self, card: &Card) -> Result<Vec<u64>, SetError> {
        let all = match &self.frames {
            None => 0..card.shards(),
            Some(frames) if frames.end <= card.frames => {
                check_alignment(frames, card)?;
                frames.start / card.frames_per_shard..frames.end.div_ceil(card.frames_per_shard)
            }
            Some(frames) => {
                return Err(SetError::Refused(format!(
                    "frames {}..{} are not in the job, which has {}",
                    frames.start, frames.end, card.frames
                )));
            }
        };
        let part = self.part.unwrap_or(Part { number: 0, parts: 1 });
        Ok(all.filter(|shard| shard % part.parts == part.number).collect())
    }

    /// Those of the shards that are not done.
    ///
    /// # Errors
    /// [`SetError`] of the store, and as [`Selection::shards`].
    pub fn missing(&self, set: &Set) -> Result<Vec<u64>, SetError> {
        let done: BTreeSet<u64> = set.done()?.into_iter().collect();
        let shards = self.shards(set.card())?;
        Ok(shards.into_iter().filter(|shard| !done.contains(shard)).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_and_ranges_are_read_and_wrong_ones_refused() {
        assert_eq!("3/8".parse(), Ok(Part { number: 3, parts: 8 }));
        assert_eq!(parse_frames("0..5000"), Ok(0..5000));
        for text in ["", "3", "8/8", "0/0", "-1/2", "1/x"] {
            assert!(text.parse::<Part>().is_err(), "{text}");
        }
        for text in ["", "5", "5..5", "6..5", "..5", "a..b"] {
            assert!(parse_frames(text).is_err(), "{text}");
        }
    }
}
