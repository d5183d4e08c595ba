//! Seeded choices by address (seed, topic, object number, choice number), never drawn in order.

use imaging::random::Stream;
use imaging::vector::Vec3;

/// Choices for an object of a topic.
#[derive(Clone, Copy)]
pub(crate) struct Choices {
    stream: Stream,
    object: u64,
}

impl Choices {
    /// Choices for object 0 of a topic.
    pub(crate) fn new(seed: u64, topic: &str) -> Self {
        Self {
            stream: Stream::stage(seed, topic),
            object: 0,
        }
    }

    /// Choices for another object of the topic.
    pub(crate) fn object(self, object: usize) -> Self {
        Self {
            object: object as u64,
            ..self
        }
    }

    /// Uniform in `low..high`.
    pub(crate) fn uniform(self, choice: u64, low: f32, high: f32) -> f32 {
        low + (high - low) * self.stream.unit(self.object, choice) as f32
    }

    /// Uniform in `low..=high`.
    pub(crate) fn count(self, choice: u64, low: usize, high: usize) -> usize {
        low + (self.stream.unit(self.object, choice) * (high - low + 1) as f64) as usize
    }

    /// A point of a box, from three successive choices.
    pub(crate) fn point_in(self, choice: u64, low: [f32; 3], high: [f32; 3]) -> Vec3 {
        [0, 1, 2]
            .map(|axis: usize| self.uniform(choice + axis as u64, low[axis], high[axis]))
            .into()
    }

    /// A horizontal shift of at most `reach` along x and y, from two successive choices.
    pub(crate) fn shift(self, choice: u64, [x, y]: [f32; 2]) -> Vec3 {
        self.point_in(choice, [-x, -y, 0.0], [x, y, 0.0])
    }

    /// True with the given probability.
    pub(crate) fn chance(self, choice: u64, probability: f32) -> bool {
        self.uniform(choice, 0.0, 1.0) < probability
    }

    /// Picks an option; `options` must not be empty.
    pub(crate) fn pick<T: Copy>(self, choice: u64, options: &[T]) -> T {
        options[self.count(choice, 0, options.len() - 1)]
    }

    pub(crate) fn key(self, choice: u64) -> u32 {
        self.stream.bits(self.object, choice) as u32
    }
}
