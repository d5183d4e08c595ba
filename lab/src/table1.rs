//! The comparison of enhancement methods of the HSCM paper, over any set of pictures.

use std::time::Instant;

use cli::exit::Failure;
use cli::files;
use cli::progress::Progress;
use enhance::Method;
use imaging::{Raster, Rgb8};
use quality::MetricId;
use serde_json::json;

use crate::plot::{Bar, Bars};
use crate::report::Report;
use crate::row;
use crate::setup::{Parameter, Setup};
use crate::statistics::{deviation, mean};
use crate::table::Table;

/// The parameters of the comparison.
pub const PARAMETERS: &[Parameter] = &[Parameter::number("limit", "200", [1.0, 1e6], "pictures")];
/// The methods, in the order of the published table, and the unchanged picture.
const METHODS: &str = "none suir ibla ulap rd rghs hscm clahe gray_world";
/// The published metrics, then those of the usual profile.
const METRICS: &str =
    "entropy_2d uicm@table1 uism@table1 uiconm@table1 uiqm@table1 entropy uicm uism uiconm uiqm";
/// Values of one method, one per picture.
#[derive(Debug, Clone, PartialEq)]
struct Results {
    method: &'static str,
    /// Seconds on one thread.
    seconds: Vec<f64>,
    /// The values of all pictures for each of [`METRICS`].
    values: Vec<Vec<f64>>,
    /// Number of pictures for which the method returned a warning.
    warned: usize,
}

/// Compares the methods over the pictures of a folder.
///
/// # Errors
/// A picture cannot be read or enhanced.
pub fn run(setup: &Setup) -> Result<Report, Failure> {
    let folder = &setup.required_inputs("a folder of pictures")?[0];
    let mut pictures = files::pictures(folder)?;
    pictures.truncate(setup.count("limit"));
    if pictures.is_empty() {
        let message = format!("{}: no PNG, JPEG or WebP", folder.display());
        return Err(Failure::BadInput(message));
    }
    let mut progress = Progress::new("table1", "pictures", pictures.len() as u64);
    let mut results = empty_results();
    for (done, path) in pictures.iter().enumerate() {
        let picture = files::read_picture(path)?.to_rgb8();
        for one in &mut results {
            one.add(&picture)
                .map_err(|error| Failure::BadInput(format!("{}: {error:#}", path.display())))?;
        }
        progress.set(done as u64 + 1);
    }
    progress.finish();
    let (count, folder) = (pictures.len(), folder.display());
    let about = format!("{count} pictures of {folder}; seconds of one thread.");
    Ok(report(&results, about))
}

fn empty_results() -> Vec<Results> {
    let results = METHODS.split(' ').map(|method| Results {
        method,
        seconds: Vec::new(),
        values: vec![Vec::new(); list_metrics().len()],
        warned: 0,
    });
    results.collect()
}

fn list_metrics() -> Vec<MetricId> {
    METRICS.split(' ').filter_map(MetricId::parse).collect()
}

impl Results {
    /// Runs the method on a picture and measures the result without its mask.
    fn add(&mut self, picture: &Rgb8) -> anyhow::Result<()> {
        let raster = Raster::from(picture.clone());
        let begun = Instant::now();
        let (result, warned) = match Method::parse(self.method) {
            Some(method) => {
                let enhanced = enhance::run(&method, &raster)?;
                (enhanced.picture.to_rgb8(), !enhanced.warnings.is_empty())
            }
            None => (picture.clone(), false),
        };
        self.seconds.push(begun.elapsed().as_secs_f64());
        self.warned += usize::from(warned);
        let measured = quality::measure(&result, None, &list_metrics())?;
        for ((_, value), values) in measured.into_iter().zip(&mut self.values) {
            values.push(value);
        }
        Ok(())
    }
}

/// The profile of the published table, the usual profile, and bars of the first.
fn report(results: &[Results], about: String) -> Report {
    let columns = ["s", "entropy", "UICM", "UISM", "UIConM", "UIQM"];
    let mut tables = Vec::new();
    for (profile, from) in [("table1", 0), ("panetta", 5)] {
        let name = format!("profile {profile}, mean (sd)");
        let mut table = Table::new(name, ["method"].into_iter().chain(columns).chain(["warned"]));
        for one in results {
            let mut row = row![one.method, format_spread(&one.seconds, 4)];
            let values = one.values[from..from + 5].iter();
            row.extend(values.map(|values| json!(format_spread(values, 2))));
            row.extend(row![format!("{} of {}", one.warned, one.seconds.len())]);
            table.push(row);
        }
        tables.push(table);
    }
    let mut report = Report::new(about, tables);
    let mut panels = vec![("s, one thread".to_owned(), draw(results, |one| &one.seconds))];
    for (metric, title) in columns[1..].iter().enumerate() {
        panels.push(((*title).to_owned(), draw(results, |one| &one.values[metric])));
    }
    let title = "Enhancement methods, mean and standard deviation, profile table1".to_owned();
    report.add_chart("table1", Bars { title, panels }.svg());
    report
}

fn draw<'a>(results: &'a [Results], values: impl Fn(&'a Results) -> &'a [f64]) -> Vec<Bar> {
    let bars = results.iter().map(|one| Bar {
        name: one.method.chars().take(4).collect(),
        mean: mean(values(one)),
        sd: deviation(values(one)),
    });
    bars.collect()
}

fn format_spread(values: &[f64], digits: usize) -> String {
    format!("{:.digits$} ({:.digits$})", mean(values), deviation(values))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_known_to_the_crate_that_defines_it() {
        assert!(METRICS.split(' ').all(|name| MetricId::parse(name).is_some()));
        assert!(
            METHODS
                .split(' ')
                .skip(1)
                .all(|name| Method::parse(name).is_some())
        );
    }

    #[test]
    fn a_table_has_a_value_of_every_method_for_every_picture() {
        let mut results = empty_results();
        for shift in [0, 90] {
            let picture = Rgb8::from_fn(64, 48, |x, y| {
                [(3 * x) as u8, (2 * y + shift) as u8, (x + y) as u8]
            });
            results.iter_mut().for_each(|one| one.add(&picture).unwrap());
        }
        for one in &results {
            let mut values = one.values.iter();
            assert!(values.all(|values| values.len() == 2 && values.iter().all(|v| v.is_finite())));
        }
        assert_ne!(
            results[0].values[9], results[6].values[9],
            "enhancing changes nothing"
        );
        let report = report(&results, String::new());
        assert!(
            METHODS
                .split(' ')
                .all(|method| report.tables[0].markdown().contains(method))
        );
        assert!(report.charts[0].1.starts_with("<svg"));
    }
}
