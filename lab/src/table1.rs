//! The comparison of enhancement methods of the HSCM paper, over any set of pictures.

use std::time::Instant;

use cli::exit::Failure;
use cli::files;
use cli::progress::Progress;
use enhance::Method;
use imaging::{Raster, Rgb8};
use quality::MetricId;

use crate::plot::{Bar, Bars, Chart};
use crate::report::Report;
use crate::row;
use crate::setup::{Parameter, Setup};
use crate::statistics::{deviation, mean};
use crate::table::Table;

/// The parameters of the comparison.
pub const PARAMETERS: &[Parameter] = &[Parameter::number(
    "limit",
    "200",
    [1.0, 1e6],
    "maximum number of pictures",
)];
/// The methods, in the order of the published table, and the unchanged picture.
const METHODS: [&str; 9] = [
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
/// The published metrics, then those of the usual profile.
const METRICS: [&str; 10] = [
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
/// The published means: seconds, entropy, UICM, UISM, UIConM, UIQM.
const PUBLISHED: [(&str, [f64; 6]); 6] = [
    ("suir", [7.08, 10.14, 4.42, 2.45, -0.12, 1.02]),
    ("ibla", [14.0, 4.62, 5.59, 2.24, -0.65, 1.17]),
    ("ulap", [1.01, 10.49, 5.79, 2.62, -0.61, 1.29]),
    ("rd", [3.54, 10.77, 5.29, 2.67, -0.55, 1.27]),
    ("rghs", [2.28, 10.49, 3.94, 2.42, -0.63, 1.17]),
    ("hscm", [0.33, 10.42, 3.09, 2.56, -0.23, 1.05]),
];

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
        return Err(Failure::BadInput(format!(
            "{}: no PNG, JPEG or WebP",
            folder.display()
        )));
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
    let about = format!(
        "{} pictures of {}; seconds of one thread.",
        pictures.len(),
        folder.display()
    );
    Ok(report(&results, about))
}

fn empty_results() -> Vec<Results> {
    let results = METHODS.map(|method| Results {
        method,
        seconds: Vec::new(),
        values: vec![Vec::new(); METRICS.len()],
        warned: 0,
    });
    results.into()
}

impl Results {
    /// Runs the method on a picture and measures the result without its mask.
    fn add(&mut self, picture: &Rgb8) -> anyhow::Result<()> {
        let raster = Raster::from(picture.clone());
        let begun = Instant::now();
        let (result, warned) = match Method::parse(self.method) {
            Some(method) => {
                let enhanced = enhance::run(&method, &raster)?;
                (enhanced.unmasked.to_rgb8(), !enhanced.warnings.is_empty())
            }
            None => (picture.clone(), false),
        };
        self.seconds.push(begun.elapsed().as_secs_f64());
        self.warned += usize::from(warned);
        let metrics: Vec<MetricId> = METRICS.iter().filter_map(|name| MetricId::parse(name)).collect();
        let measured = quality::measure(&result, None, &metrics)?;
        for ((_, value), values) in measured.into_iter().zip(&mut self.values) {
            values.push(value);
        }
        Ok(())
    }
}

/// The profile of the published table, the published numbers, the usual profile, and bars of the first.
fn report(results: &[Results], about: String) -> Report {
    let columns = |entropy| ["method", "s", entropy, "UICM", "UISM", "UIConM", "UIQM"];
    let mut tables = Vec::new();
    for (profile, entropy, from) in [("table1", "entropy_2d", 0), ("panetta", "entropy", 5)] {
        let name = format!("profile {profile}, mean (sd)");
        let mut table = Table::new(name, columns(entropy).into_iter().chain(["warned"]));
        for one in results {
            let mut row = row![one.method, format_spread(&one.seconds, 4)];
            row.extend(
                one.values[from..from + 5]
                    .iter()
                    .map(|values| format_spread(values, 2).into()),
            );
            row.extend(row![format!("{} of {}", one.warned, one.seconds.len())]);
            table.push(row);
        }
        tables.push(table);
    }
    let mut published = Table::new("as published", columns("entropy"));
    for (method, [seconds, entropy, uicm, uism, uiconm, uiqm]) in PUBLISHED {
        published.push(row![method, seconds, entropy, uicm, uism, uiconm, uiqm]);
    }
    tables.push(published);
    let mut report = Report::new(about, tables);
    let titles = ["entropy_2d, bits", "UICM", "UISM", "UIConM", "UIQM"];
    let bars = |values: fn(&Results, usize) -> &[f64], metric: usize, scale: f64| -> Vec<Bar> {
        let bars = results.iter().map(|one| Bar {
            name: one.method.chars().take(4).collect(),
            mean: scale * mean(values(one, metric)),
            sd: scale * deviation(values(one, metric)),
        });
        bars.collect()
    };
    let time = (
        "time, ms on one thread".to_owned(),
        bars(|one, _| &one.seconds, 0, 1000.0),
    );
    let metrics = titles.iter().enumerate();
    let metrics = metrics.map(|(metric, title)| {
        (
            (*title).to_owned(),
            bars(|one, metric| &one.values[metric], metric, 1.0),
        )
    });
    report.add_chart(
        "table1",
        Chart::Bars(Bars {
            title: "Enhancement methods, mean and standard deviation, profile table1".to_owned(),
            panels: std::iter::once(time).chain(metrics).collect(),
        }),
    );
    report
}

fn format_spread(values: &[f64], digits: usize) -> String {
    format!("{:.digits$} ({:.digits$})", mean(values), deviation(values))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_known_to_the_crate_that_defines_it() {
        assert!(METRICS.iter().all(|name| MetricId::parse(name).is_some()));
        assert!(METHODS.iter().skip(1).all(|name| Method::parse(name).is_some()));
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
                .iter()
                .all(|method| report.tables[0].markdown().contains(method))
        );
        assert!(report.charts[0].1.svg().starts_with("<svg"));
    }
}
