//! Image quality metrics in their published profiles, and their registry.
//!
//! Most metrics need no reference picture: entropies, UICM, UISM, UIConM and UIQM (Panetta, Gao and Agaian 2016), UCIQE
//! (Yang and Sowmya 2015), light uniformity and the number of features. PSNR, SSIM and CIEDE2000 compare with a clean
//! picture; matches, tracks and the relative pose with the previous frames of a camera path; the illumination residual
//! with the true light. Published programs disagree, so UIQM and its parts come in three named [`Profile`]s; compare values within
//! a profile only.
//!
//! Every metric of every picture of at least one pixel is finite, unless it is not defined, and never -0. Sums have a fixed order: the same
//! picture yields the same bits on any machine.
//!
//! A new metric is one file with a function of [`MetricInput`](work::MetricInput), declared here, and one row in the registry.

mod blocks;
mod colors;
mod error;
mod illumination;
mod linear;
mod mask;
mod matching;
mod measure;
mod metrics;
mod needs;
mod pose;
mod profile;
mod registry;
mod sobel;
mod subject;
mod work;

pub use ciede2000::ciede2000_reference;
pub use error::QualityError;
pub use illumination::{Illumination, TrueLight};
pub use matching::features::{FEATURE_BUDGET, Features, FrameFeatures, Keypoint, Threshold};
pub use matching::motion::{CORRECT_PX, Motion};
pub use matching::nearest::{MOST_BITS, Match, match_features};
pub use matching::track::{TRACK_FRAMES, track_length};
pub use measure::{measure, measure_subject};
use metrics::{
    ciede2000, entropy, features, illumination_residual, light_uniformity, psnr, sequence, ssim, uciqe, uicm,
    uiconm, uiqm, uism,
};
pub use needs::Needs;
pub use pose::error::{PoseError, pose_error};
pub use pose::ransac::{MatchedRays, estimate_pose};
pub use pose::rays::{RayPair, RelativePose};
pub use profile::Profile;
pub use registry::{MetricId, MetricInfo};
pub use ssim::ssim_reference;
pub use subject::{CameraMotion, PreviousFrame, RayOf, Sequence, Subject};
