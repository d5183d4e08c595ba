//! Pictures of a slot's last frames, so that the frames after them need not render them again.

use std::collections::VecDeque;
use std::sync::Arc;

use spec::Frame;

use super::held::Held;

/// Maximum number of pictures.
const MOST_PICTURES: usize = 8;
/// Maximum pixels of all pictures but the newest one: 28 MB.
const MOST_PIXELS: usize = 1 << 22;

/// The last pictures, the newest last.
#[derive(Default)]
pub(crate) struct History {
    pictures: VecDeque<(Frame, Arc<Held>)>,
    is_used: bool,
}

impl History {
    /// Whether a picture was ever requested.
    pub(crate) fn is_used(&self) -> bool {
        self.is_used
    }

    /// The picture of this frame.
    pub(crate) fn find(&mut self, frame: &Frame) -> Option<Arc<Held>> {
        self.is_used = true;
        let mut pictures = self.pictures.iter().rev();
        pictures
            .find(|(own, _)| own == frame)
            .map(|(_, held)| Arc::clone(held))
    }

    /// Adds the picture of a frame and drops the oldest ones beyond the limits.
    pub(crate) fn insert(&mut self, frame: Frame, held: Arc<Held>) {
        self.pictures.retain(|(own, _)| *own != frame);
        while self.pictures.len() >= MOST_PICTURES || self.count_pixels() > MOST_PIXELS {
            self.pictures.pop_front();
        }
        self.pictures.push_back((frame, held));
    }

    fn count_pixels(&self) -> usize {
        let pixels = self.pictures.iter().map(|(_, held)| held.rgb.data().len() / 3);
        pixels.sum()
    }
}
