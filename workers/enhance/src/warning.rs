//! Known failures of the methods, detected by cheap tests while they run.

use std::fmt;

/// Declares the warnings: code and description.
macro_rules! warnings {
    ($(#[doc = $doc:literal] $Warning:ident $code:literal $words:literal;)*) => {
        /// A known failure.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Warning {
            $(#[doc = $doc] $Warning,)*
        }

        impl Warning {
            /// All warnings.
            pub const ALL: &[Self] = &[$(Self::$Warning),*];

            /// A stable name, for filters and tables.
            #[must_use]
            pub fn code(self) -> &'static str {
                match self { $(Self::$Warning => $code,)* }
            }

            /// Description.
            #[must_use]
            pub fn words(self) -> &'static str {
                match self { $(Self::$Warning => $words,)* }
            }
        }
    };
}

warnings! {
    /// Every pixel has the same color.
    Constant "constant" "the picture has one color, nothing tells light from scene";
    /// Too few pixels for the method's statistics.
    FewPixels "few_pixels" "fewer than 1000 pixels, tails and background light rest on a single pixel";
    /// Tiles with fewer than 64 pixels.
    SmallTiles "small_tiles" "tiles hold fewer than 64 pixels, their histograms are noise";
    /// Nearly all pixels are nearly black.
    Dark "dark" "99 % of the pixels are below luma 16, noise and code steps are made visible";
    /// Red, green and blue are equal everywhere.
    Gray "gray" "the picture is gray, distance can only be guessed from brightness";
    /// A channel is black everywhere.
    ChannelWithoutLight "channel_without_light" "a channel is black everywhere and cannot be balanced";
    /// The most frequent code of a channel is 0.
    BlackMode "black_mode" "the most frequent code of a channel is 0, the stretch has nothing to be relative to";
    /// The result is red where the picture was not.
    RedCast "red_cast" "the result is red where the picture was not, what is left of red was multiplied too far";
    /// Red is stretched by more than four.
    RedAmplified "red_amplified" "red is stretched by more than four, and its noise with it";
    /// Contrast is multiplied by more than four.
    NoiseAmplified "noise_amplified" "contrast is multiplied by more than four, and noise with it";
    /// A bright part of the picture was mistaken for the background light.
    LampAsBackground "lamp_as_background" "a bright part of the picture is taken for the background light, darker parts turn black";
    /// A fifth of a channel turned black.
    Blackened "blackened" "a fifth of a channel turned black";
    /// The background light depends on a threshold that the picture is close to.
    UnstableLight "unstable_light" "the background light hangs on a threshold, the next frame of a film may get another one";
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
        let codes: HashSet<&str> = Warning::ALL.iter().map(|warning| warning.code()).collect();
        assert_eq!(codes.len(), Warning::ALL.len());
        assert_eq!(Warning::Dark.to_string().split(':').next(), Some("dark"));
    }
}
