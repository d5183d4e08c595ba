//! Seeded choices, addressed and never drawn in order: (seed, topic, object number, choice number).

use imaging::random::Stream;

/// The choices about one object of a topic.
#[derive(Clone, Copy)]
pub(crate) struct Dice {
    stream: Stream,
    object: u64,
}

impl Dice {
    /// The choices about object 0 of a topic.
    pub(crate) fn about(seed: u64, topic: &str) -> Self {
        Self {
            stream: Stream::stage(seed, topic),
            object: 0,
        }
    }

    /// The choices about another object of the topic.
    pub(crate) fn object(self, object: usize) -> Self {
        Self {
            object: object as u64,
            ..self
        }
    }

    /// Uniform in `low..high`.
    pub(crate) fn between(self, choice: u64, low: f32, high: f32) -> f32 {
        low + (high - low) * self.stream.unit(self.object, choice) as f32
    }

    /// Uniform in `low..=high`.
    pub(crate) fn count(self, choice: u64, low: usize, high: usize) -> usize {
        low + (self.stream.unit(self.object, choice) * (high - low + 1) as f64) as usize
    }

    /// True with the given probability.
    pub(crate) fn chance(self, choice: u64, probability: f32) -> bool {
        self.between(choice, 0.0, 1.0) < probability
    }

    /// One of the options, which are not none.
    pub(crate) fn pick<T: Copy>(self, choice: u64, options: &[T]) -> T {
        options[self.count(choice, 0, options.len() - 1)]
    }

    /// Key of a noise field.
    pub(crate) fn key(self, choice: u64) -> u32 {
        self.stream.bits(self.object, choice) as u32
    }
}
