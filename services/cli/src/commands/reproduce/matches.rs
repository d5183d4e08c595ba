//! Features of a frame matched with the previous one, drawn over both.

use cli::exit::Failure;
use imaging::Rgb8;
use quality::{Features, FrameFeatures, Match, Motion, match_features};

use super::shot::Shot;

/// Columns between the two frames.
const GAP_PX: usize = 8;
const CORRECT: [u8; 3] = [40, 220, 80];
const WRONG: [u8; 3] = [255, 60, 50];

/// Matches between two pictures.
pub(super) struct Matched {
    /// Both pictures with a line for each match at the default threshold.
    pub(super) picture: Rgb8,
    /// At the default threshold, then at the adaptive one.
    pub(super) counts: [Count; 2],
}

/// Numbers of matches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Count {
    pub(super) correct: usize,
    pub(super) all: usize,
}

/// Matches an artifact of a frame with that of the previous frame.
///
/// # Errors
/// A frame lacks the artifact, or the previous one its flow.
pub(super) fn match_shots(current: &Shot, previous: &Shot, kind: &str) -> Result<Matched, Failure> {
    let motion = Motion::from_displacements(&previous.flow()?);
    let pictures = [current.picture(kind)?, previous.picture(kind)?];
    let [now, before] = pictures
        .each_ref()
        .map(|picture| FrameFeatures::find(picture, None));
    let mut picture = join(&pictures);
    let default = MatchSet::new(&before.default, &now.default, &motion);
    let adaptive = MatchSet::new(&before.adaptive, &now.adaptive, &motion);
    default.draw(&mut picture);
    let counts = [default.count(), adaptive.count()];
    Ok(Matched { picture, counts })
}

/// The previous picture to the left of the current one.
fn join([current, previous]: &[Rgb8; 2]) -> Rgb8 {
    let (width, height) = (current.width(), current.height());
    Rgb8::from_fn(2 * width + GAP_PX, height, |x, y| match x {
        _ if x < width => previous.pixel(x, y),
        _ if x < width + GAP_PX => [0; 3],
        _ => current.pixel(x - width - GAP_PX, y),
    })
}

/// Matches of features, and the correct ones of them.
struct MatchSet<'a> {
    before: &'a Features,
    now: &'a Features,
    all: Vec<Match>,
    correct: Vec<Match>,
}

impl<'a> MatchSet<'a> {
    /// `motion` is that from the picture before to the picture now.
    fn new(before: &'a Features, now: &'a Features, motion: &Motion) -> Self {
        let all = match_features(before, now);
        let correct = motion.correct_matches(before, now, &all);
        Self {
            before,
            now,
            all,
            correct,
        }
    }

    fn count(&self) -> Count {
        Count {
            correct: self.correct.len(),
            all: self.all.len(),
        }
    }

    /// Draws a line for each match between two joined pictures.
    fn draw(&self, picture: &mut Rgb8) {
        let offset = ((picture.width() - GAP_PX) / 2 + GAP_PX) as f32;
        for pair in &self.all {
            let start = &self.before.keypoints[pair.current as usize];
            let end = &self.now.keypoints[pair.previous as usize];
            let color = if self.correct.contains(pair) {
                CORRECT
            } else {
                WRONG
            };
            draw_line(picture, [start.x, start.y], [end.x + offset, end.y], color);
        }
    }
}

fn draw_line(picture: &mut Rgb8, from: [f32; 2], to: [f32; 2], color: [u8; 3]) {
    let (width, height) = (picture.width(), picture.height());
    let steps = (to[0] - from[0])
        .abs()
        .max((to[1] - from[1]).abs())
        .ceil()
        .max(1.0) as usize;
    for step in 0..=steps {
        let share = step as f32 / steps as f32;
        let [x, y] = [0, 1].map(|axis| (from[axis] + share * (to[axis] - from[axis])).max(0.0) as usize);
        let first = 3 * (y.min(height - 1) * width + x.min(width - 1));
        picture.data_mut()[first..first + 3].copy_from_slice(&color);
    }
}
