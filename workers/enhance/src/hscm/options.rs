//! Options of HSCM: a plain struct that a request is read into, and the checked form that the stages trust.

/// Most tiles across or down. Tables of a row of tiles are held at once, and tiles of a few pixels are noise anyway.
pub const GRID_MAX: usize = 256;
/// Largest median window side: up to here its pixel counts fit 16 bits with room to spare.
pub const MEDIAN_MAX: usize = 31;
/// Bounds of `r_high`, `r_low`, `cutoff`, `delta`, `eps` and `clip_limit`. Wide beyond use; they keep every product
/// of options far from overflow.
pub const MAGNITUDE_MAX: f64 = 1e6;
/// Smallest of the values that must be above 0, for the same reason.
pub const MAGNITUDE_MIN: f64 = 1e-12;
/// Largest center (either sign) and radius of the circle, in parts of the picture.
pub const CIRCLE_MAX: f64 = 100.0;

/// What is computed: the method as specified, or as the published table was made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Profile {
    /// Reflected padding, `ln(y + eps)`, rounding.
    #[default]
    Standard,
    /// For regenerating the published comparison table: padding with 0 in the log domain (a white band that bleeds
    /// into the borders), `delta = floor(W / cutoff)`, `ln(max(y, 1e-5))`, truncation.
    Table1,
}

/// Whether the luma is merged back into the colors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Output {
    /// Chroma of the input, luma of the result. A gray picture stays gray.
    #[default]
    Color,
    /// The luma alone.
    Gray,
}

/// The circle that is kept, in parts of the picture; it may lie outside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Circle {
    /// Center column as part of the width, -100..=100.
    pub center_x: f64,
    /// Center row as part of the height, -100..=100.
    pub center_y: f64,
    /// Radius as part of the width, 0..=100.
    pub radius: f64,
}

impl Default for Circle {
    fn default() -> Self {
        Self {
            center_x: 0.45,
            center_y: 0.33,
            radius: 0.44,
        }
    }
}

/// Options as a user writes them, not yet checked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Gain of high frequencies, above 0 and not below `r_low`; 2.5.
    pub r_high: f64,
    /// Gain of low frequencies, above 0; 0.5.
    pub r_low: f64,
    /// Cut-off: `delta = max(W / cutoff, 1)` in bins of the transform, above 0; 32.
    pub cutoff: f64,
    /// Cut-off in bins, above 0; takes the place of `cutoff` where given.
    pub delta: Option<f64>,
    /// Added to the luma (0..1) before the logarithm, above 0; 0.01.
    pub eps: f64,
    /// Side of the median window in pixels, odd, 1..=31; 1 turns it off; 5.
    pub median: usize,
    /// Contrast limit of CLAHE as a multiple of the mean bin, not negative; 0 is plain adaptive equalization; 2.
    pub clip_limit: f64,
    /// Number of tiles across and down, 1..=256 each; 8 and 8.
    pub grid: (usize, usize),
    /// The circle that is kept; `None` keeps everything.
    pub mask: Option<Circle>,
    /// Color or gray.
    pub output: Output,
    /// Standard or table 1.
    pub profile: Profile,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            r_high: 2.5,
            r_low: 0.5,
            cutoff: 32.0,
            delta: None,
            eps: 0.01,
            median: 5,
            clip_limit: 2.0,
            grid: (8, 8),
            mask: Some(Circle::default()),
            output: Output::Color,
            profile: Profile::Standard,
        }
    }
}

/// An option out of its range.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{field} is {value} but must be {limit}")]
pub struct OptionError {
    /// The option's name, with its part where it has parts: `grid.across`.
    pub field: &'static str,
    /// The value as given.
    pub value: String,
    /// What is allowed.
    pub limit: String,
}

/// Options within their ranges, by construction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options(Settings);

impl Default for Options {
    fn default() -> Self {
        Self::new(Settings::default()).expect("the defaults lie within their ranges")
    }
}

