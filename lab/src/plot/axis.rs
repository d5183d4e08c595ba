//! Axes and their ticks.

/// An axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// The quantity, with its unit.
    pub title: String,
    /// Whether the axis is logarithmic; values must then be positive.
    pub logarithmic: bool,
}

impl Axis {
    /// A linear axis.
    #[must_use]
    pub fn linear(title: &str) -> Self {
        Self {
            title: title.to_owned(),
            logarithmic: false,
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
    from: f64,
    to: f64,
}

impl Scale {
    /// A scale over values with some room around them.
    pub(super) fn new(axis: &Axis, values: impl Iterator<Item = f64>, (from, to): (f64, f64)) -> Self {
        let logarithmic = axis.logarithmic;
        let usable = values.filter(|v| v.is_finite() && (!logarithmic || *v > 0.0));
        let (low, high) = usable
            .map(|v| if logarithmic { v.log10() } else { v })
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
                (low.min(v), high.max(v))
            });
        let (low, high) = if low > high { (0.0, 1.0) } else { (low, high) };
        let room = if high > low { 0.06 * (high - low) } else { 0.5 };
        Self {
            low: low - room,
            high: high + room,
            logarithmic,
            from,
            to,
        }
    }

    pub(super) fn pixel(&self, value: f64) -> Option<f64> {
        let v = if self.logarithmic { value.log10() } else { value };
        let share = (v - self.low) / (self.high - self.low);
        share
            .is_finite()
            .then_some(self.from + share * (self.to - self.from))
    }

    /// Pixels and labels of grid lines.
    pub(super) fn ticks(&self) -> Vec<(f64, String)> {
        let ticks = if self.logarithmic {
            self.logarithmic_ticks()
        } else {
            self.linear_ticks()
        };
        let ticks = ticks.into_iter();
        ticks
            .filter_map(|(value, label)| Some((self.pixel(value)?, label)))
            .collect()
    }

    /// Powers of ten, or finer steps on short axes.
    fn logarithmic_ticks(&self) -> Vec<(f64, String)> {
        let decades = self.low.floor() as i32..=self.high.ceil() as i32;
        let mut ticks = Vec::new();
        for multiples in [&[1.0][..], &[1.0, 2.0, 5.0], &[1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0]] {
            let all = decades
                .clone()
                .flat_map(|decade| multiples.iter().map(move |&m| (m, decade)));
            ticks = all
                .map(|(m, decade)| (m * 10_f64.powi(decade), format_power(m, decade)))
                .filter(|(v, _)| (self.low..=self.high).contains(&v.log10()))
                .collect();
            if ticks.len() > 2 {
                break;
            }
        }
        ticks
    }

    fn linear_ticks(&self) -> Vec<(f64, String)> {
        let rough = (self.high - self.low) / 6.0;
        let unit = 10_f64.powf(rough.log10().floor());
        let mut steps = [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * unit);
        let step = steps.find(|&step| step >= rough).unwrap_or(rough);
        let digits = (-step.log10().floor()).max(0.0) as usize;
        let (first, last) = ((self.low / step).ceil() as i64, (self.high / step).floor() as i64);
        (first..=last)
            .map(|n| n as f64 * step)
            .map(|v| (v, format!("{v:.digits$}")))
            .collect()
    }
}

fn format_power(m: f64, decade: i32) -> String {
    if !(-3..=4).contains(&decade) {
        return format!("{m}e{decade}");
    }
    let digits = decade.min(0).unsigned_abs() as usize + usize::from(m.fract() != 0.0 && decade < 1);
    format!("{:.digits$}", m * 10_f64.powi(decade))
}
