//! Pool of planes. Fresh memory costs a page fault for each 4 KiB: more than the computation of the water in that time.

/// Memory that unused planes may take: twenty of 1920×1080, the twelve of a frame's layers and those that one channel works
/// with. Of larger frames fewer are kept.
pub(super) const MOST_KEPT_BYTES: usize = 160 << 20;
/// The most that a frame uses at a time.
const MOST_KEPT: usize = 36;

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
        for plane in planes {
            let kept: usize = self
                .unused
                .iter()
                .map(|unused| size_of_val(unused.as_slice()))
                .sum();
            if self.unused.len() < MOST_KEPT && kept + size_of_val(plane.as_slice()) <= MOST_KEPT_BYTES {
                self.unused.push(plane);
            }
        }
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