impl Options {
    /// Checks every option.
    ///
    /// # Errors
    /// One [`OptionError`] for each option out of range, in the order of [`Settings`].
    pub fn new(settings: Settings) -> Result<Self, Vec<OptionError>> {
        let Settings {
            r_high, r_low, grid, ..
        } = settings;
        let mut errors = Vec::new();
        let mut check = |field, good: bool, value: String, limit: String| {
            if !good {
                errors.push(OptionError { field, value, limit });
            }
        };
        let circle = |value: fn(Circle) -> f64| settings.mask.map(value);
        let reals = [
            ("r_high", Some(r_high), MAGNITUDE_MIN, MAGNITUDE_MAX),
            ("r_low", Some(r_low), MAGNITUDE_MIN, MAGNITUDE_MAX),
            ("cutoff", Some(settings.cutoff), MAGNITUDE_MIN, MAGNITUDE_MAX),
            ("delta", settings.delta, MAGNITUDE_MIN, MAGNITUDE_MAX),
            ("eps", Some(settings.eps), MAGNITUDE_MIN, MAGNITUDE_MAX),
            ("clip_limit", Some(settings.clip_limit), 0.0, MAGNITUDE_MAX),
            ("mask.center_x", circle(|c| c.center_x), -CIRCLE_MAX, CIRCLE_MAX),
            ("mask.center_y", circle(|c| c.center_y), -CIRCLE_MAX, CIRCLE_MAX),
            ("mask.radius", circle(|c| c.radius), 0.0, CIRCLE_MAX),
        ];
        for (field, value, low, high) in reals {
            let Some(value) = value else { continue };
            let limit = format!("within {low:?}..={high:?}");
            check(field, (low..=high).contains(&value), format!("{value:?}"), limit);
        }
        let limit = format!("at most r_high = {r_high:?}");
        let above = r_low > r_high;
        check("r_low", !above, format!("{r_low:?}"), limit);
        let odd = !settings.median.is_multiple_of(2) && settings.median <= MEDIAN_MAX;
        let limit = format!("odd and within 1..={MEDIAN_MAX}");
        check("median", odd, settings.median.to_string(), limit);
        for (field, tiles) in [("grid.across", grid.0), ("grid.down", grid.1)] {
            let good = (1..=GRID_MAX).contains(&tiles);
            check(field, good, tiles.to_string(), format!("within 1..={GRID_MAX}"));
        }
        if errors.is_empty() {
            Ok(Self(settings))
        } else {
            Err(errors)
        }
    }

    /// The options as plain values.
    #[must_use]
    pub fn settings(&self) -> &Settings {
        &self.0
    }

    /// The cut-off in bins for a picture of this width: `delta` where given, else `max(W / cutoff, 1)`; the table 1
    /// profile takes `floor(W / cutoff)`, which also stays at 1 or above.
    #[must_use]
    pub fn delta_bins(&self, width: usize) -> f64 {
        let part = width as f64 / self.0.cutoff;
        match (self.0.delta, self.0.profile) {
            (Some(delta), _) => delta,
            (None, Profile::Standard) => part.max(1.0),
            (None, Profile::Table1) => part.floor().max(1.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_option_out_of_range_is_reported_with_name_value_and_limit() {
        let settings = Settings {
            r_high: 0.0,
            r_low: -1.0,
            cutoff: f64::NAN,
            delta: Some(0.0),
            eps: 0.0,
            median: 4,
            clip_limit: -0.5,
            grid: (0, 300),
            mask: Some(Circle {
                center_x: f64::INFINITY,
                center_y: 0.3,
                radius: -0.1,
            }),
            ..Settings::default()
        };
        let errors = Options::new(settings).unwrap_err();
        let fields: Vec<&str> = errors.iter().map(|error| error.field).collect();
        let expected = [
            "r_high",
            "r_low",
            "cutoff",
            "delta",
            "eps",
            "clip_limit",
            "mask.center_x",
            "mask.radius",
            "median",
            "grid.across",
            "grid.down",
        ];
        assert_eq!(fields, expected);
        assert_eq!(
            errors[8].to_string(),
            "median is 4 but must be odd and within 1..=31"
        );
    }

    #[test]
    fn the_low_gain_may_not_exceed_the_high_gain() {
        let errors = Options::new(Settings {
            r_low: 3.0,
            ..Settings::default()
        })
        .unwrap_err();
        assert_eq!(errors.len(), 1);
        assert_eq!(
            errors[0].to_string(),
            "r_low is 3.0 but must be at most r_high = 2.5"
        );
    }

    #[test]
    fn checked_options_give_back_the_settings_they_came_from() {
        let settings = Settings {
            median: 1,
            delta: Some(7.5),
            mask: None,
            ..Settings::default()
        };
        assert_eq!(*Options::new(settings).unwrap().settings(), settings);
    }

    #[test]
    fn the_cutoff_never_goes_below_one_bin() {
        let table1 = Options::new(Settings {
            profile: Profile::Table1,
            ..Settings::default()
        })
        .unwrap();
        assert_eq!(Options::default().delta_bins(97), 97.0 / 32.0);
        assert_eq!(table1.delta_bins(97), 3.0);
        assert_eq!(Options::default().delta_bins(3), 1.0);
        assert_eq!(table1.delta_bins(3), 1.0);
    }
}
