//! Measured figures with their limits.

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
}

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
}
