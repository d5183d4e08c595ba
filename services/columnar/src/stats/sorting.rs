//! Statistics from the sorted values of each group.

use super::summary::{Quantile, SHARES, Summaries, Summary, each_value};
use crate::error::ColumnarError;
use crate::groups::Grouped;
use crate::parts::Masked;
use crate::sum::Sum;

/// The summaries of all groups from their collected values.
pub(super) fn by_sorting(
    masked: &Masked<'_>,
    grouped: &Grouped,
    metric: usize,
) -> Result<Summaries, ColumnarError> {
    let groups = grouped.keys.len();
    let mut all = vec![Vec::new(); groups];
    let parts = masked.pass(Vec::new, |values, rows| {
        each_value(rows, grouped, metric, |group, value| values.push((group, value)))
    })?;
    for (group, value) in parts.into_iter().flatten() {
        all[group].push(value);
    }
    Ok(all.into_iter().map(summary).collect())
}

/// Statistics of values by sorting them, also of infinite ones.
pub(super) fn summary(mut values: Vec<f64>) -> Summary {
    values.sort_by(f64::total_cmp);
    let count = values.len();
    let mean = (count > 0).then(|| Sum::exact(values.iter().copied()) / count as f64);
    let sd = mean.filter(|_| count > 1).map(|mean| {
        let squares = values.iter().map(|value| (value - mean) * (value - mean));
        (Sum::exact(squares) / (count - 1) as f64).sqrt()
    });
    let [q25, median, q75] = SHARES.map(|share| {
        let place = Quantile::new(share, count as u64)?;
        Some(place.between(values[place.low as usize], values[place.high as usize]))
    });
    Summary {
        count: count as u64,
        mean,
        sd,
        min: values.first().map(|value| value + 0.0),
        q25,
        median,
        q75,
        max: values.last().map(|value| value + 0.0),
    }
}
