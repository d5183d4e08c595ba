//! Random numbers of a path, by address.

use imaging::random::Stream;

/// Number of addressable pixels.
pub const MOST_PIXELS: u64 = 1 << 28;
/// Number of addressable paths of a pixel.
pub const MOST_PATHS: u64 = 1 << 20;
/// Number of addressable numbers of a path.
const MOST_NUMBERS: u64 = 1 << 12;

/// The stream of the truth of a seed.
#[must_use]
pub fn stream(seed: u64) -> Stream {
    Stream::stage(seed, "truth")
}

/// Address of a path in a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Address {
    /// Frame number.
    pub frame: u64,
    /// Number of the pixel, below [`MOST_PIXELS`].
    pub pixel: u64,
    /// Number of the path, below [`MOST_PATHS`].
    pub sample: u64,
    /// Channel, 0..=2; 3 for a path of all channels.
    pub channel: u64,
}

/// Numbers of a block, which are computed together for speed. Divides [`MOST_NUMBERS`].
const BLOCK: usize = 16;

/// The numbers of one path, in the order of its draws.
pub(crate) struct PathDice {
    stream: Stream,
    frame: u64,
    first: u64,
    drawn: u64,
    /// The block of the last number.
    block: [f64; BLOCK],
}

impl PathDice {
    pub(crate) fn new(stream: Stream, address: Address) -> Self {
        debug_assert!(address.pixel < MOST_PIXELS && address.sample < MOST_PATHS);
        let path = (address.pixel * MOST_PATHS + address.sample) * 4 + address.channel;
        Self {
            stream,
            frame: address.frame,
            first: path * MOST_NUMBERS,
            drawn: 0,
            block: [0.0; BLOCK],
        }
    }

    /// The next number in [0, 1).
    pub(crate) fn next(&mut self) -> f64 {
        let position = self.drawn as usize % BLOCK;
        if position == 0 {
            let element = self.first + self.drawn % MOST_NUMBERS;
            self.stream.fill_units(self.frame, element, 1, &mut self.block);
        }
        self.drawn += 1;
        self.block[position]
    }

    pub(crate) fn pair(&mut self) -> [f64; 2] {
        [self.next(), self.next()]
    }

    /// Whether the path has used up its addresses.
    pub(crate) fn is_exhausted(&self) -> bool {
        self.drawn > MOST_NUMBERS
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_a_path_are_those_of_their_addresses() {
        let address = Address {
            frame: 3,
            pixel: 5,
            sample: 7,
            channel: 2,
        };
        let mut dice = PathDice::new(stream(1), address);
        for number in 0..100 {
            let element = ((5 * MOST_PATHS + 7) * 4 + 2) * MOST_NUMBERS + number;
            assert_eq!(dice.next(), stream(1).unit(3, element));
        }
    }
}
