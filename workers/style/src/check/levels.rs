//! Which values the samples of a result have.

/// Half of an 8-bit code: rounding beyond it is visible.
const MARGIN: f32 = 0.5 / 255.0;

/// The range of the samples of a picture.
pub(super) struct Levels {
    pub(super) least: f32,
    pub(super) most: f32,
    /// Whether more than half of the samples are outside of 0 to 1.
    pub(super) is_mostly_outside: bool,
}

impl Levels {
    pub(super) fn measure(samples: impl Iterator<Item = f32>) -> Self {
        let (mut least, mut most) = (f32::INFINITY, f32::NEG_INFINITY);
        let (mut count, mut outside) = (0_usize, 0_usize);
        for sample in samples {
            (least, most) = (least.min(sample), most.max(sample));
            count += 1;
            outside += usize::from(!(-MARGIN..=1.0 + MARGIN).contains(&sample));
        }
        Self {
            least,
            most,
            is_mostly_outside: 2 * outside > count,
        }
    }

    pub(super) fn is_flat(&self) -> bool {
        self.most - self.least < MARGIN
    }
}
