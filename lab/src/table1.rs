//! The comparison of enhancement methods of the HSCM paper, over any set of pictures.

mod report;

use std::time::Instant;

use enhance::{EnhanceError, Method};
use imaging::{Raster, Rgb8};
use quality::{MetricId, QualityError};

pub use report::{csv, figure, markdown};

/// The methods, in the order of the published table, and the unchanged picture.
pub const METHODS: [&str; 9] = [
    "none",
    "suir",
    "ibla",
    "ulap",
    "rd",
    "rghs",
    "hscm",
    "clahe",
    "grey_world",
];

/// The columns: the published metrics, then the additional ones of the usual profile.
pub const METRICS: [&str; 10] = [
    "entropy_2d",
    "uicm@table1",
    "uism@table1",
    "uiconm@table1",
    "uiqm@table1",
    "entropy",
    "uicm",
    "uism",
    "uiconm",
    "uiqm",
];

/// Why a picture cannot be compared.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// A method failed.
    #[error(transparent)]
    Enhance(#[from] EnhanceError),
    /// A metric failed.
    #[error(transparent)]
    Quality(#[from] QualityError),
}

/// Values of one method, one per picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// One of [`METHODS`].
    pub method: &'static str,
    /// Seconds on one thread for each picture.
    pub seconds: Vec<f64>,
    /// The values of all pictures for each of [`METRICS`].
    pub values: Vec<Vec<f64>>,
    /// Number of pictures for which the method returned a warning.
    pub warned: usize,
}

/// The table, filled picture by picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// A row for each method.
    pub rows: Vec<Row>,
}

impl Default for Table {
    fn default() -> Self {
        let row = |method| Row {
            method,
            seconds: Vec::new(),
            values: vec![Vec::new(); METRICS.len()],
            warned: 0,
        };
        Self {
            rows: METHODS.map(row).into(),
        }
    }
}

impl Table {
    /// Runs every method on a picture and measures the results without masks.
    ///
    /// # Errors
    /// [`TableError`].
    pub fn add(&mut self, picture: &Rgb8) -> Result<(), TableError> {
        let metrics: Vec<MetricId> = METRICS.iter().filter_map(|name| MetricId::parse(name)).collect();
        let raster = Raster::from(picture.clone());
        for row in &mut self.rows {
            let begun = Instant::now();
            let (result, warned) = match Method::parse(row.method) {
                Some(method) => {
                    let enhanced = enhance::run(&method, &raster)?;
                    (enhanced.unmasked.to_rgb8(), !enhanced.warnings.is_empty())
                }
                None => (picture.clone(), false),
            };
            row.seconds.push(begun.elapsed().as_secs_f64());
            row.warned += usize::from(warned);
            for ((_, value), values) in quality::measure(&result, None, &metrics)?
                .into_iter()
                .zip(&mut row.values)
            {
                values.push(value);
            }
        }
        Ok(())
    }

    /// Number of pictures added.
    #[must_use]
    pub fn pictures(&self) -> usize {
        self.rows.first().map_or(0, |row| row.seconds.len())
    }
}

/// Mean and sample standard deviation; the latter is 0 for fewer than two values.
#[must_use]
pub fn mean_sd(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    if values.len() < 2 {
        return (mean, 0.0);
    }
    let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    (mean, (squares / (n - 1.0)).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_known_to_the_crate_that_owns_it() {
        assert!(METRICS.iter().all(|name| MetricId::parse(name).is_some()));
        assert!(METHODS.iter().skip(1).all(|name| Method::parse(name).is_some()));
    }

    #[test]
    fn a_table_has_a_value_of_every_method_for_every_picture() {
        let mut table = Table::default();
        for shift in [0, 90] {
            let picture = Rgb8::from_fn(64, 48, |x, y| {
                [(3 * x) as u8, (2 * y + shift) as u8, (x + y) as u8]
            });
            table.add(&picture).unwrap();
        }
        assert_eq!(table.pictures(), 2);
        for row in &table.rows {
            assert!(
                row.values
                    .iter()
                    .all(|values| values.len() == 2 && values.iter().all(|v| v.is_finite()))
            );
        }
        let uiqm = METRICS.iter().position(|name| *name == "uiqm").unwrap();
        assert_ne!(
            table.rows[0].values[uiqm], table.rows[6].values[uiqm],
            "enhancing changes nothing"
        );
        let (text, figure) = (markdown(&table, ""), figure(&table));
        assert!(
            METHODS.iter().all(|method| text.contains(method))
                && csv(&table).lines().count() > 2 * METHODS.len()
        );
        assert!(crate::plot::svg(&figure).unwrap().starts_with("<svg"));
        let drawn = crate::plot::picture(&figure).unwrap();
        assert!(drawn.data().iter().any(|&v| v < 100), "an empty sheet");
    }

    #[test]
    fn the_spread_is_that_of_a_sample() {
        assert_eq!(mean_sd(&[1.0, 3.0]), (2.0, 2.0_f64.sqrt()));
        assert_eq!(mean_sd(&[4.0]), (4.0, 0.0));
    }
}
