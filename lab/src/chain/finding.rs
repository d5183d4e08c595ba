//! Measured figures with their limits.

use imaging::{Rgb, Rgb8, transfer};

/// The limit of a figure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Limit {
    /// No more than this.
    AtMost(f64),
    /// At least this: the page shows a weakness and must be revised once it is fixed.
    AtLeast(f64),
}

/// One measured value.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// The measured quantity, with its unit.
    pub what: &'static str,
    /// Its value.
    pub value: f64,
    /// Its limit.
    pub limit: Limit,
}

impl Figure {
    /// Within its limit, and a number.
    #[must_use]
    pub fn is_within(&self) -> bool {
        match self.limit {
            Limit::AtMost(limit) => self.value <= limit,
            Limit::AtLeast(limit) => self.value >= limit,
        }
    }
}

/// The figures of one kind of hostile frame.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Finding {
    /// The measurements.
    pub figures: Vec<Figure>,
    /// A picture, if it helps.
    pub picture: Option<Rgb8>,
}

const GAP_PX: usize = 8;

impl Finding {
    /// Adds a promise.
    pub(super) fn at_most(mut self, what: &'static str, value: f64, limit: f64) -> Self {
        let limit = Limit::AtMost(limit);
        self.figures.push(Figure { what, value, limit });
        self
    }

    /// Adds a known weakness.
    pub(super) fn at_least(mut self, what: &'static str, value: f64, limit: f64) -> Self {
        let limit = Limit::AtLeast(limit);
        self.figures.push(Figure { what, value, limit });
        self
    }

    /// Adds linear pictures of one size in a row, separated by white.
    pub(super) fn with_row(mut self, pictures: &[Rgb<f32>]) -> Self {
        let shown: Vec<Rgb8> = pictures.iter().map(|p| transfer::encode_rgb8(p).0).collect();
        let (width, height) = (shown[0].width(), shown[0].height());
        let step = width + GAP_PX;
        self.picture = Some(Rgb8::from_fn(step * shown.len() - GAP_PX, height, |x, y| {
            let inside = Some(x % step).filter(|x| *x < width);
            inside.map_or([255; 3], |inside| shown[x / step].pixel(inside, y))
        }));
        self
    }
}
