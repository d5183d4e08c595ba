//! The failure regions of all methods as an experiment.

use cli::exit::Failure;
use serde_json::json;

use super::cell::{Cell, METRICS, run_method};
use super::degradation::Specimen;
use super::maps::{describe_failures, gain_map, is_failure, metric_map, ssim_map};
use crate::parallel::run_all;
use crate::report::Report;
use crate::row;
use crate::setup::{Parameter, Setup};
use crate::statistics::largest;
use crate::studio::{Studio, raster};
use crate::table::Table;

/// The parameters of the experiment.
pub const PARAMETERS: &[Parameter] = &[Parameter::number("scenes", "6", [1.0, 1000.0], "scenes")];
/// Large enough for the windows of every method, small enough for thousands of runs.
const SIZE: (usize, usize) = (256, 164);

/// Degrades scenes step by step and runs every method and, as `none`, no method.
///
/// # Errors
/// A scene cannot be rendered.
pub fn run(setup: &Setup) -> Result<Report, Failure> {
    let specimens = render_specimens(setup.count("scenes") as u64)?;
    let mut methods = vec!["none"];
    methods.extend(enhance::METHODS);
    let runs = run_all("methods", None, &methods, <()>::default, |method, ()| {
        run_method(method, &specimens)
    });
    let about = format!("{} scenes of {}x{}.", specimens.len(), SIZE.0, SIZE.1);
    Ok(report(&runs, about))
}

/// Scenes in air and in coastal water, rendered like those of any job.
fn render_specimens(count: u64) -> Result<Vec<Specimen>, Failure> {
    let mut studio = Studio::with_shipped_styles();
    let job = json!({
        "count": count, "seed": 5, "camera": {"width": SIZE.0, "height": SIZE.1, "hfov_deg": 80},
        "scene": {"kind": "procedural", "family": {"choice": scenes::FAMILIES}, "seed": {"int": [0, 1_000_000]}},
        "water": {"optics": {"choice": ["jerlov-IB", "jerlov-II", "jerlov-1C"]}, "range_scale": 0.3},
        "artifacts": ["rgb", "clean"], "metrics": []
    });
    let specimens = (0..count).map(|index| {
        let frame = studio.frame(&job, index)?;
        let rendered = studio.render(&frame)?;
        Ok(Specimen {
            clean: raster(&rendered, "clean")?.to_rgb8(),
            wet: raster(&rendered, "rgb")?.to_rgb8(),
        })
    });
    specimens.collect()
}

fn report(runs: &[Vec<Cell>], about: String) -> Report {
    let columns = "method,failing cells,cells,largest gain,failures,most pictures get worse at";
    let mut methods = Table::new("methods", columns.split(','));
    for cells in runs {
        let failing = cells.iter().filter(|cell| is_failure(cell)).count();
        let gains = cells.iter().map(|cell| cell.gain[0]);
        let gain = largest(gains.filter(|gain| gain.is_finite()));
        let failures: usize = cells.iter().map(|cell| cell.failures).sum();
        let mut row = row![cells[0].method, failing, cells.len(), gain, failures];
        row.push(json!(describe_failures(cells)));
        methods.push(row);
    }
    let mut report = Report::new(about, vec![methods, list_cells(&runs.concat())]);
    for cells in runs {
        report.add_chart(format!("{}-ssim", cells[0].method), ssim_map(cells).svg());
        report.add_chart(format!("{}-gain", cells[0].method), gain_map(cells).svg());
    }
    for (index, metric) in METRICS.iter().enumerate() {
        report.add_chart(format!("metric-{metric}"), metric_map(&runs[0], index).svg());
    }
    report
}

/// A row for each cell.
fn list_cells(cells: &[Cell]) -> Table {
    let columns = "method,degradation,level,value,ssim_before,ssim_after,matched_before,matched_after,worse_ssim,\
                   worse_matched,gain_mean,gain_max,warned,failures";
    let mut table = Table::new("cells", columns.split(',').chain(METRICS));
    for cell in cells {
        let (degradation, level) = (cell.degradation, cell.level);
        let value = degradation.levels()[level];
        let mut row = row![cell.method, degradation.name(), level, value];
        row.extend(
            [0, 1]
                .into_iter()
                .flat_map(|judge| row![cell.before[judge], cell.after[judge]]),
        );
        row.extend(cell.worse.into_iter().chain(cell.gain).map(|value| json!(value)));
        row.extend(row![cell.warned, cell.failures]);
        row.extend(cell.values.iter().map(|value| json!(value)));
        table.push(row);
    }
    table
}

#[cfg(test)]
mod tests {
    use imaging::Rgb8;

    use super::super::degradation::{Degradation, LEVELS};
    use super::*;

    fn specimens() -> Vec<Specimen> {
        let clean = Rgb8::from_fn(72, 48, |x, y| {
            let square = if (x / 9 + y / 9) % 2 == 0 { 70 } else { 180 };
            [square, square - (y / 2) as u8, square / 2 + x as u8]
        });
        let wet = Rgb8::from_fn(72, 48, |x, y| clean.pixel(x, y).map(|v| 40 + v / 2));
        vec![Specimen { clean, wet }]
    }

    #[test]
    fn every_method_ends_at_every_level_and_the_maps_show_it() {
        let runs: Vec<Vec<Cell>> = ["none", "hscm", "rghs", "ibla"]
            .map(|method| run_method(method, &specimens()))
            .into();
        for cells in &runs {
            assert_eq!(cells.len(), Degradation::ALL.len() * LEVELS);
            let failures: usize = cells.iter().map(|cell| cell.failures).sum();
            assert_eq!(failures, 0, "{}", cells[0].method);
        }
        let report = report(&runs, String::new());
        let csv = report.tables[1].csv();
        assert!(csv.lines().count() == 4 * 64 + 1 && !csv.contains(",,"), "{csv}");
        assert_eq!(report.charts.len(), 8 + METRICS.len());
        assert!(report.charts.iter().all(|(_, chart)| chart.contains("</svg>")));
    }

    #[test]
    fn the_picture_without_a_method_passes_noise_and_loses_nothing() {
        let cells = run_method("none", &specimens());
        assert!(
            cells
                .iter()
                .all(|cell| cell.gain[0] == 1.0 && cell.worse[0] == 0.0)
        );
        let ssim = |degradation, level| {
            let mut cells = cells.iter();
            cells
                .find(|c| c.degradation == degradation && c.level == level)
                .unwrap()
                .after[0]
        };
        // The degradations lower the SSIM.
        for degradation in [
            Degradation::Noise,
            Degradation::Turbidity,
            Degradation::Darkness,
            Degradation::Lamp,
        ] {
            assert!(
                ssim(degradation, LEVELS - 1) < ssim(degradation, 0) - 0.2,
                "{degradation:?}"
            );
        }
    }
}
