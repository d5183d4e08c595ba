//! Multi-channel pictures with borders and slack, so that vector loops need no special cases.

/// Slack after each row, so that a block of vectors may begin at its last sample: 4 vectors of 16 lanes.
pub(super) const SLACK: usize = 64;

/// Channels of one size, each with a border of one sample on every side.
#[derive(Debug, Default)]
pub(super) struct BorderedPlanes {
    pub(super) width: usize,
    pub(super) height: usize,
    stride: usize,
    data: Vec<f32>,
}

/// Distance between the starts of bordered rows.
pub(super) const fn stride(width: usize) -> usize {
    1 + width + 1 + SLACK
}

impl BorderedPlanes {
    /// Changes the size; the samples are undefined afterwards.
    pub(super) fn reshape(&mut self, channels: usize, width: usize, height: usize) {
        (self.width, self.height, self.stride) = (width, height, stride(width));
        self.data.resize(channels * (height + 2) * self.stride, 0.0);
    }

    /// Row `y` of a channel, beginning with its left border; row 0 is the upper border.
    #[inline(always)]
    pub(super) fn row(&self, channel: usize, y: usize) -> &[f32] {
        let start = (channel * (self.height + 2) + y) * self.stride;
        &self.data[start..start + self.stride]
    }

    #[inline(always)]
    pub(super) fn row_mut(&mut self, channel: usize, y: usize) -> &mut [f32] {
        let start = (channel * (self.height + 2) + y) * self.stride;
        &mut self.data[start..start + self.stride]
    }

    /// Fills the border from the samples inside.
    pub(super) fn close(&mut self) {
        let (width, height) = (self.width, self.height);
        for channel in self.data.chunks_exact_mut((height + 2) * self.stride) {
            for row in channel.chunks_exact_mut(self.stride) {
                close_row(row, width);
            }
            channel.copy_within(self.stride..2 * self.stride, 0);
            let last = height * self.stride;
            channel.copy_within(last..last + self.stride, last + self.stride);
        }
    }
}

/// Fills the left and right border of a row.
#[inline(always)]
pub(super) fn close_row(row: &mut [f32], width: usize) {
    row[0] = row[1];
    row[width + 1] = row[width];
}
