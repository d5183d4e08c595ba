//! Known failures of the methods, detected by cheap tests while they run.

use std::fmt;

/// A known failure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Warning {
    /// Every pixel has the same color.
    Constant,
    /// Too few pixels for the method's statistics.
    FewPixels,
    /// Tiles with fewer than 64 pixels.
    SmallTiles,
    /// Nearly all pixels are nearly black.
    Dark,
    /// Red, green and blue are equal everywhere.
    Gray,
    /// A channel is black everywhere.
    ChannelWithoutLight,
    /// The most frequent code of a channel is 0.
    BlackMode,
    /// The result is red where the picture was not.
    RedCast,
    /// Red is stretched by more than four.
    RedAmplified,
    /// A bright part of the picture was mistaken for the background light.
    LampAsBackground,
    /// A fifth of a channel turned black.
    Blackened,
    /// The background light depends on a threshold that the picture is close to.
    UnstableLight,
}

impl Warning {
    /// All warnings.
    pub const ALL: [Self; 12] = [
        Self::Constant,
        Self::FewPixels,
        Self::SmallTiles,
        Self::Dark,
        Self::Gray,
        Self::ChannelWithoutLight,
        Self::BlackMode,
        Self::RedCast,
        Self::RedAmplified,
        Self::LampAsBackground,
        Self::Blackened,
        Self::UnstableLight,
    ];

    /// A stable name, for filters and tables.
    #[must_use]
    pub fn code(self) -> &'static str {
        match self {
            Self::Constant => "constant",
            Self::FewPixels => "few_pixels",
            Self::SmallTiles => "small_tiles",
            Self::Dark => "dark",
            Self::Gray => "gray",
            Self::ChannelWithoutLight => "channel_without_light",
            Self::BlackMode => "black_mode",
            Self::RedCast => "red_cast",
            Self::RedAmplified => "red_amplified",
            Self::LampAsBackground => "lamp_as_background",
            Self::Blackened => "blackened",
            Self::UnstableLight => "unstable_light",
        }
    }

    /// Description.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Constant => "the picture has one color, nothing tells light from scene",
            Self::FewPixels => "fewer than 1000 pixels, tails and background light rest on a single pixel",
            Self::SmallTiles => "tiles hold fewer than 64 pixels, their histograms are noise",
            Self::Dark => "99 % of the pixels are below luma 16, noise and code steps are made visible",
            Self::Gray => "the picture is gray, distance can only be guessed from brightness",
            Self::ChannelWithoutLight => "a channel is black everywhere and cannot be balanced",
            Self::BlackMode => {
                "the most frequent code of a channel is 0, the stretch has nothing to be relative to"
            }
            Self::RedCast => {
                "the result is red where the picture was not, what is left of red was multiplied too far"
            }
            Self::RedAmplified => "red is stretched by more than four, and its noise with it",
            Self::LampAsBackground => {
                "a bright part of the picture is taken for the background light, darker parts turn black"
            }
            Self::Blackened => "a fifth of a channel turned black",
            Self::UnstableLight => {
                "the background light hangs on a threshold, the next frame of a film may get another one"
            }
        }
    }
}

/// The code, then the description.
impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.code(), self.words())
    }
}

/// Returns the warnings with a positive test.
pub(crate) fn found(tests: impl IntoIterator<Item = (bool, Warning)>) -> Vec<Warning> {
    let found = tests.into_iter().filter(|(found, _)| *found);
    found.map(|(_, warning)| warning).collect()
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn every_warning_has_its_own_code() {
        let codes: HashSet<&str> = Warning::ALL.into_iter().map(Warning::code).collect();
        assert_eq!(codes.len(), Warning::ALL.len());
        assert_eq!(Warning::Dark.to_string().split(':').next(), Some("dark"));
    }
}
