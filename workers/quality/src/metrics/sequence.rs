//! Metrics of a frame and the previous ones: matches, tracks and the relative pose. They are not defined for the first
//! frame of a path.

use crate::matching::features::{Features, FrameFeatures, Threshold};
use crate::matching::nearest::{Match, match_features};
use crate::matching::track::{TRACK_FRAMES, track_length};
use crate::pose::error::{PoseError, pose_error};
use crate::pose::ransac::{MatchedRays, estimate_pose};
use crate::pose::rays::RayPair;
use crate::subject::{CameraMotion, PreviousFrame, Sequence};
use crate::work::{MetricInput, SharedPart};

/// Cross-checked matches with the previous frame.
pub(crate) fn matches(work: &MetricInput) -> Option<f64> {
    let found = work.part::<NewestPair>();
    Some(found.adaptive.as_ref()?.all.len() as f64)
}

/// The same at the default threshold.
pub(crate) fn matches_default(work: &MetricInput) -> Option<f64> {
    let found = work.part::<NewestPair>();
    Some(found.default.as_ref()?.all.len() as f64)
}

/// Matches within 3 px of the true position.
pub(crate) fn matches_correct(work: &MetricInput) -> Option<f64> {
    let found = work.part::<NewestPair>();
    Some(found.adaptive.as_ref()?.correct.len() as f64)
}

/// The same at the default threshold.
pub(crate) fn matches_correct_default(work: &MetricInput) -> Option<f64> {
    let found = work.part::<NewestPair>();
    Some(found.default.as_ref()?.correct.len() as f64)
}

/// Share of correct matches; 0 without matches.
pub(crate) fn matches_precision(work: &MetricInput) -> Option<f64> {
    let found = work.part::<NewestPair>();
    let FramePair { all, correct } = found.adaptive.as_ref()?;
    Some(correct.len() as f64 / all.len().max(1) as f64)
}

/// Mean length of the tracks that end in the features of this frame, see [`track_length`].
pub(crate) fn mean_track_length(work: &MetricInput) -> Option<f64> {
    let sequence = work.subject().sequence?;
    let newest = work.part::<NewestPair>();
    let mut pairs = vec![newest.adaptive.as_ref()?.correct.clone()];
    let frames = &sequence.previous[..sequence.previous.len().min(TRACK_FRAMES)];
    for neighbors in frames.windows(2) {
        let pair = match_frames(neighbors[0].features, &neighbors[1], Threshold::Adaptive);
        pairs.push(pair.correct);
    }
    Some(track_length(sequence.features.adaptive.count(), &pairs))
}

/// Angle of the relative pose's error, degrees.
pub(crate) fn pose_error_deg(work: &MetricInput) -> Option<f64> {
    Some(work.part::<EstimatedPose>().0.as_ref()?.deg)
}

/// Distance of the relative pose's error at the true length, meters.
pub(crate) fn pose_error_m(work: &MetricInput) -> Option<f64> {
    Some(work.part::<EstimatedPose>().0.as_ref()?.m)
}

/// Matches of two neighboring frames.
struct FramePair {
    all: Vec<Match>,
    correct: Vec<Match>,
}

fn match_frames(current: &FrameFeatures, previous: &PreviousFrame, threshold: Threshold) -> FramePair {
    let (current, before) = (
        current.with_threshold(threshold),
        previous.features.with_threshold(threshold),
    );
    let all = match_features(current, before);
    let correct = previous.motion.correct_matches(current, before, &all);
    FramePair { all, correct }
}

/// Matches of the picture with the previous frame, if it has one.
struct NewestPair {
    adaptive: Option<FramePair>,
    default: Option<FramePair>,
}

impl SharedPart for NewestPair {
    fn new(work: &MetricInput) -> Self {
        let sequence = work.subject().sequence;
        let [adaptive, default] = [Threshold::Adaptive, Threshold::Default].map(|threshold| {
            let (sequence, newest) =
                sequence.and_then(|sequence| Some((sequence, sequence.previous.first()?)))?;
            Some(match_frames(sequence.features, newest, threshold))
        });
        Self { adaptive, default }
    }
}

/// The error of the pose from all matches at the adaptive threshold.
struct EstimatedPose(Option<PoseError>);

impl SharedPart for EstimatedPose {
    fn new(work: &MetricInput) -> Self {
        Self(
            work.subject()
                .sequence
                .and_then(|sequence| measure_pose(work, sequence)),
        )
    }
}

fn measure_pose(work: &MetricInput, sequence: &Sequence) -> Option<PoseError> {
    let (camera, newest) = (sequence.camera?, sequence.previous.first()?);
    let found = work.part::<NewestPair>();
    let matches = &found.adaptive.as_ref()?.all;
    let pairs = find_rays(
        &camera,
        &sequence.features.adaptive,
        &newest.features.adaptive,
        matches,
    );
    let estimate = estimate_pose(&MatchedRays {
        pairs: &pairs,
        pixel_rad: camera.pixel_rad,
        seed: camera.seed,
    });
    Some(pose_error(estimate.as_ref(), &camera.pose))
}

fn find_rays(
    camera: &CameraMotion,
    current: &Features,
    previous: &Features,
    matches: &[Match],
) -> Vec<RayPair> {
    let pairs = matches.iter().map(|pair| {
        let seen = &current.keypoints[pair.current as usize];
        let before = &previous.keypoints[pair.previous as usize];
        RayPair {
            previous: (camera.previous)(f64::from(before.x), f64::from(before.y)).normalized(),
            current: (camera.current)(f64::from(seen.x), f64::from(seen.y)).normalized(),
        }
    });
    pairs.collect()
}
