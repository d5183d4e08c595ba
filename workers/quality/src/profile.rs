//! Published profiles of metrics.

/// Published arithmetic of a metric.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Profile {
    /// The formulas of the article (Panetta, Gao and Agaian 2016). The default, omitted from names.
    Panetta,
    /// The program shared by underwater deep-learning papers, with its errors.
    Funie,
    /// Agrees with the published comparison table of enhancement methods.
    Table1,
}

impl Profile {
    /// Every profile, the default first.
    pub const ALL: [Self; 3] = [Self::Panetta, Self::Funie, Self::Table1];

    /// Source of the arithmetic.
    #[must_use]
    pub fn about(self) -> &'static str {
        match self {
            Self::Panetta => "formulas of Panetta, Gao and Agaian 2016; the default, whose name is left out",
            Self::Funie => "the program that underwater deep-learning papers share, with its slips",
            Self::Table1 => {
                "arithmetic that agrees with the published comparison table of enhancement methods"
            }
        }
    }

    /// Name after the `@`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Panetta => "panetta",
            Self::Funie => "funie",
            Self::Table1 => "table1",
        }
    }
}
