//! The right camera of a stereo pair.

use spec::{Exposure, Frame, WhiteBalance};

/// Settings of the left camera that both cameras share.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Developing {
    /// The factor of the exposure; `None` for a pinhole.
    pub(crate) gain: Option<f64>,
    /// The gains of the white balance; `None` without one.
    pub(crate) balance: Option<[f64; 3]>,
}

/// The frame of the right camera; `None` without a stereo pair. The cameras differ in position and noise only: a metered exposure
/// and an automatic white balance are those of the left picture.
pub(crate) fn right_frame(frame: &Frame, left: &Developing) -> Option<Frame> {
    let baseline_m = frame.camera.stereo?.baseline_m;
    let described = ::camera::preset::complete(&frame.camera);
    let mut right = frame.clone();
    right.right_m = baseline_m;
    right.artifacts.clear();
    if let (Some(Exposure::Auto(_)), Some(gain)) = (described.exposure, left.gain) {
        right.camera.exposure = Some(Exposure::Fixed(gain));
    }
    if let (Some(WhiteBalance::GrayWorld), Some(gains)) = (described.white_balance, left.balance) {
        right.camera.white_balance = Some(WhiteBalance::Fixed(gains));
    }
    Some(right)
}
