//! Where a method is known to fail, found by cheap tests while it runs.

use std::fmt;

/// A known failure that a picture shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Warning {
    /// Every pixel has the same colour.
    Constant,
    /// The picture has fewer pixels than the method's statistics rest on.
    FewPixels,
}

impl Warning {
    /// A name that does not change, for filters and tables.
    #[must_use]
    pub fn code(self) -> &'static str {
        match self {
            Self::Constant => "constant",
            Self::FewPixels => "few_pixels",
        }
    }

    /// What is wrong, in words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Constant => "the picture has one colour: nothing tells light from scene",
            Self::FewPixels => "fewer than 1000 pixels: tails and background light rest on a single pixel",
        }
    }
}

/// The code, then the words.
impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.code(), self.words())
    }
}
