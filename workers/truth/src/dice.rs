//! Random numbers of a path: each has an address of its own.

use imaging::random::Stream;

/// Pixels that have addresses.
pub const MOST_PIXELS: u64 = 1 << 28;
/// Paths of a pixel that have addresses.
pub const MOST_PATHS: u64 = 1 << 20;
/// Numbers of a path that have addresses.
const MOST_NUMBERS: u64 = 1 << 12;

/// The stream of the truth of a seed.
#[must_use]
pub fn stream(seed: u64) -> Stream {
    Stream::stage(seed, "truth")
}

/// Which path of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Address {
    /// The frame.
    pub frame: u64,
    /// Number of the pixel, below [`MOST_PIXELS`].
    pub pixel: u64,
    /// Number of the path, below [`MOST_PATHS`].
    pub sample: u64,
    /// Channel, 0..=2; 3 for a path of all channels.
    pub channel: u64,
}

/// The numbers of one path, in the order in which it draws them.
pub(crate) struct Dice {
    stream: Stream,
    frame: u64,
    first: u64,
    drawn: u64,
}

impl Dice {
    pub(crate) fn new(stream: Stream, address: Address) -> Self {
        debug_assert!(address.pixel < MOST_PIXELS && address.sample < MOST_PATHS);
        let path = (address.pixel * MOST_PATHS + address.sample) * 4 + address.channel;
        Self {
            stream,
            frame: address.frame,
            first: path * MOST_NUMBERS,
            drawn: 0,
        }
    }

    /// The next number in [0, 1).
    pub(crate) fn next(&mut self) -> f64 {
        let element = self.first + self.drawn % MOST_NUMBERS;
        self.drawn += 1;
        self.stream.unit(self.frame, element)
    }

    pub(crate) fn pair(&mut self) -> [f64; 2] {
        [self.next(), self.next()]
    }

    /// Whether a path has drawn more numbers than have addresses.
    pub(crate) fn is_exhausted(&self) -> bool {
        self.drawn > MOST_NUMBERS
    }
}
