//! Planes that are used again. Fresh memory costs a page fault for each 4 KiB: more than the water computes in that time.

/// Unused planes that are kept: the twelve of a frame's layers and those that one channel works with.
const MOST_KEPT: usize = 20;

/// Unused planes of one length.
#[derive(Default)]
pub(crate) struct Buffers {
    unused: Vec<Vec<f32>>,
}

impl Buffers {
    /// A plane of this length with any content.
    pub(crate) fn take(&mut self, length: usize) -> Vec<f32> {
        self.unused.retain(|buffer| buffer.len() == length);
        self.unused.pop().unwrap_or_else(|| vec![0.0; length])
    }

    /// Keeps planes for later.
    pub(crate) fn give(&mut self, planes: impl IntoIterator<Item = Vec<f32>>) {
        let room = MOST_KEPT - self.unused.len();
        self.unused.extend(planes.into_iter().take(room));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_come_back_and_never_more_than_the_limit() {
        let mut buffers = Buffers::default();
        buffers.give([vec![7.0; 3]]);
        assert_eq!(buffers.take(3), [7.0; 3]);
        buffers.give(std::iter::repeat_n(vec![1.0; 4], 2 * MOST_KEPT));
        assert_eq!(buffers.unused.len(), MOST_KEPT);
        assert_eq!(buffers.take(5).len(), 5);
        assert!(
            buffers.unused.is_empty(),
            "planes of another frame size are let go"
        );
    }
}
