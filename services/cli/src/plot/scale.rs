//! Axes and their ticks.

/// An axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// The quantity, with its unit.
    pub title: String,
    /// Whether the axis is logarithmic; values must then be positive.
    pub logarithmic: bool,
    /// Whether the axis begins at 0.
    pub from_zero: bool,
}

impl Axis {
    /// A linear axis.
    #[must_use]
    pub fn linear(title: &str) -> Self {
        Self {
            title: title.to_owned(),
            logarithmic: false,
            from_zero: false,
        }
    }

    /// A linear axis that begins at 0.
    #[must_use]
    pub fn from_zero(title: &str) -> Self {
        Self {
            from_zero: true,
            ..Self::linear(title)
        }
    }

    /// A logarithmic axis.
    #[must_use]
    pub fn logarithmic(title: &str) -> Self {
        Self {
            logarithmic: true,
            ..Self::linear(title)
        }
    }
}

/// Maps values to pixels.
pub(super) struct Scale {
    low: f64,
    high: f64,
    logarithmic: bool,
    pixels: (f64, f64),
}

impl Scale {
    /// A scale over values with some room around them.
    pub(super) fn new(axis: &Axis, values: impl Iterator<Item = f64>, pixels: (f64, f64)) -> Self {
        let logarithmic = axis.logarithmic;
        let values = values.map(|v| if logarithmic { v.log10() } else { v });
        let values: Vec<f64> = values.filter(|v| v.is_finite()).collect();
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let (low, high) = if low > high { (0.0, 1.0) } else { (low, high) };
        if axis.from_zero {
            let high = if high > 0.0 { 1.2 * high } else { 1.0 };
            return Self {
                low: 0.0,
                high,
                logarithmic,
                pixels,
            };
        }
        let room = if high > low { 0.06 * (high - low) } else { 0.5 };
        Self {
            low: low - room,
            high: high + room,
            logarithmic,
            pixels,
        }
    }

    pub(super) fn pixel(&self, value: f64) -> Option<f64> {
        let v = if self.logarithmic { value.log10() } else { value };
        let share = (v - self.low) / (self.high - self.low);
        let (start, end) = self.pixels;
        share.is_finite().then_some(start + share * (end - start))
    }

    /// Pixels and labels of grid lines: powers of ten on logarithmic axes, with more multiples the shorter they are, round numbers on linear ones.
    pub(super) fn ticks(&self) -> Vec<(f64, String)> {
        let values: Vec<f64> = if self.logarithmic {
            let decades = self.low.floor() as i32..=self.high.ceil() as i32;
            let multiples: &[f64] = match self.high - self.low {
                range if range < 0.8 => &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0],
                range if range < 3.0 => &[1.0, 2.0, 5.0],
                _ => &[1.0],
            };
            let values = decades.flat_map(|decade| multiples.iter().map(move |m| m * 10_f64.powi(decade)));
            values
                .filter(|v| (self.low..=self.high).contains(&v.log10()))
                .collect()
        } else {
            let rough = (self.high - self.low) / 6.0;
            let unit = 10_f64.powf(rough.log10().floor());
            let steps = [1.0, 2.0, 5.0, 10.0].map(|m| m * unit);
            let step = steps.into_iter().find(|&step| step >= rough).unwrap_or(rough);
            let numbers = (self.low / step).ceil() as i64..=(self.high / step).floor() as i64;
            numbers.map(|n| n as f64 * step).collect()
        };
        let ticks = values.into_iter();
        ticks
            .filter_map(|value| Some((self.pixel(value)?, format_tick(value))))
            .collect()
    }
}

/// At most six significant digits, without trailing zeros.
fn format_tick(value: f64) -> String {
    match value.abs() {
        v if v != 0.0 && !(1e-3..1e5).contains(&v) => format!("{value:.0e}"),
        _ => format!("{}", (value * 1e6).round() / 1e6),
    }
}
